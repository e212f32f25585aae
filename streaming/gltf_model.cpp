// SPDX-License-Identifier: MIT
#include "streaming/gltf_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "hewer/error.h"

namespace hewer::streaming::gltf {

namespace {

using Json = nlohmann::json;

// The same but for what can be in the data: see GltfArrays.
constexpr std::array<const char*, 2> kMeshopt{"KHR_meshopt_compression", "EXT_meshopt_compression"};
constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
constexpr const char* kTransform = "KHR_texture_transform";
constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";

/// A value of the document and the way to it, for messages.
class Item {
  public:
    Item(const Json& json, std::string path) : json_(&json), path_(std::move(path)) {}

    [[noreturn]] void fail(const std::string& what) const {
        throw FormatError(path_ + ": " + what);
    }
    [[nodiscard]] std::optional<Item> find(const char* key) const {
        if (!json_->is_object()) fail("an object was expected");
        const auto it = json_->find(key);
        if (it == json_->end()) return {};
        return Item(*it, path_ + (path_.ends_with(' ') ? "" : ".") + key);
    }
    [[nodiscard]] std::optional<Item> extension(const char* name) const {
        const std::optional<Item> all = find("extensions");
        return all ? all->find(name) : all;
    }
    [[nodiscard]] bool has(const char* key) const { return find(key).has_value(); }

    [[nodiscard]] std::uint64_t size(const char* key, std::uint64_t otherwise = 0) const {
        const std::optional<Item> item = find(key);
        return item ? item->as_size() : otherwise;
    }
    /// Of something in a list of the document.
    [[nodiscard]] std::int64_t index(const char* key) const {
        const std::optional<Item> item = find(key);
        return item ? item->as_index() : kNone;
    }
    [[nodiscard]] double number(const char* key, double otherwise) const {
        const std::optional<Item> item = find(key);
        if (!item) return otherwise;
        if (!item->json_->is_number()) item->fail("a number was expected");
        return item->json_->get<double>();
    }
    [[nodiscard]] std::string text(const char* key) const {
        const std::optional<Item> item = find(key);
        if (!item) return {};
        if (!item->json_->is_string()) item->fail("a text was expected");
        return item->json_->get<std::string>();
    }
    [[nodiscard]] bool flag(const char* key) const {
        const std::optional<Item> item = find(key);
        if (!item) return false;
        if (!item->json_->is_boolean()) item->fail("true or false was expected");
        return item->json_->get<bool>();
    }
    [[nodiscard]] std::vector<double> numbers(const char* key) const {
        std::vector<double> result;
        for_each(key, [&](const Item& item) {
            if (!item.json_->is_number()) item.fail("a number was expected");
            result.push_back(item.json_->get<double>());
        });
        return result;
    }
    [[nodiscard]] std::vector<std::int64_t> indices(const char* key) const {
        std::vector<std::int64_t> result;
        for_each(key, [&](const Item& item) { result.push_back(item.as_index()); });
        return result;
    }
    [[nodiscard]] std::map<std::string, std::int64_t> named_indices(const char* key) const {
        std::map<std::string, std::int64_t> result;
        const std::optional<Item> all = find(key);
        if (!all) return result;
        if (!all->json_->is_object()) all->fail("an object was expected");
        for (const auto& [name, value] : all->json_->items()) {
            result[name] = Item(value, all->path_ + "." + name).as_index();
        }
        return result;
    }
    /// Calls visit(item) for all of a list, if it is there.
    template <typename Visit>
    void for_each(const char* key, const Visit& visit) const {
        const std::optional<Item> list = find(key);
        if (!list) return;
        if (!list->json_->is_array()) list->fail("a list was expected");
        std::size_t i = 0;
        for (const Json& element : *list->json_) {
            visit(Item(element, list->path_ + "[" + std::to_string(i++) + "]"));
        }
    }
    /// A list of the document, each element made by make(item).
    template <typename T, typename Make>
    [[nodiscard]] std::vector<T> list(const char* key, const Make& make) const {
        std::vector<T> result;
        for_each(key, [&](const Item& item) { result.push_back(make(item)); });
        return result;
    }
    [[nodiscard]] std::string as_text() const {
        if (!json_->is_string()) fail("a text was expected");
        return json_->get<std::string>();
    }

