// SPDX-License-Identifier: MIT
#include "ooc/array.h"

#include <sys/mman.h>
#include <unistd.h>

namespace hewer::ooc {

namespace {
// Below this a mapping wastes more in page rounding and system calls than it returns.
constexpr std::uint64_t kMapThreshold = 32 << 10;
// From this size on mappings begin where a huge page may, so that none is shared with a neighbour
// and stays when one of the two goes.
constexpr std::uint64_t kHugeBytes = 2 << 20;

/// `bytes` at a multiple of kHugeBytes.
void* map_aligned(std::uint64_t bytes) {
    const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    const std::uint64_t length = (bytes + page - 1) / page * page;
    void* const p = ::mmap(nullptr, length + kHugeBytes, PROT_READ | PROT_WRITE,
                           MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (p == MAP_FAILED) throw std::bad_alloc();
    auto* const begin = static_cast<std::byte*>(p);
    const std::uint64_t skip = -reinterpret_cast<std::uintptr_t>(p) % kHugeBytes;
    if (skip > 0) ::munmap(begin, skip);
    ::munmap(begin + skip + length, kHugeBytes - skip);
    // Fewer page faults and TLB misses; a hint that may be refused.
    (void)::madvise(begin + skip, length, MADV_HUGEPAGE);
    return begin + skip;
}

}  // namespace

void* map_pages(std::uint64_t bytes) {
    if (bytes == 0) return nullptr;
    if (bytes < kMapThreshold) {
        void* p = std::calloc(bytes, 1);
        if (p == nullptr) throw std::bad_alloc();
        return p;
    }
    if (bytes >= kHugeBytes) return map_aligned(bytes);
    void* p = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (p == MAP_FAILED) throw std::bad_alloc();
#ifdef MADV_POPULATE_WRITE
    // All at once: a page fault each takes several times as long, and what is added to before it is
    // written, as sums are, faults twice. A hint that may be refused.
    (void)::madvise(p, bytes, MADV_POPULATE_WRITE);
#endif
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
