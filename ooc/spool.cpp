// SPDX-License-Identifier: MIT
#include "ooc/spool.h"

#include <atomic>
#include <cstring>
#include <mutex>
#include <optional>
#include <shared_mutex>

#include "hewer/error.h"
#include "ooc/array.h"
#include "ooc/page_evictor.h"
#include "ooc/spill.h"

namespace hewer::ooc {

namespace {

// Unit of checksums and of reading from disk: as many records as fit in this.
constexpr std::uint64_t kSectorBytes = 64 << 10;
// On disk, pages begin at multiples of this, so that they can be given back one by one.
constexpr std::uint64_t kPlaceBytes = 4 << 10;
// A spool begins with a tail of this size.
constexpr std::uint64_t kLeastTailBytes = 4 << 10;

std::atomic<std::uint64_t> g_next_id{1};

/// The sector that a thread has read last: readers that go front to back ask for parts of it again.
struct SectorCache {
    std::uint64_t spool = 0;
    std::uint64_t sector = 0;
    std::vector<std::byte> bytes;
};
SectorCache& sector_cache() {
    thread_local SectorCache cache;
    return cache;
}

}  // namespace

/// Lock order: the evictor's lock before a spool's, and a thread that holds a spool's lock asks for
/// memory only by try_reserve(), which never evicts. The evictor only tries for the locks of
/// spools.
struct RawSpool::State final : PageEvictor::Client {
    State(Context& c, std::string w, std::size_t bytes)
        : context(c),
          what(std::move(w)),
          record_bytes(bytes),
          per_sector(std::max<std::uint64_t>(1, std::min(c.page_bytes(), kSectorBytes) / bytes)),
          per_page(per_sector * std::max<std::uint64_t>(1, c.page_bytes() / kSectorBytes)),
          id(g_next_id.fetch_add(1)) {
        context.evictor().add(*this);
    }
    ~State() override { context.evictor().remove(*this); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    struct Page {
        Array<std::byte> memory;  // empty: on disk, or discarded
        bool is_on_disk = false;
    };

    [[nodiscard]] std::uint64_t page_bytes() const { return per_page * record_bytes; }
    [[nodiscard]] std::uint64_t sector_bytes() const { return per_sector * record_bytes; }
    [[nodiscard]] std::uint64_t sectors_per_page() const { return per_page / per_sector; }
    /// Of a page on disk.
    [[nodiscard]] std::uint64_t place(std::uint64_t page) const {
        return page * ((page_bytes() + kPlaceBytes - 1) / kPlaceBytes * kPlaceBytes);
    }
    /// Bytes of records in a page; less than page_bytes() in the last one after seal().
    [[nodiscard]] std::uint64_t filled_bytes(std::uint64_t page) const {
        return std::min(page_bytes(), (size - page * per_page) * record_bytes);
    }

    [[nodiscard]] std::uint64_t resident_bytes() const override {
        return n_resident.load(std::memory_order_relaxed) * page_bytes();
    }
    std::uint64_t evict(std::uint64_t wanted) override;
    void write_out(std::uint64_t page, const std::byte* bytes);
    void complete_tail();
    void grow_tail();
    void read_page(std::uint64_t page, std::uint64_t offset, std::byte* out,
                   std::uint64_t bytes) const;
    void read_sector(std::uint64_t page, std::uint64_t sector, std::byte* out,
                     std::uint64_t bytes) const;

    Context& context;
    std::string what;
    std::uint64_t record_bytes;
    std::uint64_t per_sector;
    std::uint64_t per_page;
    std::uint64_t id;
    mutable std::shared_mutex mutex;
    std::uint64_t size = 0;
    std::vector<Page> pages;  // full ones
    std::atomic<std::uint64_t> n_resident{0};
    Array<std::byte> tail;  // the records after them
    std::unique_ptr<SpillFile> file;
    std::vector<std::uint64_t> checksums;  // by sector of the file
};

void RawSpool::State::write_out(std::uint64_t page, const std::byte* bytes) {
    if (!file) file = std::make_unique<SpillFile>(context.spill());
    const std::uint64_t filled = filled_bytes(page);
    file->write_at(place(page), bytes, filled);
    if (checksums.size() < (page + 1) * sectors_per_page()) {
        checksums.resize((page + 1) * sectors_per_page());
    }
    for (std::uint64_t begin = 0; begin < filled; begin += sector_bytes()) {
        checksums[page * sectors_per_page() + begin / sector_bytes()] =
            checksum(bytes + begin, std::min(sector_bytes(), filled - begin));
    }
}

std::uint64_t RawSpool::State::evict(std::uint64_t wanted) {
    const std::unique_lock lock(mutex, std::try_to_lock);
    if (!lock) return 0;
    // Everything is read front to back: what is last is needed last.
    std::uint64_t freed = 0;
    for (std::uint64_t p = pages.size(); p-- > 0 && freed < wanted;) {
        Page& page = pages[p];
        if (page.memory.empty()) continue;
        if (!page.is_on_disk) write_out(p, page.memory.data());
        page.is_on_disk = true;
        freed += page.memory.size();
        page.memory.release();
        n_resident.fetch_sub(1, std::memory_order_relaxed);
    }
    return freed;
}

/// The reservation may evict, this spool's pages too: not under its lock.
void RawSpool::State::grow_tail() {
    const std::uint64_t bytes =
        std::min(page_bytes(), std::max({kLeastTailBytes, record_bytes, 4 * tail.size()}));
    Array<std::byte> larger(context.budget(), what, bytes);
    const std::unique_lock lock(mutex);
    if (!tail.empty()) std::memcpy(larger.data(), tail.data(), tail.size());
    tail = std::move(larger);
}

/// The tail is full: it becomes a page, on disk if there is no memory for another tail.
void RawSpool::State::complete_tail() {
    Page page;
    std::optional<Array<std::byte>> fresh;
    if (!context.spills_at_once()) {
        fresh = Array<std::byte>::try_make(context.budget(), page_bytes());
    }
    if (fresh) {
        page.memory = std::move(tail);
        tail = std::move(*fresh);
        n_resident.fetch_add(1, std::memory_order_relaxed);
    } else {
        write_out(pages.size(), tail.data());
        page.is_on_disk = true;
    }
    pages.push_back(std::move(page));
}

void RawSpool::State::read_sector(std::uint64_t page, std::uint64_t sector, std::byte* out,
                                  std::uint64_t bytes) const {
    file->read_at(place(page) + sector * sector_bytes(), out, bytes);
    if (checksum(out, bytes) != checksums[page * sectors_per_page() + sector]) {
        throw IoError(context.spill().folder().string() + ": a temporary file (" + what +
                      ") is damaged: its checksum has changed; the disk may be failing");
    }
}

void RawSpool::State::read_page(std::uint64_t page, std::uint64_t offset, std::byte* out,
                                std::uint64_t bytes) const {
    SectorCache& cache = sector_cache();
    while (bytes > 0) {
        const std::uint64_t sector = offset / sector_bytes();
        const std::uint64_t number = page * sectors_per_page() + sector;
        const std::uint64_t in_sector =
            std::min(sector_bytes(), filled_bytes(page) - sector * sector_bytes());
        const std::uint64_t skip = offset % sector_bytes();
        const std::uint64_t count = std::min(bytes, in_sector - skip);
        if (count == in_sector) {
            read_sector(page, sector, out, in_sector);
        } else {
            if (cache.spool != id || cache.sector != number) {
                cache.spool = 0;
                cache.bytes.resize(in_sector);
                read_sector(page, sector, cache.bytes.data(), in_sector);
                cache.spool = id;
                cache.sector = number;
            }
            std::memcpy(out, cache.bytes.data() + skip, count);
        }
        out += count;
        offset += count;
        bytes -= count;
    }
}

RawSpool::RawSpool(Context& context, std::string what, std::size_t record_bytes)
    : state_(new State(context, std::move(what), record_bytes)) {}

RawSpool::~RawSpool() = default;

void RawSpool::append(const void* records, std::uint64_t n) {
    State& s = *state_;
    const auto* source = static_cast<const std::byte*>(records);
    while (n > 0) {
        std::unique_lock lock(s.mutex);
        const std::uint64_t used = s.size % s.per_page * s.record_bytes;
        const std::uint64_t count = std::min(n, (s.tail.size() - used) / s.record_bytes);
        if (count == 0) {
            lock.unlock();
            s.grow_tail();
            continue;
        }
        std::memcpy(s.tail.data() + used, source, count * s.record_bytes);
        source += count * s.record_bytes;
        s.size += count;
        n -= count;
        if (s.size % s.per_page == 0) s.complete_tail();
    }
}

void RawSpool::seal() {
    State& s = *state_;
    const std::unique_lock lock(s.mutex);
    if (s.size % s.per_page != 0) {
        s.pages.push_back({std::move(s.tail), false});
        s.n_resident.fetch_add(1, std::memory_order_relaxed);
    }
    s.tail.release();
}

void RawSpool::read(std::uint64_t first, std::uint64_t n, void* out) const {
    const State& s = *state_;
    auto* target = static_cast<std::byte*>(out);
    const std::shared_lock lock(s.mutex);
    while (n > 0) {
        const std::uint64_t p = first / s.per_page;
        const std::uint64_t skip = first % s.per_page;
        const std::uint64_t count = std::min(n, s.per_page - skip);
        const std::uint64_t offset = skip * s.record_bytes;
        const std::uint64_t bytes = count * s.record_bytes;
        if (p == s.pages.size()) {
            std::memcpy(target, s.tail.data() + offset, bytes);
        } else if (!s.pages[p].memory.empty()) {
            std::memcpy(target, s.pages[p].memory.data() + offset, bytes);
        } else {
            s.read_page(p, offset, target, bytes);
        }
        target += bytes;
        first += count;
        n -= count;
    }
}

void RawSpool::discard_before(std::uint64_t record) {
    State& s = *state_;
    const std::unique_lock lock(s.mutex);
    for (std::uint64_t p = record / s.per_page; p-- > 0;) {
        State::Page& page = s.pages[p];
        if (page.memory.empty() && !page.is_on_disk) break;
        if (!page.memory.empty()) s.n_resident.fetch_sub(1, std::memory_order_relaxed);
        page.memory.release();
        if (page.is_on_disk) {
            s.file->discard(s.place(p), s.place(p + 1) - s.place(p));
        }
        page.is_on_disk = false;
    }
}

std::uint64_t RawSpool::size() const {
    const std::shared_lock lock(state_->mutex);
    return state_->size;
}

int RawSpool::spill_descriptor() const {
    const std::shared_lock lock(state_->mutex);
    return state_->file ? state_->file->descriptor() : -1;
}

}  // namespace hewer::ooc
