// SPDX-License-Identifier: MIT
#include "streaming/glb_document.h"

#include <tiny_gltf.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "hewer/error.h"
#include "hewer/version.h"

namespace hewer::streaming {

namespace {

std::vector<double> to_doubles(const std::array<float, 3>& v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
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
        component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT && type == TINYGLTF_TYPE_VEC4;
    model.accessors.push_back(accessor);
    return static_cast<int>(model.accessors.size()) - 1;
}

/// Rough and not metallic: a scan is stone, skin or clay rather than chrome, which is what glTF
/// assumes when nothing is said. Both sides, since scans have holes through which the inside shows.
tinygltf::Material scan_material(const GlbLayout& layout) {
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

tinygltf::Model model_of(const GlbLayout& layout) {
    tinygltf::Model model;
    model.asset.version = "2.0";
    model.asset.generator = "hewer " + std::string(version());

    tinygltf::BufferView vertices;
    vertices.buffer = 0;
    vertices.byteLength = layout.indices_offset();
    vertices.byteStride = layout.vertex_bytes();
    vertices.target = TINYGLTF_TARGET_ARRAY_BUFFER;
    tinygltf::BufferView indices;
    indices.buffer = 0;
    indices.byteOffset = layout.indices_offset();
    indices.byteLength = layout.binary_bytes() - layout.indices_offset();
    indices.target = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
    model.bufferViews = {vertices, indices};

    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = 0;
    std::uint64_t offset = 0;
    const auto add_attribute = [&](const char* name, int component, int type, std::uint64_t bytes) {
        primitive.attributes[name] =
            add_accessor(model, 0, offset, layout.n_vertices, component, type);
        offset += bytes;
    };
    add_attribute("POSITION", TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 12);
    model.accessors.back().minValues = to_doubles(layout.min);
    model.accessors.back().maxValues = to_doubles(layout.max);
    if (layout.has_normals) {
        add_attribute("NORMAL", TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 12);
    }
    if (layout.has_colors) {
        add_attribute("COLOR_0", TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4, 8);
    }
    primitive.indices =
        add_accessor(model, 1, 0, 3 * layout.n_triangles,
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
        node.translation = {layout.translation[0], layout.translation[1], layout.translation[2]};
    }
    model.nodes = {node};
    tinygltf::Scene scene;
    scene.nodes = {0};
    model.scenes = {scene};
    model.defaultScene = 0;
    return model;
}

}  // namespace

std::string glb_document(const GlbLayout& layout) {
    const tinygltf::Model model = model_of(layout);
    std::ostringstream text;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model, text, false, false)) {
        throw InternalError("the glTF document cannot be written");
    }
    // The one thing that tinygltf cannot say: a buffer whose bytes it does not hold.
    nlohmann::json document = nlohmann::json::parse(text.str());
    document["buffers"] = {{{"byteLength", layout.binary_bytes()}}};
    std::string result = document.dump();
    if (result.size() > kGlbDocumentBytes) {
        throw InternalError("the glTF document is longer than the place kept for it");
    }
    return result;
}

}  // namespace hewer::streaming
