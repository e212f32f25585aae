// SPDX-License-Identifier: MIT
#include "streaming/gltf_text.h"

#include <tiny_gltf.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "hewer/error.h"
#include "hewer/version.h"

namespace hewer::streaming {

namespace {

std::vector<double> to_vector(const Vec3& v) {
    return {v[0], v[1], v[2]};
}

int add_accessor(tinygltf::Model& model, int view, std::uint64_t offset, std::uint64_t count,
                 int component, int type) {
    tinygltf::Accessor accessor;
    accessor.bufferView = view;
    accessor.byteOffset = offset;
    accessor.count = count;
    accessor.componentType = component;
    accessor.type = type;
    accessor.normalized =
        component == TINYGLTF_COMPONENT_TYPE_BYTE ||
        (component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT && type == TINYGLTF_TYPE_VEC4);
    model.accessors.push_back(accessor);
    return static_cast<int>(model.accessors.size()) - 1;
}

/// Rough and not metallic: a scan is stone, skin or clay rather than chrome, which is what glTF
/// assumes when nothing is said. Both sides, since scans have holes through which the inside shows.
tinygltf::Material scan_material(const GltfLayout& layout) {
    tinygltf::Material material;
    // Colours are multiplied with the base colour; without colours white would outshine shading.
    const double base = layout.has_colors ? 1.0 : 0.8;
    material.pbrMetallicRoughness.baseColorFactor = {base, base, base, 1.0};
    material.pbrMetallicRoughness.metallicFactor = 0.0;
    material.pbrMetallicRoughness.roughnessFactor = 0.8;
    material.emissiveFactor = {0.0, 0.0, 0.0};
    material.alphaMode = layout.has_transparency ? "BLEND" : "OPAQUE";
    material.doubleSided = true;
    return material;
}

tinygltf::Model model_of(const GltfLayout& layout) {
    tinygltf::Model model;
    model.asset.version = "2.0";
    model.asset.generator = "hewer " + std::string(version());

    const bool is_draco = layout.compression == Compression::Draco;
    tinygltf::BufferView vertices;
    vertices.buffer = 0;
    vertices.byteLength = is_draco ? layout.packed_vertices.bytes : layout.indices_offset();
    vertices.byteStride = is_draco ? 0 : layout.vertex_bytes();
    vertices.target = is_draco ? 0 : TINYGLTF_TARGET_ARRAY_BUFFER;
    model.bufferViews = {vertices};
    if (!is_draco) {
        tinygltf::BufferView indices;
        indices.buffer = 0;
        indices.byteOffset = layout.indices_offset();
        indices.byteLength = layout.plain_bytes() - layout.indices_offset();
        indices.target = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
        model.bufferViews.push_back(indices);
    }

    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = 0;
    const int view = is_draco ? -1 : 0;
    const auto add_attribute = [&](const char* name, int component, int type,
                                   std::uint64_t offset) {
        primitive.attributes[name] =
            add_accessor(model, view, is_draco ? 0 : offset, layout.n_vertices, component, type);
    };
    add_attribute("POSITION",
                  layout.is_quantized() ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT
                                        : TINYGLTF_COMPONENT_TYPE_FLOAT,
                  TINYGLTF_TYPE_VEC3, 0);
    model.accessors.back().minValues = to_vector(layout.min);
    model.accessors.back().maxValues = to_vector(layout.max);
    if (layout.has_normals) {
        add_attribute(
            "NORMAL",
            layout.is_quantized() ? TINYGLTF_COMPONENT_TYPE_BYTE : TINYGLTF_COMPONENT_TYPE_FLOAT,
            TINYGLTF_TYPE_VEC3, layout.normals_offset());
    }
    if (layout.has_colors) {
        add_attribute("COLOR_0", TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4,
                      layout.colors_offset());
    }
    primitive.indices =
        add_accessor(model, is_draco ? -1 : 1, 0, 3 * layout.n_triangles,
                     layout.has_short_indices() ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT
                                                : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                     TINYGLTF_TYPE_SCALAR);

    tinygltf::Mesh mesh;
    mesh.primitives = {primitive};
    model.meshes = {mesh};
    model.materials = {scan_material(layout)};
    tinygltf::Node node;
    node.mesh = 0;
    if (layout.translation != Vec3{0, 0, 0}) {
        node.translation = to_vector(layout.translation);
    }
    if (layout.is_quantized()) node.scale = {layout.step, layout.step, layout.step};
    model.nodes = {node};
    tinygltf::Scene scene;
    scene.nodes = {0};
    model.scenes = {scene};
    model.defaultScene = 0;
    return model;
}

using Json = nlohmann::json;

void require_extension(Json& document, const char* name) {
    document["extensionsUsed"].push_back(name);
    document["extensionsRequired"].push_back(name);
}

/// The views are of a buffer that is not there, for readers that know the extension not, and say
/// where their packed bytes are.
void add_meshopt(Json& document, const GltfLayout& layout) {
    constexpr const char* kName = "EXT_meshopt_compression";
    require_extension(document, kName);
    document["buffers"].push_back(
        {{"byteLength", layout.plain_bytes()}, {"extensions", {{kName, {{"fallback", true}}}}}});
    const auto pack = [&](std::size_t view, const GltfPiece& piece, std::uint64_t stride,
                          std::uint64_t count, const char* mode) {
        Json& v = document["bufferViews"][view];
        v["buffer"] = 1;
        v["extensions"][kName] = {{"buffer", 0},
                                  {"byteOffset", piece.offset},
                                  {"byteLength", piece.bytes},
                                  {"byteStride", stride},
                                  {"count", count},
                                  {"mode", mode}};
    };
    pack(0, layout.packed_vertices, layout.vertex_bytes(), layout.n_vertices, "ATTRIBUTES");
    pack(1, layout.packed_indices, layout.index_bytes(), 3 * layout.n_triangles, "TRIANGLES");
}

void add_draco(Json& document, const GltfLayout& layout) {
    constexpr const char* kName = "KHR_draco_mesh_compression";
    require_extension(document, kName);
    Json attributes = {{"POSITION", layout.position_id}};
    if (layout.has_normals) attributes["NORMAL"] = layout.normal_id;
    if (layout.has_colors) attributes["COLOR_0"] = layout.color_id;
    document["meshes"][0]["primitives"][0]["extensions"][kName] = {{"bufferView", 0},
                                                                   {"attributes", attributes}};
    for (Json& accessor : document["accessors"]) {
        accessor.erase("bufferView");
        accessor.erase("byteOffset");
    }
}

}  // namespace

std::string gltf_text(const GltfLayout& layout) {
    const tinygltf::Model model = model_of(layout);
    std::ostringstream text;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model, text, false, false)) {
        throw InternalError("the glTF document cannot be written");
    }
    // What tinygltf cannot say: a buffer whose bytes it does not hold, and compression.
    Json document = Json::parse(text.str());
    document["buffers"] = {{{"byteLength", layout.binary_bytes()}}};
    if (!layout.uri.empty()) document["buffers"][0]["uri"] = layout.uri;
    if (layout.is_quantized()) require_extension(document, "KHR_mesh_quantization");
    if (layout.compression == Compression::Meshopt) add_meshopt(document, layout);
    if (layout.compression == Compression::Draco) add_draco(document, layout);
    std::string result = document.dump();
    const bool is_bounded = layout.uri.empty() && layout.compression == Compression::None;
    if (is_bounded && result.size() > kGltfTextBytes) {
        throw InternalError("the glTF document is longer than the place kept for it");
    }
    return result;
}

}  // namespace hewer::streaming
