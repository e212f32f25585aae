// SPDX-License-Identifier: MIT
#include "streaming/weld.h"

#include <array>
#include <vector>

#include "streaming/equal_corners.h"

namespace hewer::streaming {

Weld::Weld(ooc::Context& context, MeshSource& soup)
    : context_(context),
      soup_(soup),
      firsts_(context.budget(), "vertices of a triangle soup", 3 * soup.info().n_faces),
      by_number_(context, "corners by triangle", {}, ample_sort_bytes(context)) {
    if (soup.info().has_double_positions) {
        weld<double>();
    } else {
        weld<float>();
    }
    n_vertices_ = firsts_.number();
}

template <typename Real>
void Weld::weld() {
    std::uint64_t n_corners = 0;
    defects_ = for_equal_corners<Real>(
        context_, soup_,
        [&](const std::array<Real, 3>& place, std::uint64_t first, std::uint64_t number) {
            by_number_.add({number, first});
            ++n_corners;
            if (number != first) return;
            firsts_.insert(number);
            bounds_.extend(Vec3{place[0], place[1], place[2]});
        });
    n_triangles_ = n_corners / 3;
}

void Weld::for_vertices(const std::function<void(std::span<const Vec3>)>& take) {
    std::vector<Vec3> piece;
    TriangleBatch batch;
    soup_.begin_triangles();
    while (soup_.next_triangles(batch)) {
        piece.clear();
        std::uint64_t number = 3 * batch.first_face;
        for (const auto& t : batch.points) {
            for (const Vec3& p : t) {
                // Plus zero: -0 becomes 0.
                if (firsts_.has(number++)) piece.push_back({p[0] + 0., p[1] + 0., p[2] + 0.});
            }
        }
        take(piece);
        context_.check_stop();
    }
}

void Weld::for_triangles(const std::function<void(std::span<const Triangle>)>& take) {
    constexpr std::size_t kPiece = 1 << 13;
    std::vector<Triangle> piece;
    auto corners = by_number_.stream();
    while (corners.peek() != nullptr) {
        piece.clear();
        while (piece.size() < kPiece && corners.peek() != nullptr) {
            Triangle& t = piece.emplace_back();
            for (std::uint64_t& v : t) v = firsts_.rank(corners.next()->first);
        }
        take(piece);
        context_.check_stop();
    }
}

}  // namespace hewer::streaming
