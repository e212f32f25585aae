// SPDX-License-Identifier: MIT
#include "cluster/vertex_pages.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "hewer/error.h"

namespace hewer::cluster {

namespace {

void forget_slots(VertexPages::Page& page) {
    for (std::uint64_t i = 0; i < page.n; ++i) {
        std::uint32_t& cell = page.vertices[i].cell;
        if (cell != CellTable::kNone) cell = VertexPages::kUnknown;
    }
}

}  // namespace

VertexPages::VertexPages(const CellTable& table, VertexStore& store)
    : table_(&table), pages_((store.vertices.size() + kPageVertices - 1) >> kPageBits) {
    for (std::uint64_t p = 0; p < pages_.size(); ++p) {
        Page& page = pages_[p];
        const std::uint64_t first = p << kPageBits;
        page.vertices = store.vertices.data() + first;
        page.n = std::min(kPageVertices, store.vertices.size() - first);
        page.epoch = std::numeric_limits<std::uint64_t>::max();
    }
}

VertexPages::VertexPages(ooc::Context& context, const CellTable& table, MeshSource& source,
                         const ooc::Spool<LatticePoint>& spooled, const Lattice& lattice,
                         const Bounds& bounds, std::uint64_t most_pages)
    : table_(&table),
      source_(&source),
      spooled_(&spooled),
      lattice_(lattice),
      bounds_(bounds),
      pages_((source.info().n_vertices + kPageVertices - 1) >> kPageBits),
      frames_(std::max<std::uint64_t>(std::min<std::uint64_t>(most_pages, pages_.size()),
                                      3 * context.n_threads())),
      most_pinned_(frames_.size() / context.n_threads()) {
    for (std::uint64_t p = 0; p < pages_.size(); ++p) {
        pages_[p].n = std::min(kPageVertices, source.info().n_vertices - (p << kPageBits));
    }
    page_bytes_ = context.budget().reserve(
        "pages of vertices", pages_.size() * (sizeof(Page) + context.n_threads() * sizeof(void*)));
    vertices_ = {context.budget(), "a window of vertices", frames_.size() << kPageBits};
}

void VertexPages::View::release() {
    if (pinned_.empty()) return;
    const std::lock_guard lock(pages_->mutex_);
    for (const std::uint64_t p : pinned_) {
        mine_[p] = nullptr;
        --pages_->pages_[p].n_pins;
    }
    pinned_.clear();
}

const VertexPages::Page& VertexPages::pin(std::uint64_t p) {
    const std::lock_guard lock(mutex_);
    Page& page = pages_[p];
    if (page.vertices == nullptr) load(p);
    if (page.epoch != table_->epoch()) {
        forget_slots(page);
        page.epoch = table_->epoch();
    }
    page.is_recent = true;
    ++page.n_pins;
    return page;
}

/// Second chance: the first page from the hand on that is not in use and has not been since the
/// hand came by last.
void VertexPages::make_frame(Page& page) {
    std::size_t frame = frames_.size();
    for (std::size_t tried = 0; tried < 2 * frames_.size(); ++tried) {
        const std::size_t at = std::exchange(hand_, (hand_ + 1) % frames_.size());
        if (!frames_[at].page) {
            frame = at;
            break;
        }
        Page& other = pages_[*frames_[at].page];
        if (other.n_pins == 0 && !std::exchange(other.is_recent, false)) {
            other.vertices = nullptr;
            frame = at;
            break;
        }
    }
    if (frame == frames_.size()) {
        throw InternalError("more vertex pages in use than there are");
    }
    page.vertices = vertices_.data() + (frame << kPageBits);
    frames_[frame].page = static_cast<std::uint64_t>(&page - pages_.data());
}

void VertexPages::load(std::uint64_t p) {
    Page& page = pages_[p];
    make_frame(page);
    ++n_loads_;
    const std::uint64_t first = p << kPageBits;
    if (!spooled_->empty()) {
        points_.resize(page.n);
        spooled_->read(first, points_);
        for (std::uint64_t i = 0; i < page.n; ++i) {
            const bool is_finite = points_[i] != kNotFinite;
            page.vertices[i] = {points_[i], is_finite ? kUnknown : CellTable::kNone};
        }
    } else {
        source_->read_vertices(first, page.n, batch_);
        for (std::uint64_t i = 0; i < page.n; ++i) {
            const Vec3& x = batch_.positions[i];
            page.vertices[i].cell = CellTable::kNone;
            if (!std::isfinite(x[0]) || !std::isfinite(x[1]) || !std::isfinite(x[2])) continue;
            page.vertices[i] = {lattice_.encode(x), kUnknown};
        }
    }
    page.epoch = table_->epoch();
}

}  // namespace hewer::cluster
