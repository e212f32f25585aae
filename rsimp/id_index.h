// SPDX-License-Identifier: MIT
/// Output index of a vertex: the rank of its id among the ids of a mesh.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "ooc/array.h"
#include "ooc/context.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// A set of ids that answers how many are smaller. A bit for each cluster whose first fan is there,
/// in cache lines that begin with the counts before them, and the ids of all further fans. A
/// look-up touches one line, and the next where there are further fans. Any number of threads may
/// look up.
///
/// Memory: a fifth of a byte for each cluster between the first and the last, 8 to 24 bytes for
/// each further fan.
class IdIndex {
  public:
    /// Room for ids from `first` to `last`.
    IdIndex(ooc::Context& context, VertexId first, VertexId last);

    /// Ids must rise. Throws InternalError if they do not, or leave the room.
    void append(VertexId id);

    [[nodiscard]] std::uint64_t size() const { return size_; }
    /// Precondition: `id` is there.
    [[nodiscard]] std::uint64_t rank(VertexId id) const;
    /// Rank, or nothing if `id` is not there.
    [[nodiscard]] std::optional<std::uint64_t> find(VertexId id) const;

  private:
    static constexpr std::uint64_t kWords = 5;
    struct alignas(64) Line {
        std::uint64_t before;  // ids of lower lines
        std::uint64_t fans;    // of these, further fans
        std::uint64_t counts;  // of bits before each word of the line, kCountBits each
        std::array<std::uint64_t, kWords> bits;
    };
    [[nodiscard]] const VertexId* first_not_below(std::uint64_t line, VertexId id) const;

    ooc::MemoryBudget* budget_;
    std::uint64_t first_cluster_;
    ooc::Array<Line> lines_;     // and one more, for the number of further fans
    ooc::Array<VertexId> fans_;  // twice as long whenever it is full
    std::uint64_t n_fans_ = 0;
    std::uint64_t size_ = 0;
    std::uint64_t line_ = 0;  // of the last id
    VertexId last_ = 0;
};

}  // namespace hewer::rsimp
