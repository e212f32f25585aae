// SPDX-License-Identifier: MIT
#include "ooc/spool.h"

#include <cstring>
#include <shared_mutex>

#include "ooc/array.h"

namespace hewer::ooc {

struct RawSpool::State {
    Context& context;
    std::string what;
    std::size_t record_bytes;
    std::uint64_t per_page;
    std::uint64_t size = 0;
    mutable std::shared_mutex mutex;
    std::vector<Array<std::byte>> pages;
};

RawSpool::RawSpool(Context& context, std::string what, std::size_t record_bytes)
    : state_(new State{context,
                       std::move(what),
                       record_bytes,
                       std::max<std::uint64_t>(1, context.page_bytes() / record_bytes),
                       0,
                       {},
                       {}}) {}

RawSpool::~RawSpool() = default;

void RawSpool::append(const void* records, std::uint64_t n) {
    State& s = *state_;
    const auto* source = static_cast<const std::byte*>(records);
    const std::unique_lock lock(s.mutex);
    while (n > 0) {
        const std::uint64_t used = s.size % s.per_page;
        if (used == 0) {
            s.pages.emplace_back(s.context.budget(), s.what, s.per_page * s.record_bytes);
        }
        const std::uint64_t count = std::min(n, s.per_page - used);
        std::memcpy(s.pages.back().data() + used * s.record_bytes, source, count * s.record_bytes);
        source += count * s.record_bytes;
        s.size += count;
        n -= count;
    }
}

void RawSpool::read(std::uint64_t first, std::uint64_t n, void* out) const {
    const State& s = *state_;
    auto* target = static_cast<std::byte*>(out);
    const std::shared_lock lock(s.mutex);
    while (n > 0) {
        const std::uint64_t skip = first % s.per_page;
        const std::uint64_t count = std::min(n, s.per_page - skip);
        std::memcpy(target, s.pages[first / s.per_page].data() + skip * s.record_bytes,
                    count * s.record_bytes);
        target += count * s.record_bytes;
        first += count;
        n -= count;
    }
}

void RawSpool::discard_before(std::uint64_t record) {
    State& s = *state_;
    const std::unique_lock lock(s.mutex);
    for (std::uint64_t p = record / s.per_page; p-- > 0;) {
        if (s.pages[p].empty()) break;
        s.pages[p].release();
    }
}

std::uint64_t RawSpool::size() const {
    const std::shared_lock lock(state_->mutex);
    return state_->size;
}

}  // namespace hewer::ooc
