// SPDX-License-Identifier: MIT
/// How much memory a run needs, stage by stage, as a function of counts: docs/memory.md in code.
#pragma once

#include <cstdint>

namespace hewer::rsimp {

/// The counts that memory depends on. All but the first two are estimates before a run.
struct MemoryCounts {
    std::uint64_t vertices = 0;  ///< 0 for a soup
    std::uint64_t cells = 0;
    std::uint64_t surviving_triangles = 0;
    std::uint64_t clusters = 0;  ///< that the edge collapse begins with
    bool has_attributes = false;
    bool is_refined = true;
};

/// Peak bytes of the whole process.
std::uint64_t peak_memory_bytes(const MemoryCounts& counts);

}  // namespace hewer::rsimp
