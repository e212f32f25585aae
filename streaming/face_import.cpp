// SPDX-License-Identifier: MIT
#include "streaming/face_import.h"

#include <algorithm>
#include <bit>

#include "ooc/units.h"

namespace hewer::streaming {

namespace {

using Cache = ooc::SpoolCache<Vec3>;
constexpr std::uint64_t kMostLines = std::uint64_t{1} << 18;  // 1 GiB

}  // namespace

void FaceImport::make_cache() {
    ooc::MemoryBudget& budget = import_.context().budget();
    constexpr std::uint64_t kBytesPerLine = Cache::kBytes / Cache::kLines;
    const std::uint64_t n_affordable = budget.available() / 4 / kBytesPerLine;
    const std::uint64_t n_useful = most_vertices_ / (Cache::kLineBytes / sizeof(Vec3)) + 1;
    const std::uint64_t n_lines =
        std::bit_floor(std::clamp(std::min(n_affordable, n_useful), Cache::kLines, kMostLines));
    memory_ = budget.reserve("vertices of polygons", n_lines * kBytesPerLine);
    positions_.emplace(import_.positions(), n_lines);
}

void FaceImport::add(TextFaces& faces, std::uint64_t n_vertices_before) {
    for (const TextFaces::Polygon& polygon : faces.polygons) {
        cut({faces.triangles.data() + polygon.first_triangle, polygon.n_triangles},
            n_vertices_before + polygon.n_known);
    }
    import_.add_triangles(faces.triangles);
    import_.defects().polygons += faces.polygons.size();
    import_.defects().short_faces += faces.n_short;
}

void FaceImport::cut(std::span<Triangle> fan, std::uint64_t n_known) {
    ids_.assign({fan[0][0], fan[0][1]});
    for (const Triangle& triangle : fan) ids_.push_back(triangle[2]);
    if (ids_.size() > kMostCorners || *std::max_element(ids_.begin(), ids_.end()) >= n_known) {
        ++n_fanned_;
        return;
    }
    if (!positions_) make_cache();
    corners_.clear();
    for (const std::uint64_t id : ids_) corners_.push_back(positions_->at(id));
    const PolygonTriangles& triangles = triangulation_.triangulate(corners_);
    for (std::size_t i = 0; i < fan.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) fan[i][k] = ids_[triangles[i][k]];
    }
}

void FaceImport::finish() {
    if (n_fanned_ == 0) return;
    import_.ignore("the shape of " + ooc::format_count(n_fanned_) +
                   " polygons that are described before their vertices or have more than " +
                   std::to_string(kMostCorners) + " corners; they were cut as if they were convex");
}

}  // namespace hewer::streaming
