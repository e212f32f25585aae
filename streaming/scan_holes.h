// SPDX-License-Identifier: MIT
/// Open places of a generated scan, and the ids of the vertices that remain.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ooc/array.h"
#include "ooc/context.h"
#include "streaming/box_grid.h"
#include "streaming/scan_surface.h"

namespace hewer::streaming {

/// Where the scanner saw nothing: discs of several sizes with ragged rims. A pure function of a
/// grid point. A triangle is there if its three corners were seen, a vertex is used if a triangle
/// is.
class ScanHoles {
  public:
    ScanHoles(const ScanSurface& surface, std::uint64_t seed);

    [[nodiscard]] bool is_seen(const BoxGrid::Point& p) const;
    /// The same for the corners of a quad; cheaper than four times.
    [[nodiscard]] std::array<bool, 4> are_seen(const BoxGrid::Quad& quad) const;
    /// A triangle of the grid uses `p`.
    [[nodiscard]] bool is_used(const BoxGrid& grid, const BoxGrid::Point& p) const;

  private:
    enum class Place { Clear, Rim, Gone };
    /// Side by side for the vector registers, filled up with discs of no size.
    static constexpr std::size_t kMostDiscs = 16;
    using PerDisc = std::array<float, kMostDiscs>;

    [[nodiscard]] Place locate(const std::array<float, 3>& direction) const;
    [[nodiscard]] bool is_seen_on_rim(const std::array<float, 3>& direction,
                                      const BoxGrid::Point& p) const;

    const ScanSurface& surface_;
    std::uint32_t seed_;
    PerDisc x_{}, y_{}, z_{};  // centres on the unit sphere
    PerDisc radius_{};         // chord
    PerDisc clear2_{};         // beyond this squared chord, neighbours are seen as well
    PerDisc gone2_{};          // within this one, no neighbour is
};

/// The triangles of a quad of which some corners may be unseen: two, one, or none, as corners 0..3
/// of the quad, wound as it is. `diagonal_02` chooses how a whole quad is cut.
struct QuadTriangles {
    std::size_t count = 0;
    std::array<std::array<std::uint8_t, 3>, 2> corners{};
};
QuadTriangles cut_quad(const std::array<bool, 4>& seen, bool diagonal_02);

/// Numbers the used vertices 0, 1, 2, ... in grid order without a table of them: counts per run of
/// kRun ids are kept, what lies between is recomputed.
/// Memory: 8 bytes per kRun vertices of the grid (1 byte per thousand triangles), reserved.
class UsedVertices {
  public:
    static constexpr std::uint64_t kRun = 4096;

    /// One parallel pass over the grid's vertices. Throws Cancelled, OutOfMemoryBudget.
    UsedVertices(const BoxGrid& grid, const ScanHoles& holes, ooc::Context& context);

    [[nodiscard]] std::uint64_t count() const { return first_[first_.size() - 1]; }

    /// Looks up ids near each other cheaply. One per thread; keeps 11 KiB.
    class Lookup {
      public:
        explicit Lookup(const UsedVertices& used) : used_(used), pages_(kPages) {}
        /// The new number of a used vertex.
        std::uint64_t operator()(std::uint64_t vertex);

      private:
        static constexpr std::size_t kPages = 16;
        static constexpr std::uint64_t kWords = kRun / 64;
        struct Page {
            std::uint64_t run = ~std::uint64_t{0};
            std::array<std::uint64_t, kWords> bits{};
            std::array<std::uint16_t, kWords> before{};  // bits set in the words before
        };
        const Page& page(std::uint64_t run);
        const UsedVertices& used_;
        std::vector<Page> pages_;
        std::size_t last_ = 0;  // hit last
        std::size_t next_ = 0;  // to be replaced next
    };

  private:
    BoxGrid grid_;
    const ScanHoles& holes_;
    ooc::Array<std::uint64_t> first_;  // used vertices before each run; at the end, all
};

}  // namespace hewer::streaming