  private:
    [[nodiscard]] std::uint64_t as_size() const {
        // Some writers put 12.0 for 12.
        if (json_->is_number_float()) {
            const double value = json_->get<double>();
            if (value >= 0 && value < 0x1p53 &&
                value == static_cast<double>(static_cast<std::uint64_t>(value))) {
                return static_cast<std::uint64_t>(value);
            }
        }
        if (!json_->is_number_unsigned()) fail("a count or an offset was expected");
        return json_->get<std::uint64_t>();
    }
    [[nodiscard]] std::int64_t as_index() const {
        const std::uint64_t value = as_size();
        constexpr std::uint64_t kMost = std::uint64_t{1} << 32;
        if (value >= kMost) fail("an index was expected");
        return static_cast<std::int64_t>(value);
    }

    const Json* json_;
    std::string path_;
};

BufferView parse_view(const Item& item) {
    BufferView view{item.index("buffer"),
                    item.size("byteOffset"),
                    item.size("byteLength"),
                    item.size("byteStride"),
                    {}};
    for (const char* const name : kMeshopt) {
        const auto packed = item.extension(name);
        if (!packed || view.meshopt) continue;
        view.meshopt = {packed->index("buffer"),    packed->size("byteOffset"),
                        packed->size("byteLength"), packed->size("byteStride"),
                        packed->size("count"),      packed->text("mode"),
                        packed->text("filter")};
    }
    return view;
}

Accessor parse_accessor(const Item& item) {
    Accessor accessor;
    accessor.view = item.index("bufferView");
    accessor.byte_offset = item.size("byteOffset");
    accessor.count = item.size("count");
    accessor.component_type = item.index("componentType");
    accessor.type = item.text("type");
    accessor.is_normalized = item.flag("normalized");
    accessor.min = item.numbers("min");
    accessor.max = item.numbers("max");
    if (const auto sparse = item.find("sparse")) {
        const auto indices = sparse->find("indices");
        const auto values = sparse->find("values");
        if (!indices || !values) sparse->fail("indices and values were expected");
        accessor.sparse = {sparse->size("count"),       indices->index("bufferView"),
                           indices->size("byteOffset"), indices->index("componentType"),
                           values->index("bufferView"), values->size("byteOffset")};
    }
    return accessor;
}

Primitive parse_primitive(const Item& item) {
    Primitive primitive;
    primitive.attributes = item.named_indices("attributes");
    primitive.indices = item.index("indices");
    primitive.material = item.index("material");
    if (item.has("mode")) primitive.mode = item.index("mode");
    primitive.has_targets = item.has("targets");
    if (const auto draco = item.extension(kDraco)) {
        primitive.draco = {draco->index("bufferView"), draco->named_indices("attributes")};
    }
    return primitive;
}

/// Translation, rotation (a quaternion) and scale, in that order from the left.
Affine compose(const std::vector<double>& t, const std::vector<double>& r,
               const std::vector<double>& s) {
    Affine m = kIdentity;
    if (r.size() == 4) {
        const double x = r[0];
        const double y = r[1];
        const double z = r[2];
        const double w = r[3];
        m = {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0},
              {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0},
              {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0}}};
    }
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (s.size() == 3) m[i][k] *= s[k];
        }
        if (t.size() == 3) m[i][3] = t[i];
    }
    return m;
}

Node parse_node(const Item& item) {
    Node node;
    node.children = item.indices("children");
    node.mesh = item.index("mesh");
    node.has_skin = item.has("skin");
    node.has_instances = item.extension(kInstancing).has_value();
    const std::vector<double> matrix = item.numbers("matrix");
    if (matrix.size() == 16) {  // by columns
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 4; ++k) node.transform[i][k] = matrix[4 * k + i];
        }
    } else {
        node.transform =
            compose(item.numbers("translation"), item.numbers("rotation"), item.numbers("scale"));
    }
    return node;
}

