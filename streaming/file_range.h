// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>

#include "ooc/file.h"

namespace hewer::streaming {

/// A range of a file. What no file means is said where that can be.
struct FileRange {
    std::shared_ptr<const ooc::InputFile> file;
    std::uint64_t offset = 0;
    std::uint64_t n_bytes = 0;
};

}  // namespace hewer::streaming
