// SPDX-License-Identifier: MIT
/// Numbers as people read them.
#pragma once

#include <cstdint>
#include <string>

namespace hewer {

/// "512.0 MiB", "1.50 GiB", "900 bytes".
std::string format_bytes(std::uint64_t bytes);

/// "1,234,567".
std::string format_count(std::uint64_t count);

}  // namespace hewer
