// SPDX-License-Identifier: MIT
#include "streaming/weld.h"

#include <array>
#include <functional>
#include <utility>

#include "ooc/external_sort.h"
#include "streaming/equal_corners.h"

namespace hewer::streaming {

namespace {

/// A corner, the first corner in its place, and the place.
template <typename Real>
struct UsedCorner {
    std::uint64_t first;
    std::uint64_t number;
    std::array<Real, 3> position;

    bool operator<(const UsedCorner& o) const {
        return first != o.first ? first < o.first : number < o.number;
    }
};

/// A corner, and its vertex.
using NumberedCorner = std::array<std::uint64_t, 2>;

template <typename Real>
WeldedMesh weld_as(ooc::Context& context, MeshSource& soup) {
    WeldedMesh mesh{ooc::Spool<Vec3>(context, "welded vertices"),
                    ooc::Spool<Triangle>(context, "welded triangles"),
                    {}};
    using Used = UsedCorner<Real>;
    ooc::ExternalSorter<Used, std::less<>> by_first_use(context, "corners by first use", {},
                                                        ample_sort_bytes(context));
    mesh.defects = for_equal_corners<Real>(
        context, soup,
        [&](const std::array<Real, 3>& place, std::uint64_t first, std::uint64_t number) {
            by_first_use.add(Used{first, number, place});
        });
    ooc::ExternalSorter<NumberedCorner, std::less<>> by_number(context, "corners by triangle", {},
                                                               ample_sort_bytes(context));
    constexpr std::uint64_t kBetween = 1 << 16;
    {
        ooc::Spool<Used> used = by_first_use.finish();
        ooc::SpoolReader<Used> reader(used);
        while (const Used* corner = reader.next()) {
            if (corner->number == corner->first) {
                const auto& p = corner->position;
                mesh.positions.push({static_cast<double>(p[0]), static_cast<double>(p[1]),
                                     static_cast<double>(p[2])});
            }
            by_number.add({corner->number, mesh.positions.size() - 1});
            if (reader.position() % kBetween == 0) {
                used.discard_before(reader.position());
                context.check_stop();
            }
        }
    }
    ooc::Spool<NumberedCorner> corners = by_number.finish();
    ooc::SpoolReader<NumberedCorner> reader(corners);
    while (reader.peek() != nullptr) {
        Triangle t{};
        for (std::uint64_t& v : t) v = (*reader.next())[1];
        mesh.triangles.push(t);
        if (mesh.triangles.size() % kBetween == 0) {
            corners.discard_before(reader.position());
            context.check_stop();
        }
    }
    return mesh;
}

}  // namespace

WeldedMesh weld(ooc::Context& context, MeshSource& soup) {
    return soup.info().has_double_positions ? weld_as<double>(context, soup)
                                            : weld_as<float>(context, soup);
}

}  // namespace hewer::streaming
