// SPDX-License-Identifier: MIT
/// What must be known of a surface before it can be put on a lattice.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <string_view>

#include "hewer/mesh_source.h"
#include "hewer/types.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "streaming/dereference.h"

namespace hewer::measuring {

/// One bit for each of some things, set by any number of threads.
class Marks {
  public:
    Marks() = default;
    Marks(ooc::Context& context, std::string_view what, std::uint64_t n)
        : words_(context.budget(), what, n / 64 + 1) {}
    void set(std::uint64_t i) {
        const std::atomic_ref word(words_[i / 64]);
        const std::uint64_t bit = std::uint64_t{1} << (i % 64);
        // Most are set already when they are met: a look is cheaper than a locked write.
        if ((word.load(std::memory_order_relaxed) & bit) == 0) {
            word.fetch_or(bit, std::memory_order_relaxed);
        }
    }
    [[nodiscard]] bool get(std::uint64_t i) const { return (words_[i / 64] >> (i % 64) & 1) != 0; }
    void clear() { std::fill(words_.begin(), words_.end(), 0); }

    static std::uint64_t bytes(std::uint64_t n) { return (n / 64 + 1) * sizeof(std::uint64_t); }

  private:
    ooc::Array<std::uint64_t> words_;
};

/// Triangles with a corner that is not finite do not count, nor do vertices that no other triangle
/// uses: a stray one must not coarsen the lattice.
struct Census {
    std::uint64_t n_triangles = 0;
    std::uint64_t n_vertices = 0;  ///< marked; 0 for a soup
    Bounds bounds;
    double area = 0;  ///< square model units; the same bits for any number of threads
    Marks used;       ///< of an indexed mesh: the vertices that count
    streaming::Coherence coherence = streaming::Coherence::Unknown;  ///< of the file
};

/// One pass over the triangles and what it takes to dereference them (streaming::Dereference), with
/// `window_bytes` for vertices. Memory: that, and a bit for each vertex.
/// Throws: FormatError, IoError, OutOfMemoryBudget, OutOfDiskBudget, Cancelled.
Census take_census(ooc::Context& context, MeshSource& source, std::uint64_t window_bytes);

/// take_census() of a surface that is to be measured. Throws InvalidArgument, too, if it has no
/// triangle.
Census take_census_of_surface(ooc::Context& context, MeshSource& source,
                              std::uint64_t window_bytes);

}  // namespace hewer::measuring
