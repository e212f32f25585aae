// SPDX-License-Identifier: MIT
#include "rsimp/lod_parents.h"

#include <limits>
#include <unordered_map>

#include "ooc/array.h"
#include "rsimp/id_index.h"

namespace hewer::rsimp {

namespace {

IdIndex index_of(ooc::Context& context, const ooc::Spool<VertexId>& ids) {
    IdIndex index(context, ids.at(0), ids.at(ids.size() - 1));
    ooc::SpoolReader<VertexId> reader(ids);
    while (const VertexId* id = reader.next()) index.append(*id);
    return index;
}

}  // namespace

LodParents find_parents(ooc::Context& context, const ooc::Spool<VertexId>& fine,
                        std::span<const std::pair<VertexId, VertexId>> merges,
                        const ooc::Spool<VertexId>& coarse) {
    constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
    if (fine.empty()) return {};
    if (coarse.empty()) return LodParents(fine.size(), kNone);
    const IdIndex fine_index = index_of(context, fine);
    ooc::Array<VertexId> stands(context.budget(), "parents", fine.size());
    fine.read(0, stands.span());
    // Vertices that came into being between the two LODs.
    std::unordered_map<VertexId, VertexId> others;
    // Last merge first: what a pair's second comes to is known when the pair is met.
    for (std::size_t i = merges.size(); i-- > 0;) {
        const auto [from, to] = merges[i];
        VertexId end = to;
        if (const auto at = fine_index.find(to)) {
            end = stands[*at];
        } else if (const auto it = others.find(to); it != others.end()) {
            end = it->second;
        }
        if (const auto at = fine_index.find(from)) {
            stands[*at] = end;
        } else {
            others[from] = end;
        }
    }
    const IdIndex coarse_index = index_of(context, coarse);
    const ooc::Reservation result_bytes =
        context.budget().reserve("parents", fine.size() * sizeof(std::uint64_t));
    LodParents parents;
    parents.reserve(stands.size());
    for (const VertexId id : stands) parents.push_back(coarse_index.find(id).value_or(kNone));
    return parents;
}

}  // namespace hewer::rsimp
