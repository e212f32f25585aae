// SPDX-License-Identifier: MIT
#include "ooc/page_evictor.h"

#include <algorithm>

namespace hewer::ooc {

PageEvictor::PageEvictor(MemoryBudget& budget) : budget_(budget) {
    budget_.set_reclaimer([this](std::uint64_t bytes) { return make_room(bytes); });
}

PageEvictor::~PageEvictor() {
    budget_.set_reclaimer({});
}

void PageEvictor::add(Client& client) {
    const std::lock_guard lock(mutex_);
    clients_.push_back(&client);
}

void PageEvictor::remove(Client& client) {
    const std::lock_guard lock(mutex_);
    std::erase(clients_, &client);
}

bool PageEvictor::make_room(std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    if (budget_.available() >= bytes) return true;  // another thread has just done it
    std::uint64_t wanted = std::max(bytes, budget_.limit() / kLeastShare);
    std::vector<Client*> order(clients_);
    std::stable_sort(order.begin(), order.end(), [](const Client* a, const Client* b) {
        return a->resident_bytes() > b->resident_bytes();
    });
    bool is_freed = false;
    for (Client* client : order) {
        if (client->resident_bytes() == 0) break;
        const std::uint64_t freed = client->evict(wanted);
        is_freed |= freed > 0;
        if (freed >= wanted) return true;
        wanted -= freed;
    }
    return is_freed;
}

}  // namespace hewer::ooc
