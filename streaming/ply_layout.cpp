// SPDX-License-Identifier: MIT
#include "streaming/ply_layout.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "hewer/error.h"
#include "ooc/units.h"

namespace hewer::streaming {

namespace {

using Names = std::array<const char*, 3>;

std::optional<PlyField> find_scalar(const PlyElement& element, const std::string& name) {
    std::size_t offset = 0;
    for (const PlyProperty& p : element.properties) {
        if (p.is_list) continue;
        if (p.name == name) return PlyField{p.type, offset};
        offset += byte_size(p.type);
    }
    return std::nullopt;
}

/// All three or nothing; the names found are added to `carried`.
std::optional<std::array<PlyField, 3>> find_triple(const PlyElement& element, const Names& names,
                                                   std::vector<std::string>& carried) {
    std::array<PlyField, 3> fields;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::optional<PlyField> field = find_scalar(element, names[i]);
        if (!field) return std::nullopt;
        fields[i] = *field;
    }
    carried.insert(carried.end(), names.begin(), names.end());
    return fields;
}

void find_colors(const PlyElement& element, PlyVertexFields& fields,
                 std::vector<std::string>& carried) {
    struct Family {
        Names rgb;
        const char* alpha;
    };
    static constexpr std::array<Family, 3> kFamilies{{
        {{"red", "green", "blue"}, "alpha"},
        {{"diffuse_red", "diffuse_green", "diffuse_blue"}, "diffuse_alpha"},
        {{"r", "g", "b"}, "a"},
    }};
    for (const Family& family : kFamilies) {
        fields.color = find_triple(element, family.rgb, carried);
        if (!fields.color) continue;
        fields.alpha = find_scalar(element, family.alpha);
        if (fields.alpha) carried.emplace_back(family.alpha);
        return;
    }
}

std::optional<std::size_t> find_property(const PlyElement& element, std::string_view name,
                                         bool is_list) {
    const auto found =
        std::find_if(element.properties.begin(), element.properties.end(),
                     [&](const PlyProperty& p) { return p.is_list == is_list && p.name == name; });
    if (found == element.properties.end()) return std::nullopt;
    return static_cast<std::size_t>(found - element.properties.begin());
}

std::optional<PlyTexcoords> find_texcoords(const PlyElement& vertex, const PlyElement& face) {
    PlyTexcoords texcoords;
    if (const auto list = find_property(face, "texcoord", true)) {
        texcoords.is_at_corners = true;
        texcoords.list = *list;
        texcoords.texture = find_property(face, "texnumber", false);
        return texcoords;
    }
    constexpr std::array<std::array<std::string_view, 2>, 4> kNames{
        {{"texture_u", "texture_v"}, {"u", "v"}, {"s", "t"}, {"tx", "ty"}}};
    for (const auto& [u_name, v_name] : kNames) {
        const auto u = find_property(vertex, u_name, false);
        const auto v = find_property(vertex, v_name, false);
        if (!u || !v) continue;
        texcoords.uv = {*u, *v};
        return texcoords;
    }
    return std::nullopt;
}

PlyField find_weight(const PlyElement& vertex, const std::string& name, const std::string& path,
                     std::vector<std::string>& carried) {
    if (const std::optional<PlyField> field = find_scalar(vertex, name)) {
        carried.push_back(name);
        return *field;
    }
    std::string names;
    for (const PlyProperty& p : vertex.properties) {
        if (!p.is_list) names += (names.empty() ? "" : ", ") + p.name;
    }
    throw InvalidArgument(path + ": its vertices have no number named '" + name +
                          "' that could be their weight (--weight-property); there are " + names);
}

[[noreturn]] void refuse_without_faces(const PlyHeader& header, const PlyElement& vertex,
                                       const std::string& path) {
    if (header.find("face") != nullptr || header.find("tristrips") != nullptr) {
        throw FormatError(path + ": the mesh has no faces: the header announces 0 of them");
    }
    const std::string count = ooc::format_count(vertex.count);
    if (find_scalar(vertex, "f_dc_0") && find_scalar(vertex, "scale_0") &&
        find_scalar(vertex, "rot_0")) {
        throw FormatError(path + ": a Gaussian splat (" + count +
                          " splats, no faces), not a triangle mesh; extract a surface first");
    }
    throw FormatError(
        path + ": a point cloud (" + count +
        " points, no face element), not a triangle mesh; reconstruct a surface first");
}

std::size_t index_of(const PlyHeader& header, const PlyElement* element) {
    return static_cast<std::size_t>(element - header.elements.data());
}

void note_ignored(const PlyElement& element, const std::vector<std::string>& carried,
                  SourceInfo& info) {
    for (const PlyProperty& p : element.properties) {
        if (std::find(carried.begin(), carried.end(), p.name) == carried.end()) {
            info.ignored.push_back(element.name + "." + p.name);
        }
    }
}

}  // namespace

