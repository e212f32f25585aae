// SPDX-License-Identifier: MIT
#include "streaming/obj_reader.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "streaming/face_import.h"
#include "streaming/obj_materials.h"
#include "streaming/obj_parser.h"
#include "streaming/text_colors.h"

namespace hewer::streaming {

namespace {

constexpr std::uint64_t kLeastVertexBytes = 8;  // "v 0 0 0" and a line end

/// Normals of a file as those of its vertices, as long as every corner has the one of its vertex.
class ObjNormals {
  public:
    explicit ObjNormals(MeshImport& import)
        : import_(import), normals_(import.context(), "imported normals") {}

    void add(const ObjChunk& chunk, std::uint64_t n_vertices_before) {
        const std::int64_t shift =
            static_cast<std::int64_t>(n_vertices_before) - static_cast<std::int64_t>(n_before_);
        n_before_ += chunk.normals.size();
        are_used_ = are_used_ || chunk.has_corners_with_normal;
        are_dropped_ = are_dropped_ || chunk.has_corners_without_normal ||
                       chunk.has_other_normals ||
                       chunk.relative_normal_shift.value_or(shift) != shift;
        if (are_dropped_) {
            normals_.release();
        } else {
            normals_.append(chunk.normals);
        }
    }

    void finish() {
        if (n_before_ == 0) return;
        if (are_used_ && !are_dropped_ && n_before_ <= import_.n_vertices()) {
            import_.take_normals(std::move(normals_));
        } else {
            import_.ignore("normals that are not one for each vertex");
        }
    }

  private:
    MeshImport& import_;
    ooc::Spool<std::array<float, 3>> normals_;
    std::uint64_t n_before_ = 0;
    bool are_used_ = false;
    bool are_dropped_ = false;
};

class ObjImport {
  public:
    ObjImport(const ooc::InputFile& file, const OpenOptions& options, const Hooks& hooks,
              const TextTuning& tuning)
        : import_(file.path().string(), "OBJ", file.size(), options, hooks),
          text_(std::in_place, file, import_, find_line_cut, tuning),
          findings_(import_, file.path().string(), "vertex"),
          colors_(import_),
          normals_(import_),
          materials_(import_, file.path(), options, hooks),
          faces_(import_, file.size() / kLeastVertexBytes) {}

    std::unique_ptr<MeshSource> run() {
        text_->run<ObjChunk>(
            text_->chunks(), 1, [](TextChunk& chunk, ObjChunk& found) { parse_obj(chunk, found); },
            [&](ObjChunk& found, std::uint64_t line, std::uint64_t i) {
                add(found, line, i);
                return true;
            });
        place_out_of_range();
        text_.reset();  // its memory is for textures
        if (!first_unknown_.empty()) {
            import_.ignore("lines that are not known to be OBJ, such as those that begin with " +
                           first_unknown_);
        }
        colors_.finish();
        normals_.finish();
        faces_.finish();
        materials_.finish();
        return import_.finish();
    }

  private:
    /// A chunk with the highest id so far, if that was no vertex when the chunk was read.
    struct Suspect {
        std::uint64_t chunk;
        std::uint64_t highest_id;
        std::uint64_t first_line;
        std::uint64_t n_vertices_before;
        std::uint64_t n_faces_before;
    };

    void add(ObjChunk& chunk, std::uint64_t line, std::uint64_t number) {
        const std::uint64_t n_vertices_before = import_.n_vertices();
        findings_.note(chunk.dirt, n_vertices_before, n_faces_before_, line);
        normals_.add(chunk, n_vertices_before);
        import_.add_vertices({chunk.positions, {}, {}});
        colors_.add(chunk.colors, chunk.positions.size());
        if (chunk.has_relative_ids) resolve(chunk, n_vertices_before);
        const std::uint64_t highest_before = suspects_.empty() ? 0 : suspects_.back().highest_id;
        if (chunk.highest_id >= import_.n_vertices() && chunk.highest_id > highest_before) {
            suspects_.push_back(
                {number, chunk.highest_id, line, n_vertices_before, n_faces_before_});
        }
        n_faces_before_ += chunk.faces.n_faces;
        faces_.add(chunk.faces, n_vertices_before);
        materials_.add(chunk);
        for (const std::string& what : chunk.ignored) import_.ignore(what);
        if (first_unknown_.empty()) first_unknown_ = chunk.first_unknown;
    }

    static void resolve(ObjChunk& chunk, std::uint64_t n_vertices_before) {
        for (Triangle& triangle : chunk.faces.triangles) {
            for (std::uint64_t& id : triangle) {
                id = ObjId::resolve(id, n_vertices_before);
                chunk.highest_id = std::max(chunk.highest_id, id);
            }
        }
    }

    /// Only now is it known how many vertices there are. The first chunk with an id beyond them has
    /// a higher one than all before it; it is read once more, to find the face and its line.
    void place_out_of_range() {
        const auto it = std::find_if(
            suspects_.begin(), suspects_.end(),
            [&](const Suspect& suspect) { return suspect.highest_id >= import_.n_vertices(); });
        if (it == suspects_.end()) return;
        TextChunk chunk;
        text_->chunks().read(it->chunk, chunk);
        const auto place = find_out_of_range(chunk, import_.n_vertices(), it->n_vertices_before);
        if (!place) throw InternalError("a vertex id has changed since it was read");
        findings_.note({.nonfinite = {}, .short_face = {}, .out_of_range = place},
                       it->n_vertices_before, it->n_faces_before, it->first_line);
    }

    MeshImport import_;
    std::optional<TextImport> text_;  // until all is parsed
    TextFindings findings_;
    TextColors colors_;
    ObjNormals normals_;
    ObjMaterials materials_;
    FaceImport faces_;
    std::uint64_t n_faces_before_ = 0;
    std::string first_unknown_;
    std::vector<Suspect> suspects_;
};

}  // namespace

std::unique_ptr<MeshSource> open_obj(const ooc::InputFile& file, const OpenOptions& options,
                                     const Hooks& hooks, const TextTuning& tuning) {
    return ObjImport(file, options, hooks, tuning).run();
}

}  // namespace hewer::streaming
