// SPDX-License-Identifier: MIT
/// What the operating system refused, as an error of ours.
#pragma once

#include <filesystem>

namespace hewer::ooc {

/// Throws IoError: "PATH: cannot OPERATION: REASON", and what to do about a full disk.
[[noreturn]] void throw_io_error(const std::filesystem::path& path, const char* operation,
                                 int error);

}  // namespace hewer::ooc