PlyLayout plan_ply(const PlyHeader& header, const std::filesystem::path& file_path,
                   SourceInfo& info, const std::string& weight_property) {
    const std::string path = file_path.string();
    PlyLayout layout;
    const PlyElement* vertex = header.find("vertex");
    if (vertex == nullptr) throw FormatError(path + ": the PLY header has no vertex element");
    layout.vertex_element = index_of(header, vertex);

    const PlyElement* face = header.find("face");
    const PlyElement* strips = header.find("tristrips");
    if ((face == nullptr || face->count == 0) && strips != nullptr && strips->count > 0) {
        face = strips;
        layout.is_strips = true;
    }
    if (face == nullptr || face->count == 0) refuse_without_faces(header, *vertex, path);
    if (vertex->count == 0) {
        throw FormatError(path + ": the mesh has no vertices: the header announces 0 of them");
    }
    layout.face_element = index_of(header, face);
    const auto corners =
        std::find_if(face->properties.begin(), face->properties.end(), [](const PlyProperty& p) {
            return p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
        });
    if (corners == face->properties.end()) {
        throw FormatError(path + ": element " + face->name +
                          " has no list vertex_indices or vertex_index");
    }
    if (!is_integer(corners->type)) {
        throw FormatError(path + ": the vertex ids in " + face->name + "." + corners->name +
                          " are of a floating-point type; whole numbers are needed");
    }
    layout.corner_property = static_cast<std::size_t>(corners - face->properties.begin());

    std::vector<std::string> carried;
    const auto position = find_triple(*vertex, {"x", "y", "z"}, carried);
    if (!position) throw FormatError(path + ": the vertices have no properties x, y and z");
    layout.vertex.position = *position;
    layout.vertex.normal = find_triple(*vertex, {"nx", "ny", "nz"}, carried);
    find_colors(*vertex, layout.vertex, carried);
    if (!weight_property.empty()) {
        layout.vertex.weight = find_weight(*vertex, weight_property, path, carried);
    }

    std::vector<std::string> carried_of_faces{corners->name};
    if (!header.texture_files.empty() && !layout.is_strips) {
        layout.texcoords = find_texcoords(*vertex, *face);
        if (!layout.texcoords) info.ignored.emplace_back("textures, without coordinates");
    }
    if (layout.texcoords) {
        const PlyTexcoords& found = *layout.texcoords;
        if (found.is_at_corners) {
            carried_of_faces.push_back(face->properties[found.list].name);
            if (found.texture) {
                carried_of_faces.push_back(face->properties[*found.texture].name);
            }
        } else {
            for (const std::size_t i : found.uv) carried.push_back(vertex->properties[i].name);
        }
    }

    info.name = path;
    info.format = header.encoding == PlyEncoding::Ascii          ? "PLY, ASCII"
                  : header.encoding == PlyEncoding::LittleEndian ? "PLY, binary little endian"
                                                                 : "PLY, binary big endian";
    info.n_vertices = vertex->count;
    info.n_faces = face->count;
    info.is_indexed = true;
    // Anything that a float may not hold exactly.
    info.has_double_positions =
        std::any_of(position->begin(), position->end(), [](const PlyField& f) {
            return byte_size(f.type) > 4 || f.type == ScalarType::Int32 ||
                   f.type == ScalarType::UInt32;
        });
    info.has_normals = layout.vertex.normal.has_value();
    info.has_colors = layout.vertex.color.has_value();
    info.has_alpha = layout.vertex.alpha.has_value();
    info.has_weights = layout.vertex.weight.has_value();
    for (const PlyElement& element : header.elements) {
        if (&element == vertex) {
            note_ignored(element, carried, info);
        } else if (&element == face) {
            note_ignored(element, carried_of_faces, info);
        } else {
            info.ignored.push_back("element " + element.name);
        }
    }
    return layout;
}

}  // namespace hewer::streaming
