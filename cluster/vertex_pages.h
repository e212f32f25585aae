// SPDX-License-Identifier: MIT
/// The vertices of an indexed input by page: all of them in memory, or those that the triangles at
/// hand use.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "cluster/cell_table.h"
#include "cluster/lattice.h"
#include "cluster/vertex_store.h"
#include "hewer/mesh_source.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "ooc/spool.h"

namespace hewer::cluster {

/// Real scans are coherent: triangles that are near each other in the file use vertices that are
/// near each other in the file. So a window over the vertices is enough, a page of it loaded when a
/// batch of triangles first needs it and given up when it has not been used for a while. Pages are
/// small, and a batch ends when its worker's part of the window is used up: where two sweeps of a
/// scan meet, each triangle may use a page of its own. Three pages for each worker would do.
///
/// A page remembers the cell of each vertex while the table is the same (CellTable::epoch()), so
/// that a vertex is looked up once and not with each of its six triangles. Memory: 16 bytes a
/// vertex in the window.
class VertexPages {
  public:
    static constexpr unsigned kPageBits = 10;
    static constexpr std::uint64_t kPageVertices = std::uint64_t{1} << kPageBits;
    static constexpr std::uint64_t kPageBytes = kPageVertices * sizeof(PlacedPoint);

    struct Page {
        /// With the slot in the table, kUnknown, or CellTable::kNone for a vertex that is not
        /// finite.
        PlacedPoint* vertices = nullptr;
        std::uint64_t n = 0;
        std::uint64_t epoch = 0;
        std::uint32_t n_pins = 0;
        bool is_recent = false;  // pinned since the clock's hand came by
    };
    static constexpr std::uint32_t kUnknown = 0xfffffffeU;

    /// All vertices are in `store`, which must outlive this.
    VertexPages(const CellTable& table, VertexStore& store);
    /// A window of `most_pages` over the vertices of a source that can seek, or that have been put
    /// on a spool as lattice points (kNotFinite for those that have none).
    VertexPages(ooc::Context& context, const CellTable& table, MeshSource& source,
                const ooc::Spool<LatticePoint>& spooled, const Lattice& lattice,
                const Bounds& bounds, std::uint64_t most_pages);

    static constexpr LatticePoint kNotFinite{0xffffffffU, 0xffffffffU, 0xffffffffU};

    /// Whether far more vertices have been loaded than `n_triangles` of a coherent file would need
    /// (half a vertex each). Any thread.
    [[nodiscard]] bool is_thrashing(std::uint64_t n_triangles) const {
        const std::uint64_t loaded = n_loads_.load(std::memory_order_relaxed);
        return loaded > 8 * frames_.size() &&
               is_thrashing(loaded - 8 * frames_.size(), n_triangles);
    }
    static bool is_thrashing(std::uint64_t n_pages, std::uint64_t n_triangles) {
        constexpr std::uint64_t kMostPerTriangle = 12;
        return n_pages * kPageVertices > kMostPerTriangle * n_triangles;
    }

    /// The cell of a vertex, kUnknown, or CellTable::kNone for one that is not finite, where all
    /// vertices are in memory; else kUnknown. Call under an Admission of the table, while no View
    /// is in use.
    [[nodiscard]] std::uint32_t slot_of(std::uint64_t vertex) const {
        const Page& page = pages_[vertex >> kPageBits];
        if (source_ != nullptr || page.epoch != table_->epoch()) return kUnknown;
        return page.vertices[vertex & (kPageVertices - 1)].cell;
    }

    /// One worker's pages of the present batch.
    class View {
      public:
        explicit View(VertexPages& pages)
            : pages_(&pages), mine_(pages.pages_.size()), most_pinned_(pages.most_pinned_) {}
        View(const View&) = delete;
        View& operator=(const View&) = delete;
        ~View() { release(); }

        /// Whether this worker's part of the window has no room for the corners of another
        /// triangle: end the batch, then.
        [[nodiscard]] bool is_full() const { return pinned_.size() + 3 > most_pinned_; }
        /// Call under an Admission of the table, and with is_full() false for the triangle.
        PlacedPoint& vertex(std::uint64_t v) {
            const std::uint64_t p = v >> kPageBits;
            if (mine_[p] == nullptr) {
                mine_[p] = pages_->pin(p).vertices;
                pinned_.push_back(p);
            }
            return mine_[p][v & (kPageVertices - 1)];
        }
        /// At the end of a batch, before the Admission ends.
        void release();

      private:
        VertexPages* pages_;
        std::vector<PlacedPoint*> mine_;  // by page; null: not pinned
        std::vector<std::uint64_t> pinned_;
        std::size_t most_pinned_;
    };

  private:
    const Page& pin(std::uint64_t p);
    void load(std::uint64_t p);
    void make_frame(Page& page);

    const CellTable* table_;
    MeshSource* source_ = nullptr;
    const ooc::Spool<LatticePoint>* spooled_ = nullptr;
    Lattice lattice_;
    Bounds bounds_;
    std::mutex mutex_;
    std::vector<Page> pages_;
    struct Frame {
        std::optional<std::uint64_t> page;
    };
    ooc::Array<PlacedPoint> vertices_;  // of all frames
    std::vector<Frame> frames_;
    std::size_t hand_ = 0;  // of the clock that finds a page to give up
    ooc::Reservation page_bytes_;
    std::atomic<std::uint64_t> n_loads_{0};
    std::size_t most_pinned_ = ~std::size_t{0};  // by each worker
    VertexBatch batch_;                          // of load()
    std::vector<LatticePoint> points_;           // likewise
};

}  // namespace hewer::cluster
