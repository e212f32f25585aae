// SPDX-License-Identifier: MIT
/// Output index of a vertex: its rank among the ids of a mesh.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "ooc/array.h"
#include "ooc/context.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// A bit for each cluster whose first fan is there, with running counts, and the ids of all other
/// fans. Memory: 0.19 bytes a cluster, 8 bytes a further fan.
class VertexRank {
  public:
    /// One pass over the vertices.
    VertexRank(ooc::Context& context, const ooc::Spool<StoredVertex>& vertices) {
        if (vertices.empty()) return;
        const std::uint64_t n = cluster_of(vertices.at(vertices.size() - 1).id) + 1;
        bits_ = {context.budget(), "vertex ranks", (n + 63) / 64};
        before_ = {context.budget(), "vertex ranks", bits_.size() + 1};
        ooc::SpoolReader<StoredVertex> reader(vertices);
        while (const StoredVertex* v = reader.next()) {
            const std::uint64_t c = cluster_of(v->id);
            if (v->id == vertex_id(c, 0)) {
                bits_[c / 64] |= std::uint64_t{1} << (c % 64);
            } else {
                others_.push_back(v->id);
            }
        }
        for (std::uint64_t w = 0; w < bits_.size(); ++w) {
            before_[w + 1] = before_[w] + static_cast<std::uint32_t>(std::popcount(bits_[w]));
        }
    }

    [[nodiscard]] std::uint32_t of(VertexId id) const {
        const std::uint64_t c = cluster_of(id);
        // Of first fans: those of lower clusters, and the own one for a further fan.
        const std::uint64_t lower = bits_[c / 64] & ((std::uint64_t{1} << (c % 64)) - 1);
        auto rank = before_[c / 64] + static_cast<std::uint32_t>(std::popcount(lower));
        if (id != vertex_id(c, 0)) rank += (bits_[c / 64] >> (c % 64) & 1) != 0 ? 1U : 0U;
        if (!others_.empty()) {
            rank += static_cast<std::uint32_t>(
                std::lower_bound(others_.begin(), others_.end(), id) - others_.begin());
        }
        return rank;
    }

  private:
    ooc::Array<std::uint64_t> bits_;
    ooc::Array<std::uint32_t> before_;
    std::vector<VertexId> others_;
};

}  // namespace hewer::rsimp
