// SPDX-License-Identifier: MIT
#include "streaming/obj_materials.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hewer/error.h"
#include "streaming/temporary_input.h"

namespace hewer::streaming {

namespace {

constexpr Rgba16 kWhite{65535, 65535, 65535, 65535};
constexpr std::uint64_t kNoTexcoord = PackedTriangle::kMostVertices - 1;
constexpr Triangle kNoTexcoords{kNoTexcoord, kNoTexcoord, kNoTexcoord};

/// What is left of the limits of an import, for work at its end. Its progress is over.
ooc::ResourceLimits limits_beside(MeshImport& import, const OpenOptions& options) {
    ooc::Context& context = import.context();
    const std::uint64_t held = context.budget().used() - ooc::MemoryBudget::kFixedBytes;
    const OpenOptions left = beside(options, context.spill().used());
    return {.memory_bytes = context.budget().limit() - held,
            .n_threads = options.n_threads,
            .temp_dir = options.temp_dir,
            .max_temp_bytes = left.max_temp_bytes};
}

}  // namespace

ObjMaterials::ObjMaterials(MeshImport& import, std::filesystem::path obj,
                           const OpenOptions& options, const Hooks& hooks)
    : import_(import),
      obj_(std::move(obj)),
      options_(options),
      hooks_{.on_progress = {}, .on_warning = hooks.on_warning, .stop = hooks.stop},
      texcoords_(import.context(), "imported texture coordinates"),
      records_(import.context(), "imported materials") {}

std::uint32_t ObjMaterials::number_of(const std::string& name) {
    const auto it = numbers_.find(name);
    if (it != numbers_.end()) return it->second;
    if (numbers_.size() == kMostNames || name.size() > kMostNameBytes) {
        import_.ignore("materials beyond the first " + std::to_string(kMostNames) +
                       " or with a name of more than " + std::to_string(kMostNameBytes) +
                       " characters");
        return PaintedTriangle::kNoPaint;
    }
    const auto number = static_cast<std::uint32_t>(numbers_.size());
    numbers_.emplace(name, number);
    is_used_.push_back(false);
    return number;
}

void ObjMaterials::add(const ObjChunk& chunk) {
    n_texcoords_before_ = texcoords_.size();
    texcoords_.append(chunk.texcoords);
    const std::size_t n_triangles = chunk.faces.triangles.size();
    std::size_t first = 0;
    if (library_lines_.empty()) {
        first = chunk.material_files.empty() ? n_triangles : chunk.material_files.front().n_before;
        first_triangle_ = import_.triangles().size() - n_triangles + first;
    }
    for (const ObjChunk::MaterialLine& line : chunk.material_files) add_library(line.text);
    next_texcoord_ = next_textured_ = 0;
    std::size_t done = 0;
    for (const ObjChunk::MaterialLine& line : chunk.used_materials) {
        add_records(chunk, std::max(done, first), line.n_before);
        done = line.n_before;
        material_ = number_of(line.text);
    }
    add_records(chunk, std::max(done, first), n_triangles);
}

void ObjMaterials::add_library(const std::string& line) {
    std::vector<std::string>& all = library_lines_;
    if (std::find(all.begin(), all.end(), line) != all.end()) return;
    if (all.size() == kMostLibraries || line.size() > kMostNameBytes) {
        import_.ignore("material libraries beyond the first " + std::to_string(kMostLibraries) +
                       " or with a name of more than " + std::to_string(kMostNameBytes) +
                       " characters");
        return;
    }
    all.push_back(line);
}

/// Triangles `first` .. `last` - 1 of the chunk; called with rising numbers.
void ObjMaterials::add_records(const ObjChunk& chunk, std::size_t first, std::size_t last) {
    if (first >= last) return;
    if (material_ != PaintedTriangle::kNoPaint) is_used_[material_] = true;
    std::vector<Record> records;
    records.reserve(last - first);
    const std::vector<TextFaces::Textured>& textured = chunk.faces.textured;
    for (std::size_t i = first; i < last; ++i) {
        // Runs of textured triangles that end in front of this one are passed by.
        while (next_textured_ < textured.size() &&
               textured[next_textured_].first_triangle + textured[next_textured_].n_triangles <=
                   i) {
            next_texcoord_ += textured[next_textured_++].n_triangles;
        }
        Triangle ids = kNoTexcoords;
        if (next_textured_ < textured.size() && textured[next_textured_].first_triangle <= i) {
            const std::size_t in_run = i - textured[next_textured_].first_triangle;
            ids = chunk.faces.texcoords[next_texcoord_ + in_run];
            for (std::uint64_t& id : ids) {
                id = std::min(ObjId::resolve(id, n_texcoords_before_), kNoTexcoord);
            }
        }
        records.push_back({PackedTriangle(ids), material_});
    }
    records_.append(records);
}

void ObjMaterials::finish() {
    const bool has_coordinates = !texcoords_.empty();
    bool is_painted = false;
    if (!library_lines_.empty()) {
        ooc::Context context(limits_beside(import_, options_), hooks_);
        TextureSet textures(context);
        MtlLibrary library;
        read_libraries(context, textures, library);
        std::vector<Paint> paints = make_paints(library, textures);
        is_painted = differs(paints);
        if (is_painted) paint(context, std::move(paints), textures);
        import_.set_textures(textures.infos());
        for (const std::string& what : textures.missing()) import_.ignore(what);
    }
    if (has_coordinates && !is_painted) import_.ignore("texture coordinates");
}

/// A colour that all of the mesh has is its paint, and nothing for each vertex to carry.
bool ObjMaterials::differs(const std::vector<Paint>& paints) const {
    const Paint* first = nullptr;
    for (std::size_t i = 0; i < paints.size(); ++i) {
        if (!is_used_[i]) continue;
        if (first == nullptr) first = &paints[i];
        if (paints[i].texture || paints[i].color != first->color) return true;
    }
    return false;
}

/// "mtllib a.mtl b.mtl", or a name with blanks in it: of the names that can be meant, the longest
/// that is there counts.
std::vector<std::filesystem::path> ObjMaterials::split_names(const std::string& line) const {
    std::vector<std::filesystem::path> result;
    const std::filesystem::path folder = obj_.parent_path();
    std::string left = line;
    while (!left.empty()) {
        std::size_t end = left.size();
        std::filesystem::path path = find_beside(folder, left);
        std::error_code error;
        while (!std::filesystem::exists(path, error)) {
            const std::size_t blank = left.find_last_of(" \t", end - 1);
            if (blank == std::string::npos || blank == 0) break;
            end = left.find_last_not_of(" \t", blank) + 1;
            path = find_beside(folder, left.substr(0, end));
        }
        result.push_back(std::move(path));
        const std::size_t next = left.find_first_not_of(" \t", end);
        left = next == std::string::npos ? std::string() : left.substr(next);
    }
    return result;
}

void ObjMaterials::read_libraries(ooc::Context& context, TextureSet& textures,
                                  MtlLibrary& library) {
    for (const std::string& line : library_lines_) {
        for (const std::filesystem::path& path : split_names(line)) {
            try {
                read_mtl(context, path, library);
            } catch (const IoError& error) {
                textures.miss("materials " + path.string(), error.what(), options_.strict);
            } catch (const FormatError& error) {
                textures.miss("materials " + path.string(), error.what(), options_.strict);
            }
        }
    }
}

/// By the numbers of materials. Those without a face are nothing, which no triangle asks for.
std::vector<Paint> ObjMaterials::make_paints(const MtlLibrary& library, TextureSet& textures) {
    std::vector<Paint> paints(numbers_.size());
    // In the order of the file, so that warnings and textures come in that order.
    std::vector<const std::string*> names(numbers_.size());
    for (const auto& [name, number] : numbers_) names[number] = &name;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!is_used_[i]) continue;
        const auto it = library.find(*names[i]);
        if (it == library.end()) {
            import_.ignore("materials that no library defines, such as " + *names[i]);
            continue;
        }
        paints[i] = make_paint(it->second, textures);
        if (!it->second.other_map.empty()) {
            import_.ignore("maps of materials other than map_Kd, such as " + it->second.other_map);
        }
    }
    return paints;
}

