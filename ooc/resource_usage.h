// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace hewer::ooc {

/// Largest resident set of the process so far, in bytes, as the system counts it.
std::uint64_t peak_resident_bytes();

}  // namespace hewer::ooc
