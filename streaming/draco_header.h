// SPDX-License-Identifier: MIT
/// What the beginning of Draco data announces, of every version of its format.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "ooc/file.h"

namespace hewer::streaming {

/// What the header announces; what is decoded may have a few points more.
struct DracoCounts {
    std::uint64_t n_points = 0;
    std::uint64_t n_faces = 0;
};

/// Nothing of data that ends within the header.
std::optional<DracoCounts> announced_counts(std::span<const char> bytes);

/// Of a file. Nothing of point clouds, or if metadata in front of the counts is beyond what is
/// read of it (64 KiB).
std::optional<DracoCounts> announced_counts(const ooc::InputFile& file);

}  // namespace hewer::streaming
