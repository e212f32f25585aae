// SPDX-License-Identifier: MIT
/// Faces of text formats, of any size, on their way into an import.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ooc/memory_budget.h"
#include "ooc/spool_cache.h"
#include "streaming/mesh_import.h"
#include "streaming/polygon.h"

namespace hewer::streaming {

/// The faces of a chunk as fans.
struct TextFaces {
    /// A face of more than three corners.
    struct Polygon {
        std::size_t first_triangle;
        std::size_t n_triangles;
        std::uint64_t n_known;  ///< vertices in front of it, in the chunk
    };
    std::vector<Triangle> triangles;
    std::vector<Polygon> polygons;
    std::uint64_t n_faces = 0;
    std::uint64_t n_short = 0;  ///< of fewer than three corners

    void clear() {
        triangles.clear();
        polygons.clear();
        n_faces = n_short = 0;
    }
};

/// One face of a chunk, corner by corner.
class TextFace {
  public:
    explicit TextFace(TextFaces& faces) : faces_(faces), first_triangle_(faces.triangles.size()) {}

    void add(std::uint64_t id) {
        if (n_corners_ == 0) {
            first_ = id;
        } else if (n_corners_ > 1) {
            faces_.triangles.push_back({first_, previous_, id});
        }
        previous_ = id;
        ++n_corners_;
    }
    [[nodiscard]] bool is_short() const { return n_corners_ < 3; }

    /// @param n_known  vertices in front of it, in the chunk.
    void finish(std::uint64_t n_known) {
        ++faces_.n_faces;
        if (is_short()) ++faces_.n_short;
        if (n_corners_ > 3) faces_.polygons.push_back({first_triangle_, n_corners_ - 2, n_known});
    }

  private:
    TextFaces& faces_;
    std::size_t first_triangle_;
    std::size_t n_corners_ = 0;
    std::uint64_t first_ = 0;
    std::uint64_t previous_ = 0;
};

/// Takes the faces of one chunk after the other. Polygons that are not convex are cut anew, with
/// their corners looked up among the vertices that were imported.
///
/// Memory: nothing before the first polygon; then a cache of vertices, at least 256 KiB, else up to
/// a quarter of what is free. Polygons whose corners are spread over more vertices than it holds
/// cost a read of temporary disk for each corner.
class FaceImport {
  public:
    /// Beyond that a polygon stays a fan.
    static constexpr std::size_t kMostCorners = 4096;

    /// @param most_vertices  that the import can come to have.
    FaceImport(MeshImport& import, std::uint64_t most_vertices)
        : import_(import), most_vertices_(most_vertices) {}

    /// Adds them to the import and counts polygons and short faces in its defects; ids are those of
    /// the file. A polygon with a corner that is no vertex in front of it stays a fan.
    void add(TextFaces& faces, std::uint64_t n_vertices_before);

    /// Names in MeshImport::ignore() what had to stay a fan. Once, at the end.
    void finish();

  private:
    void cut(std::span<Triangle> fan, std::uint64_t n_known);
    void make_cache();

    MeshImport& import_;
    std::uint64_t most_vertices_;
    ooc::Reservation memory_;
    std::optional<ooc::SpoolCache<Vec3>> positions_;
    PolygonTriangulation triangulation_;
    std::vector<std::uint64_t> ids_;
    std::vector<Vec3> corners_;
    std::uint64_t n_fanned_ = 0;
};

}  // namespace hewer::streaming
