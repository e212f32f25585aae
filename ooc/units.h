// SPDX-License-Identifier: MIT
/// Numbers as people write and read them.
#pragma once

#include <cstdint>
#include <string>

namespace hewer::ooc {

/// "512 MiB", "1.5 GiB", "900 bytes".
std::string format_bytes(std::uint64_t bytes);

/// "1,234,567".
std::string format_count(std::uint64_t count);

}  // namespace hewer::ooc
