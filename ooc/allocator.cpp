// SPDX-License-Identifier: MIT
#include "hewer/allocator.h"

#include <malloc.h>

#include <algorithm>

#include "ooc/context.h"
#include "ooc/memory_budget.h"

namespace hewer {

void tune_allocator(std::uint64_t memory_bytes, unsigned n_threads) {
    constexpr std::uint64_t kLeast = 512 << 10;
    constexpr std::uint64_t kMost = 8 << 20;
    const std::uint64_t limit = memory_bytes != 0 ? memory_bytes : ooc::default_memory_limit();
    const std::uint64_t n_heaps = std::uint64_t{ooc::thread_count(n_threads)} + 1;
    const std::uint64_t kept = std::clamp(limit / 128 / n_heaps, kLeast, kMost);
    mallopt(M_MMAP_THRESHOLD, static_cast<int>(kept / 2));
    mallopt(M_TRIM_THRESHOLD, static_cast<int>(kept));
}

}  // namespace hewer
