// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "ooc/file.h"
#include "ooc/memory_budget.h"

namespace hewer::raster {

/// Writes rows of red, green, blue bytes, top row first, as an 8-bit PNG (sRGB) to `file`, without
/// commit(). pixels.size() must be 3 * width * height.
/// Memory: the encoded picture, at most a little more than `pixels`, reserved.
/// Throws: IoError, OutOfMemoryBudget.
void write_png(ooc::OutputFile& file, std::span<const std::uint8_t> pixels, unsigned width,
               unsigned height, ooc::MemoryBudget& budget);

}  // namespace hewer::raster
