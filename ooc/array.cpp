// SPDX-License-Identifier: MIT
#include "ooc/array.h"

#include <sys/mman.h>

namespace hewer::ooc {

namespace {
// Below this a mapping wastes more in page rounding and system calls than it returns.
constexpr std::uint64_t kMapThreshold = 32 << 10;
// Huge pages of smaller mappings would be shared with their neighbours, and stay when one of them
// goes.
constexpr std::uint64_t kHugeThreshold = 8 << 20;
}  // namespace

void* map_pages(std::uint64_t bytes) {
    if (bytes == 0) return nullptr;
    if (bytes < kMapThreshold) {
        void* p = std::calloc(bytes, 1);
        if (p == nullptr) throw std::bad_alloc();
        return p;
    }
    void* p = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (p == MAP_FAILED) throw std::bad_alloc();
    // Fewer page faults and TLB misses; a hint that may be refused.
    if (bytes >= kHugeThreshold) (void)::madvise(p, bytes, MADV_HUGEPAGE);
    return p;
}

void unmap_pages(void* address, std::uint64_t bytes) noexcept {
    if (address == nullptr) return;
    if (bytes < kMapThreshold) {
        std::free(address);
    } else {
        ::munmap(address, bytes);
    }
}

}  // namespace hewer::ooc
