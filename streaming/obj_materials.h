// SPDX-License-Identifier: MIT
/// Materials of an OBJ: which triangle has which, and what that makes of its colours.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "streaming/mesh_import.h"
#include "streaming/mtl_reader.h"
#include "streaming/obj_parser.h"
#include "streaming/vertex_paint.h"

namespace hewer::streaming {

/// Collects texture coordinates and materials while an OBJ is imported, and turns them into colours
/// of vertices at the end (see docs/textures.md).
///
/// Temporary disk: 8 bytes for each texture coordinate; 20 for each triangle that follows a
/// "mtllib"; then those of TextureSet and 8 bytes a vertex. Memory: names of materials, kMostNames
/// at most; at the end that of TextureSet and paint_vertices().
class ObjMaterials {
  public:
    static constexpr std::size_t kMostNames = 65536;
    static constexpr std::size_t kMostLibraries = 64;
    static constexpr std::size_t kMostNameBytes = 1024;

    ObjMaterials(MeshImport& import, std::filesystem::path obj, const OpenOptions& options,
                 const Hooks& hooks);

    /// Chunk by chunk, in the order of the file, after its faces went into the import.
    void add(const ObjChunk& chunk);
    /// Once, after all else is in the import, colours that stand at the vertices included: these
    /// stay where no material gives a colour.
    void finish();

  private:
    /// What is kept of a triangle.
    struct Record {
        PackedTriangle texcoords;
        std::uint32_t material;  ///< PaintedTriangle::kNoPaint: none
    };
    static_assert(sizeof(Record) == 20);

    std::uint32_t number_of(const std::string& name);
    void add_records(const ObjChunk& chunk, std::size_t first, std::size_t last);
    void add_library(const std::string& line);
    [[nodiscard]] bool differs(const std::vector<Paint>& paints) const;
    void read_libraries(ooc::Context& context, TextureSet& textures, MtlLibrary& library);
    std::vector<std::filesystem::path> split_names(const std::string& line) const;
    std::vector<Paint> make_paints(const MtlLibrary& library, TextureSet& textures);
    Paint make_paint(const MtlMaterial& material, TextureSet& textures);
    void paint(ooc::Context& context, std::vector<Paint> paints, const TextureSet& textures);

    MeshImport& import_;
    std::filesystem::path obj_;
    OpenOptions options_;
    Hooks hooks_;
    ooc::Spool<std::array<float, 2>> texcoords_;
    ooc::Spool<Record> records_;  // of the triangles from first_triangle_ on
    std::uint64_t first_triangle_ = 0;
    std::vector<std::string> library_lines_;
    std::map<std::string, std::uint32_t> numbers_;  // of materials, by name
    std::vector<bool> is_used_;                     // by number
    std::uint32_t material_ = PaintedTriangle::kNoPaint;
    std::map<std::filesystem::path, std::optional<std::size_t>> texture_numbers_;

    // Of the chunk at hand.
    std::uint64_t n_texcoords_before_ = 0;
    std::size_t next_texcoord_ = 0;
    std::size_t next_textured_ = 0;
};

}  // namespace hewer::streaming
