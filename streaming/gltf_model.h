// SPDX-License-Identifier: MIT
/// What a glTF document says of geometry, with its types checked. Indices are not: they may lead
/// nowhere.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "streaming/array_source.h"

namespace hewer::streaming::gltf {

/// No such thing.
constexpr std::int64_t kNone = -1;

struct MeshoptView {
    std::int64_t buffer = kNone;
    std::uint64_t byte_offset = 0;
    std::uint64_t byte_length = 0;
    std::uint64_t byte_stride = 0;
    std::uint64_t count = 0;
    std::string mode;
    std::string filter;
};

struct BufferView {
    std::int64_t buffer = kNone;
    std::uint64_t byte_offset = 0;
    std::uint64_t byte_length = 0;
    std::uint64_t byte_stride = 0;  ///< 0: elements side by side
    std::optional<MeshoptView> meshopt;
};

struct SparsePart {
    std::uint64_t count = 0;
    std::int64_t index_view = kNone;
    std::uint64_t index_offset = 0;
    std::int64_t index_type = 0;
    std::int64_t value_view = kNone;
    std::uint64_t value_offset = 0;
};

struct Accessor {
    std::int64_t view = kNone;  ///< none: zeros
    std::uint64_t byte_offset = 0;
    std::uint64_t count = 0;
    std::int64_t component_type = 0;
    std::string type;  ///< "VEC3"
    bool is_normalized = false;
    std::vector<double> min;
    std::vector<double> max;
    std::optional<SparsePart> sparse;
};

struct DracoPart {
    std::int64_t view = kNone;
    std::map<std::string, std::int64_t> ids;  ///< by attribute
};

struct Primitive {
    std::map<std::string, std::int64_t> attributes;  ///< accessors
    std::int64_t indices = kNone;
    std::int64_t material = kNone;
    std::int64_t mode = 4;
    bool has_targets = false;
    std::optional<DracoPart> draco;
};

struct Node {
    std::vector<std::int64_t> children;
    std::int64_t mesh = kNone;
    bool has_skin = false;
    bool has_instances = false;
    Affine transform = kIdentity;
};

/// How a material uses a texture.
struct TextureUse {
    std::int64_t texture = kNone;
    std::int64_t texcoord = 0;  ///< n of TEXCOORD_n
    /// KHR_texture_transform: (u, v, 1) to places in the image.
    std::array<std::array<double, 3>, 2> to_image{{{1, 0, 0}, {0, 1, 0}}};
};

struct Material {
    std::array<double, 4> base_color{1, 1, 1, 1};
    std::optional<TextureUse> base_texture;
    bool has_other_textures = false;
};

struct Texture {
    std::int64_t sampler = kNone;
    std::int64_t image = kNone;
    std::string extension;  ///< that names another image: KHR_texture_basisu, ...
};

struct Sampler {
    std::int64_t wrap_s = 10497;  ///< REPEAT
    std::int64_t wrap_t = 10497;
};

struct Image {
    std::int64_t view = kNone;
    std::optional<std::string> uri;
};

struct Buffer {
    std::uint64_t byte_length = 0;
    std::optional<std::string> uri;
};

struct Model {
    std::vector<std::string> required;  ///< extensions
    std::vector<Buffer> buffers;
    std::vector<BufferView> views;
    std::vector<Accessor> accessors;
    std::vector<std::vector<Primitive>> meshes;
    std::vector<Node> nodes;
    std::vector<std::vector<std::int64_t>> scenes;  ///< root nodes
    std::int64_t scene = kNone;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Sampler> samplers;
    std::vector<Image> images;
    bool has_animations = false;
};

/// Throws FormatError: "name: accessors[3].count: ...". What has nothing to do with geometry is not
/// looked at.
Model parse_model(const nlohmann::json& document, const std::string& name);

}  // namespace hewer::streaming::gltf
