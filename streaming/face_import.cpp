// SPDX-License-Identifier: MIT
#include "streaming/face_import.h"

#include <algorithm>
#include <bit>

#include "ooc/units.h"

namespace hewer::streaming {

namespace {

using Cache = ooc::SpoolCache<Vec3>;
constexpr std::uint64_t kMostLines = std::uint64_t{1} << 18;  // 1 GiB

/// What stands at the corners of a polygon, from its fan.
void take_corners(std::span<const Triangle> fan, std::vector<std::uint64_t>& corners) {
    corners.assign({fan[0][0], fan[0][1]});
    for (const Triangle& triangle : fan) corners.push_back(triangle[2]);
}

void put_corners(const PolygonTriangles& triangles, const std::vector<std::uint64_t>& corners,
                 std::span<Triangle> out) {
    for (std::size_t i = 0; i < out.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) out[i][k] = corners[triangles[i][k]];
    }
}

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
        const std::span<Triangle> texcoords =
            polygon.first_texcoord
                ? std::span(faces.texcoords).subspan(*polygon.first_texcoord, polygon.n_triangles)
                : std::span<Triangle>();
        cut(std::span(faces.triangles).subspan(polygon.first_triangle, polygon.n_triangles),
            texcoords, n_vertices_before + polygon.n_known);
    }
    import_.add_triangles(faces.triangles);
    import_.defects().polygons += faces.polygons.size();
    import_.defects().short_faces += faces.n_short;
}

void FaceImport::cut(std::span<Triangle> fan, std::span<Triangle> texcoords,
                     std::uint64_t n_known) {
    take_corners(fan, ids_);
    if (ids_.size() > kMostCorners || *std::max_element(ids_.begin(), ids_.end()) >= n_known) {
        ++n_fanned_;
        return;
    }
    if (!positions_) make_cache();
    corners_.clear();
    for (const std::uint64_t id : ids_) corners_.push_back(positions_->at(id));
    const PolygonTriangles& triangles = triangulation_.triangulate(corners_);
    put_corners(triangles, ids_, fan);
    if (texcoords.empty()) return;
    take_corners(texcoords, texcoords_);
    put_corners(triangles, texcoords_, texcoords);
}

void FaceImport::finish() {
    positions_.reset();
    memory_.release();
    if (n_fanned_ == 0) return;
    import_.ignore("the shape of " + ooc::format_count(n_fanned_) +
                   " polygons that are described before their vertices or have more than " +
                   std::to_string(kMostCorners) + " corners; they were cut as if they were convex");
}

}  // namespace hewer::streaming