Paint ObjMaterials::make_paint(const MtlMaterial& material, TextureSet& textures) {
    Paint paint;
    if (material.map.empty()) {
        paint.color = material.color;
        return paint;
    }
    const auto [it, is_new] = texture_numbers_.try_emplace(material.map);
    if (is_new) {
        it->second = textures.add_file(material.map, options_.strict);
    }
    paint.texture = it->second;
    // v goes up in OBJ.
    paint.to_image = {{{material.scale[0], 0, material.offset[0]},
                       {0, -material.scale[1], 1 - material.offset[1]}}};
    if (material.is_clamped) paint.wrap = {Wrap::Clamp, Wrap::Clamp};
    return paint;
}

void ObjMaterials::paint(ooc::Context& context, std::vector<Paint> paints,
                         const TextureSet& textures) {
    PaintedMesh mesh;
    mesh.n_vertices = import_.n_vertices();
    mesh.load_positions = [&](std::uint64_t first, std::uint64_t n, Vec3* out) {
        import_.positions().read(first, {out, n});
    };
    mesh.n_texcoords = texcoords_.size();
    mesh.load_texcoords = [&](std::uint64_t first, std::uint64_t n, std::array<float, 2>* out) {
        texcoords_.read(first, {out, n});
    };
    mesh.n_triangles = records_.size();
    mesh.read_triangles = [&](std::uint64_t first, std::span<PaintedTriangle> out) {
        std::vector<PackedTriangle> corners(out.size());
        import_.triangles().read(first_triangle_ + first, corners);
        std::vector<Record> records(out.size());
        records_.read(first, records);
        for (std::size_t i = 0; i < out.size(); ++i) {
            out[i] = {corners[i].unpack(), records[i].texcoords.unpack(), records[i].material};
        }
    };
    mesh.paints = std::move(paints);

    const ooc::Spool<Rgba16>& others = import_.colors();
    ooc::Spool<Rgba16> colors(import_.context(), "imported colours");
    std::vector<Rgba16> piece;
    paint_vertices(context, mesh, textures, [&](std::span<const VertexColor> painted) {
        piece.assign(painted.size(), kWhite);
        const std::uint64_t first = colors.size();
        if (first < others.size()) {
            others.read(first, std::span(piece).first(
                                   std::min<std::uint64_t>(piece.size(), others.size() - first)));
        }
        for (std::size_t i = 0; i < painted.size(); ++i) {
            if (painted[i]) piece[i] = to_rgba(*painted[i]);
        }
        colors.append(piece);
    });
    import_.take_colors(std::move(colors));
    texcoords_.release();
    records_.release();
}

}  // namespace hewer::streaming
