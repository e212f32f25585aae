// SPDX-License-Identifier: MIT
#include "rsimp/seams.h"

#include <functional>

#include "ooc/external_sort.h"
#include "rsimp/duplicate_faces.h"

namespace hewer::rsimp {

namespace {

template <typename T>
std::vector<T> read(const ooc::Spool<T>& spool, std::uint64_t first, std::uint64_t last) {
    std::vector<T> records(last - first);
    spool.read(first, records);
    return records;
}

}  // namespace

ooc::Spool<Face> settle_crossing(ooc::Context& context, ooc::Spool<Face> faces, bool is_closed) {
    ooc::ExternalSorter<Face, ByUnwound> sorter(context, "faces between blocks", {},
                                                context.sort_bytes());
    {
        ooc::SpoolReader<Face> reader(faces);
        while (const Face* face = reader.next()) sorter.add(*face);
    }
    faces.release();
    const ooc::Spool<Face> sorted = sorter.finish();
    ooc::Spool<Face> settled(context, "faces between blocks");
    const auto emit = [&](const Face& face) { settled.push(face); };
    const auto visit = [&](const auto& take) {
        ooc::SpoolReader<Face> reader(sorted);
        while (const Face* face = reader.next()) take(*face);
    };
    DuplicateSettler<Face, decltype(emit)> settler(keeps_copies<Face>(is_closed, visit), emit);
    visit([&](const Face& face) { settler.add(face); });
    settler.finish();
    return settled;
}

Seams::Seams(ooc::Context& context, ooc::Spool<Face> faces, const IdRanges& blocks)
    : frozen_(context, "frozen vertices"),
      crossing_(context, "faces between blocks"),
      first_inside_(blocks.size() + 1),
      first_frozen_(blocks.size() + 1) {
    ooc::ExternalSorter<Face, std::less<>> inside(context, "faces between blocks", {},
                                                  context.sort_bytes());
    ooc::ExternalSorter<VertexId, std::less<>> frozen(context, "frozen vertices", {},
                                                      context.sort_bytes());
    ooc::SpoolReader<Face> reader(faces);
    while (const Face* face = reader.next()) {
        const std::size_t b = blocks.find((*face)[0]);
        if (b == blocks.find((*face)[1]) && b == blocks.find((*face)[2])) {
            inside.add(*face);
            ++first_inside_[b + 1];
        } else {
            crossing_.push(*face);
            for (const VertexId id : *face) frozen.add(id);
        }
    }
    faces.release();
    inside_ = inside.finish();
    for (std::size_t b = 0; b < blocks.size(); ++b) first_inside_[b + 1] += first_inside_[b];

    const ooc::Spool<VertexId> repeated = frozen.finish();
    ooc::SpoolReader<VertexId> ids(repeated);
    VertexId last = ~VertexId{0};
    while (const VertexId* id = ids.next()) {
        if (*id == last) continue;
        last = *id;
        frozen_.push(last);
        ++first_frozen_[blocks.find(last) + 1];
    }
    for (std::size_t b = 0; b < blocks.size(); ++b) first_frozen_[b + 1] += first_frozen_[b];
}

std::vector<Face> Seams::inside(std::size_t block) const {
    return read(inside_, first_inside_[block], first_inside_[block + 1]);
}

std::vector<VertexId> Seams::frozen(std::size_t block) const {
    return read(frozen_, first_frozen_[block], first_frozen_[block + 1]);
}

}  // namespace hewer::rsimp
