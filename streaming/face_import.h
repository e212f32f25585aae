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
    static constexpr std::uint64_t kNoTexcoord = ~std::uint64_t{0};

    /// A face of more than three corners.
    struct Polygon {
        std::size_t first_triangle;
        std::size_t n_triangles;
        std::uint64_t n_known;                      ///< vertices in front of it, in the chunk
        std::optional<std::size_t> first_texcoord;  ///< in `texcoords`
    };
    /// Triangles whose corners all have texture coordinates.
    struct Textured {
        std::size_t first_triangle;
        std::size_t n_triangles;
    };
    std::vector<Triangle> triangles;
    std::vector<Triangle> texcoords;  ///< of the triangles of `textured`, one after the other
    std::vector<Textured> textured;
    std::vector<Polygon> polygons;
    std::uint64_t n_faces = 0;
    std::uint64_t n_short = 0;  ///< of fewer than three corners

    void clear() {
        triangles.clear();
        texcoords.clear();
        textured.clear();
        polygons.clear();
        n_faces = n_short = 0;
    }
};

/// One face of a chunk, corner by corner.
class TextFace {
  public:
    explicit TextFace(TextFaces& faces)
        : faces_(faces),
          first_triangle_(faces.triangles.size()),
          first_texcoord_(faces.texcoords.size()) {}

    void add(std::uint64_t id, std::uint64_t texcoord = TextFaces::kNoTexcoord) {
        is_textured_ = is_textured_ && texcoord != TextFaces::kNoTexcoord;
        if (n_corners_ == 0) {
            first_ = {id, texcoord};
        } else if (n_corners_ > 1) {
            faces_.triangles.push_back({first_.id, previous_.id, id});
            if (is_textured_) {
                faces_.texcoords.push_back({first_.texcoord, previous_.texcoord, texcoord});
            }
        }
        previous_ = {id, texcoord};
        ++n_corners_;
    }
    [[nodiscard]] bool is_short() const { return n_corners_ < 3; }

    /// @param n_known  vertices in front of it, in the chunk.
    void finish(std::uint64_t n_known) {
        ++faces_.n_faces;
        if (is_short()) {
            ++faces_.n_short;
            return;
        }
        std::optional<std::size_t> first_texcoord;
        if (is_textured_) {
            first_texcoord = first_texcoord_;
            note_textured();
        } else {
            faces_.texcoords.resize(first_texcoord_);
        }
        if (n_corners_ > 3) {
            faces_.polygons.push_back({first_triangle_, n_corners_ - 2, n_known, first_texcoord});
        }
    }

  private:
    void note_textured() {
        const std::size_t n = n_corners_ - 2;
        if (!faces_.textured.empty()) {
            TextFaces::Textured& last = faces_.textured.back();
            if (last.first_triangle + last.n_triangles == first_triangle_) {
                last.n_triangles += n;
                return;
            }
        }
        faces_.textured.push_back({first_triangle_, n});
    }

    struct Corner {
        std::uint64_t id = 0;
        std::uint64_t texcoord = 0;
    };
    TextFaces& faces_;
    std::size_t first_triangle_;
    std::size_t first_texcoord_;
    std::size_t n_corners_ = 0;
    bool is_textured_ = true;  // so far
    Corner first_;
    Corner previous_;
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

    /// Names in MeshImport::ignore() what had to stay a fan, and gives the memory back. Once, at
    /// the end.
    void finish();

  private:
    /// `texcoords`, of the same triangles, may be empty.
    void cut(std::span<Triangle> fan, std::span<Triangle> texcoords, std::uint64_t n_known);
    void make_cache();

    MeshImport& import_;
    std::uint64_t most_vertices_;
    ooc::Reservation memory_;
    std::optional<ooc::SpoolCache<Vec3>> positions_;
    PolygonTriangulation triangulation_;
    std::vector<std::uint64_t> ids_;
    std::vector<std::uint64_t> texcoords_;
    std::vector<Vec3> corners_;
    std::uint64_t n_fanned_ = 0;
};

}  // namespace hewer::streaming