TextureUse parse_texture_use(const Item& item) {
    TextureUse use;
    use.texture = item.index("index");
    if (item.has("texCoord")) use.texcoord = item.index("texCoord");
    const std::optional<Item> transform = item.extension(kTransform);
    if (!transform) return use;
    if (transform->has("texCoord")) use.texcoord = transform->index("texCoord");
    std::vector<double> scale = transform->numbers("scale");
    std::vector<double> offset = transform->numbers("offset");
    if (scale.size() != 2) scale = {1, 1};
    if (offset.size() != 2) offset = {0, 0};
    const double angle = transform->number("rotation", 0);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    use.to_image = {
        {{scale[0] * c, scale[1] * s, offset[0]}, {-scale[0] * s, scale[1] * c, offset[1]}}};
    return use;
}

/// Factor and texture of the base colour, under the names that they have in `item`.
void parse_base_color(const Item& item, const char* factor, const char* texture,
                      Material& material) {
    const std::vector<double> color = item.numbers(factor);
    if (color.size() == 4) std::copy(color.begin(), color.end(), material.base_color.begin());
    if (const auto use = item.find(texture)) material.base_texture = parse_texture_use(*use);
}

Material parse_material(const Item& item) {
    Material material;
    material.has_other_textures =
        item.has("normalTexture") || item.has("occlusionTexture") || item.has("emissiveTexture");
    // Older files have the same colour twice, for viewers of either kind.
    if (const auto older = item.extension(kSpecularGlossiness)) {
        parse_base_color(*older, "diffuseFactor", "diffuseTexture", material);
        material.has_other_textures |= older->has("specularGlossinessTexture");
    }
    if (const auto pbr = item.find("pbrMetallicRoughness")) {
        parse_base_color(*pbr, "baseColorFactor", "baseColorTexture", material);
        material.has_other_textures |= pbr->has("metallicRoughnessTexture");
    }
    return material;
}

Texture parse_texture(const Item& item) {
    Texture texture{item.index("sampler"), item.index("source"), {}};
    for (const char* name :
         {"KHR_texture_basisu", "EXT_texture_webp", "MSFT_texture_dds", "EXT_texture_avif"}) {
        if (item.extension(name)) texture.extension = name;
    }
    return texture;
}

Sampler parse_sampler(const Item& item) {
    Sampler sampler;
    if (item.has("wrapS")) sampler.wrap_s = item.index("wrapS");
    if (item.has("wrapT")) sampler.wrap_t = item.index("wrapT");
    return sampler;
}

Image parse_image(const Item& item) {
    Image image{item.index("bufferView"), {}};
    if (item.has("uri")) image.uri = item.text("uri");
    return image;
}

Buffer parse_buffer(const Item& item) {
    Buffer buffer{item.size("byteLength"), {}};
    if (item.has("uri")) buffer.uri = item.text("uri");
    return buffer;
}

}  // namespace

Model parse_model(const Json& document, const std::string& name) {
    const Item root(document, name + ": ");
    if (const auto asset = root.find("asset")) {
        const std::string version = asset->text("version");
        if (!version.starts_with("2.")) {
            throw FormatError(name + ": glTF of version " + (version.empty() ? "?" : version) +
                              "; hewer reads version 2");
        }
    }
    Model model;
    model.required = root.list<std::string>("extensionsRequired",
                                            [](const Item& item) { return item.as_text(); });
    model.buffers = root.list<Buffer>("buffers", parse_buffer);
    model.views = root.list<BufferView>("bufferViews", parse_view);
    model.accessors = root.list<Accessor>("accessors", parse_accessor);
    model.meshes = root.list<std::vector<Primitive>>("meshes", [](const Item& item) {
        return item.list<Primitive>("primitives", parse_primitive);
    });
    model.nodes = root.list<Node>("nodes", parse_node);
    model.scenes = root.list<std::vector<std::int64_t>>(
        "scenes", [](const Item& item) { return item.indices("nodes"); });
    model.scene = root.index("scene");
    model.materials = root.list<Material>("materials", parse_material);
    model.textures = root.list<Texture>("textures", parse_texture);
    model.samplers = root.list<Sampler>("samplers", parse_sampler);
    model.images = root.list<Image>("images", parse_image);
    model.has_animations = root.has("animations");
    return model;
}

}  // namespace hewer::streaming::gltf
