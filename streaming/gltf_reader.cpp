// SPDX-License-Identifier: MIT
#include "streaming/gltf_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "streaming/array_source.h"
#include "streaming/draco_arrays.h"
#include "streaming/gltf_arrays.h"
#include "streaming/gltf_document.h"
#include "streaming/gltf_textures.h"
#include "streaming/joined_source.h"
#include "streaming/position_precision.h"

namespace hewer::streaming {

namespace {

// Each is a source of its own.
constexpr std::size_t kMostPlaced = 1'000'000;
constexpr unsigned kMostNodeDepth = 1000;

bool is_known(std::string_view extension) {
    constexpr std::array<std::string_view, 4> kGeometry{
        "KHR_mesh_quantization", "EXT_meshopt_compression", "KHR_meshopt_compression",
        "KHR_draco_mesh_compression"};
    // Of materials and textures, which change no geometry.
    constexpr std::array<std::string_view, 5> kLooks{
        "KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "MSFT_texture_"};
    return std::find(kGeometry.begin(), kGeometry.end(), extension) != kGeometry.end() ||
           std::any_of(kLooks.begin(), kLooks.end(),
                       [&](std::string_view prefix) { return extension.starts_with(prefix); });
}

Affine product(const Affine& a, const Affine& b) {
    Affine c{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 4; ++k) {
            c[i][k] =
                a[i][0] * b[0][k] + a[i][1] * b[1][k] + a[i][2] * b[2][k] + (k == 3 ? a[i][3] : 0);
        }
    }
    return c;
}

bool is_finite(const Affine& m) {
    return std::all_of(m.begin(), m.end(), [](const auto& row) {
        return std::all_of(row.begin(), row.end(), [](double x) { return std::isfinite(x); });
    });
}

/// The box that the document claims for positions, as it is placed; empty if it claims none.
Bounds claimed_bounds(const gltf::Accessor& positions, const Affine& m) {
    Bounds bounds;
    if (positions.min.size() != 3 || positions.max.size() != 3) return bounds;
    for (unsigned corner = 0; corner < 8; ++corner) {
        Vec3 p{};
        for (std::size_t i = 0; i < 3; ++i) {
            p[i] = (corner >> i & 1U) != 0 ? positions.max[i] : positions.min[i];
        }
        bounds.extend(transformed(m, p));
    }
    return bounds;
}

enum class Look { AtData, AtDocument };

class Scene {
  public:
    Scene(GltfDocument document, const OpenOptions& options, const Hooks& hooks, Look look)
        : document_(std::move(document)),
          model_(document_.model),
          options_(options),
          look_(look),
          arrays_(document_, options_),
          textures_(document_, arrays_, options_, hooks) {
        require_known_extensions();
        if (model_.has_animations) ignore("animations");
        if (document_.trailing_bytes > 0) {
            ignore("the " + std::to_string(document_.trailing_bytes) + " bytes behind the GLB");
        }
    }

    std::unique_ptr<MeshSource> open() {
        place_all();
        require_weights();
        drop_the_one_colour();
        if (placed_.size() == 1) placed_.front().name = document_.name;
        // What concerns all of them is told by one.
        placed_.front().n_bytes = document_.n_bytes;
        placed_.front().held_temp_bytes = arrays_.held_temp_bytes();
        placed_.front().textures = textures_.infos();
        for (const std::string& what : textures_.missing()) ignore(what);
        placed_.front().ignored = ignored_;
        std::vector<std::unique_ptr<MeshSource>> parts;
        parts.reserve(placed_.size());
        for (ArrayMesh& mesh : placed_) {
            parts.push_back(open_arrays(std::move(mesh), options_.strict));
        }
        if (parts.size() == 1) return std::move(parts.front());
        return join_sources(std::move(parts), document_.name, format());
    }

    bool describe(InputReport& report) {
        place_all();
        drop_the_one_colour();
        report.format = format();
        report.bytes = document_.n_bytes;
        for (const ArrayMesh& mesh : placed_) {
            report.vertices += mesh.positions.count;
            report.faces += mesh.n_faces();
            report.has_normals = report.has_normals || mesh.normals.count > 0;
            report.has_colors = report.has_colors || mesh.has_any_color();
        }
        report.triangles = report.faces;
        report.ignored = ignored_;
        if (is_all_claimed_) report.bounds = claimed_;
        return is_encoded_;
    }

  private:
    [[nodiscard]] std::string format() const { return document_.is_binary ? "GLB" : "glTF"; }

    /// A colour that all of the scene has is its paint, and nothing for each vertex to carry.
    void drop_the_one_colour() {
        const std::array<double, 4> color = placed_.front().color_factor;
        const bool is_one = std::all_of(placed_.begin(), placed_.end(), [&](const ArrayMesh& mesh) {
            return mesh.colors.count == 0 && mesh.color_factor == color;
        });
        if (!is_one) return;
        for (ArrayMesh& mesh : placed_) mesh.color_factor = {1, 1, 1, 1};
    }

    void ignore(const std::string& what) {
        if (std::find(ignored_.begin(), ignored_.end(), what) == ignored_.end()) {
            ignored_.push_back(what);
        }
    }

    void require_known_extensions() const {
        std::string unknown;
        for (const std::string& extension : model_.required) {
            if (is_known(extension)) continue;
            unknown += (unknown.empty() ? "" : ", ") + extension;
        }
        if (unknown.empty()) return;
        throw FormatError(document_.name + ": cannot be read without " + unknown +
                          ", which hewer does not know");
    }

    void require_weights() const {
        const std::string& name = options_.weight_property;
        if (name.empty() || std::any_of(placed_.begin(), placed_.end(), [](const ArrayMesh& mesh) {
                return mesh.weights.count > 0;
            })) {
            return;
        }
        std::string names;
        for (const std::string& other : ignored_) {
            if (other.starts_with('_')) names += (names.empty() ? "" : ", ") + other;
        }
        throw InvalidArgument(document_.name + ": no mesh has a number '" + name +
                              "' for each vertex that could be its weight (--weight-property); " +
                              (names.empty() ? "there are no attributes with names of their own"
                                             : "there are " + names));
    }

    void place_all() {
        place_roots();
        if (!placed_.empty()) return;
        throw FormatError(document_.name + ": the mesh has no faces: no triangles in " +
                          std::to_string(model_.meshes.size()) + " meshes and " +
                          std::to_string(model_.nodes.size()) + " nodes");
    }

    void place_roots() {
        std::vector<std::int64_t> roots;
        const std::size_t n_scenes = model_.scenes.size();
        const auto asked = static_cast<std::size_t>(std::max<std::int64_t>(model_.scene, 0));
        if (n_scenes > 0) {
            if (asked >= n_scenes) {
                throw FormatError(document_.name + ": there is no scene " + std::to_string(asked));
            }
            roots = model_.scenes[asked];
        } else {
            std::vector<bool> is_child(model_.nodes.size());
            for (const gltf::Node& node : model_.nodes) {
                for (const std::int64_t child : node.children) {
                    if (child >= 0 && static_cast<std::size_t>(child) < is_child.size()) {
                        is_child[static_cast<std::size_t>(child)] = true;
                    }
                }
            }
            for (std::size_t i = 0; i < is_child.size(); ++i) {
                if (!is_child[i]) roots.push_back(static_cast<std::int64_t>(i));
            }
        }
        if (model_.nodes.empty()) {
            for (std::size_t i = 0; i < model_.meshes.size(); ++i) {
                place_mesh(static_cast<std::int64_t>(i), kIdentity);
            }
        }
        for (const std::int64_t root : roots) visit(root);
    }

    struct Visit {
        std::int64_t node;
        Affine transform;
        unsigned depth;
    };

    void visit(std::int64_t root) {
        std::vector<Visit> waiting{{root, kIdentity, 0}};
        while (!waiting.empty()) {
            const Visit at = waiting.back();
            waiting.pop_back();
            if (at.node < 0 || static_cast<std::size_t>(at.node) >= model_.nodes.size()) {
                throw FormatError(document_.name + ": there is no node " + std::to_string(at.node));
            }
            // Cycles are as deep as one likes.
            if (at.depth > kMostNodeDepth || waiting.size() > kMostPlaced) {
                throw FormatError(document_.name + ": node " + std::to_string(at.node) +
                                  " is its own ancestor, or the scene is too deep");
            }
            const gltf::Node& node = model_.nodes[static_cast<std::size_t>(at.node)];
            const Affine transform = product(at.transform, node.transform);
            if (!is_finite(transform)) {
                throw FormatError(document_.name + ": the transform of node " +
                                  std::to_string(at.node) + " is not finite");
            }
            if (node.has_instances) {
                throw FormatError(document_.name + ": node " + std::to_string(at.node) +
                                  " uses EXT_mesh_gpu_instancing, which hewer does not know");
            }
            if (node.has_skin) ignore("skins");
            if (node.mesh >= 0) place_mesh(node.mesh, transform);
            for (auto it = node.children.rbegin(); it != node.children.rend(); ++it) {
                waiting.push_back({*it, transform, at.depth + 1});
            }
        }
    }

    void place_mesh(std::int64_t index, const Affine& transform) {
        if (index < 0 || static_cast<std::size_t>(index) >= model_.meshes.size()) {
            throw FormatError(document_.name + ": there is no mesh " + std::to_string(index));
        }
        const auto& primitives = model_.meshes[static_cast<std::size_t>(index)];
        for (std::size_t p = 0; p < primitives.size(); ++p) {
            const ArrayMesh* const mesh = find_primitive(index, p);
            if (mesh == nullptr) continue;
            if (placed_.size() == kMostPlaced) {
                throw FormatError(document_.name + ": more than " + std::to_string(kMostPlaced) +
                                  " meshes are placed in the scene");
            }
            placed_.push_back(*mesh);
            placed_.back().transform = transform;
            const auto it = primitives[p].attributes.find("POSITION");
            const Bounds bounds =
                claimed_bounds(model_.accessors[static_cast<std::size_t>(it->second)], transform);
            placed_.back().has_double_positions =
                transform != kIdentity && float_is_too_coarse(bounds);
            claimed_.extend(bounds);
            is_all_claimed_ = is_all_claimed_ && !bounds.is_empty();
        }
    }

    /// The arrays of a primitive, made once; null if it has no triangles.
    const ArrayMesh* find_primitive(std::int64_t mesh, std::size_t p) {
        const auto key = std::make_pair(mesh, p);
        const auto it = primitives_.find(key);
        if (it != primitives_.end()) return it->second.positions.count > 0 ? &it->second : nullptr;
        ArrayMesh& made = primitives_[key];
        made = make_primitive(mesh, p);
        return made.positions.count > 0 ? &made : nullptr;
    }

    ArrayMesh make_primitive(std::int64_t mesh, std::size_t p) {
        const gltf::Primitive& primitive = model_.meshes[static_cast<std::size_t>(mesh)][p];
        ArrayMesh arrays;
        switch (primitive.mode) {
            case 4:
                arrays.mode = ArrayMesh::Mode::Triangles;
                break;
            case 5:
                arrays.mode = ArrayMesh::Mode::Strip;
                break;
            case 6:
                arrays.mode = ArrayMesh::Mode::Fan;
                break;
            default:
                ignore("points and lines");
                return {};
        }
        const std::string what =
            document_.name + ": mesh " + std::to_string(mesh) + ", primitive " + std::to_string(p);
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end()) {
            ignore("primitives without positions");
            return {};
        }
        if (position->second < 0 ||
            static_cast<std::size_t>(position->second) >= model_.accessors.size()) {
            throw FormatError(what + ": there is no accessor " + std::to_string(position->second));
        }
        const gltf::Material* const material = find_material(primitive);
        const gltf::TextureUse* const texture =
            material != nullptr && material->base_texture ? &*material->base_texture : nullptr;
        const std::string texcoord =
            texture != nullptr ? "TEXCOORD_" + std::to_string(texture->texcoord) : std::string();
        name_ignored(primitive, texcoord);
        if (look_ == Look::AtDocument) {
            claim(primitive, arrays, what);
        } else if (primitive.draco) {
            decode(*primitive.draco, texcoord, what, arrays);
        } else {
            fill(primitive, texcoord, arrays, what);
        }
        arrays.name = what;
        arrays.format = format();
        arrays.has_linear_colors = true;
        if (material == nullptr) return arrays;
        arrays.color_factor = material->base_color;
        if (material->has_other_textures) ignore("textures other than those of base colours");
        if (texture == nullptr || arrays.positions.count == 0) return arrays;
        const StridedArray& coordinates = arrays.texcoords;
        if (coordinates.count == arrays.positions.count && coordinates.n_components == 2) {
            textures_.paint(*texture, arrays);
            arrays.texcoords = {};
        } else {
            ignore("textures of meshes without " + texcoord);
        }
        return arrays;
    }

    const gltf::Material* find_material(const gltf::Primitive& primitive) const {
        const auto i = static_cast<std::size_t>(primitive.material);
        return primitive.material >= 0 && i < model_.materials.size() ? &model_.materials[i]
                                                                      : nullptr;
    }

    /// @param texcoord  the attribute that goes into colours; empty: none.
    void name_ignored(const gltf::Primitive& primitive, const std::string& texcoord) {
        for (const auto& [name, accessor] : primitive.attributes) {
            if (name != "POSITION" && name != "NORMAL" && name != "COLOR_0" && name != texcoord &&
                name != options_.weight_property) {
                ignore(name);
            }
        }
        if (primitive.has_targets) ignore("morph targets");
    }

    /// What the document says of the arrays, without a look for their bytes.
    void claim(const gltf::Primitive& primitive, ArrayMesh& arrays, const std::string& what) {
        const auto claim_one = [&](std::int64_t index, StridedArray& array) {
            if (index < 0 || static_cast<std::size_t>(index) >= model_.accessors.size()) {
                throw FormatError(what + ": there is no accessor " + std::to_string(index));
            }
            const gltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
            array.count = accessor.count;
            const bool is_packed =
                accessor.view >= 0 &&
                static_cast<std::size_t>(accessor.view) < model_.views.size() &&
                model_.views[static_cast<std::size_t>(accessor.view)].meshopt.has_value();
            is_encoded_ = is_encoded_ || accessor.sparse || is_packed;
        };
        const auto claim_named = [&](const char* name, StridedArray& array) {
            const auto it = primitive.attributes.find(name);
            if (it != primitive.attributes.end()) claim_one(it->second, array);
        };
        claim_named("POSITION", arrays.positions);
        claim_named("NORMAL", arrays.normals);
        claim_named("COLOR_0", arrays.colors);
        if (primitive.indices >= 0) claim_one(primitive.indices, arrays.indices);
        is_encoded_ = is_encoded_ || primitive.draco;
    }

    void fill(const gltf::Primitive& primitive, const std::string& texcoord, ArrayMesh& arrays,
              const std::string& what) {
        const auto find = [&](const std::string& name) {
            const auto it = primitive.attributes.find(name);
            return it != primitive.attributes.end() ? arrays_.array(it->second) : StridedArray{};
        };
        arrays.positions = find("POSITION");
        arrays.normals = find("NORMAL");
        arrays.colors = find("COLOR_0");
        arrays.texcoords = find(texcoord);
        arrays.weights = find(options_.weight_property);
        if (primitive.indices >= 0) arrays.indices = arrays_.array(primitive.indices);
        const std::uint64_t n = arrays.positions.count;
        const bool is_alike = arrays.positions.n_components == 3 &&
                              (arrays.normals.count == 0 ||
                               (arrays.normals.count == n && arrays.normals.n_components == 3)) &&
                              (arrays.colors.count == 0 ||
                               (arrays.colors.count == n && arrays.colors.n_components >= 3)) &&
                              (arrays.weights.count == 0 ||
                               (arrays.weights.count == n && arrays.weights.n_components == 1));
        const bool are_indices = arrays.indices.count == 0 || (arrays.indices.n_components == 1 &&
                                                               is_integer(arrays.indices.type));
        if (!is_alike || !are_indices) {
            throw FormatError(what + ": its accessors do not fit together");
        }
    }

    void decode(const gltf::DracoPart& draco, const std::string& texcoord, const std::string& what,
                ArrayMesh& arrays) {
        const auto id_of = [&](const std::string& name) -> std::optional<std::uint32_t> {
            const auto it = draco.ids.find(name);
            if (it == draco.ids.end()) return {};
            return static_cast<std::uint32_t>(it->second);
        };
        const FileRange range = buffer_view(document_, draco.view);
        if (!range.file) throw FormatError(what + ": the buffer of its Draco data is not there");
        // Whatever the primitive says: Draco's faces are triangles.
        arrays = decode_draco(*range.file, range.offset, range.n_bytes,
                              {id_of("POSITION"), id_of("NORMAL"), id_of("COLOR_0"),
                               id_of(texcoord), id_of(options_.weight_property)},
                              arrays_.rest());
        arrays_.add_held_temp_bytes(std::exchange(arrays.held_temp_bytes, 0));
    }

    GltfDocument document_;
    const gltf::Model& model_;
    const OpenOptions& options_;
    Look look_;
    GltfArrays arrays_;
    GltfTextures textures_;
    std::vector<std::string> ignored_;
    std::map<std::pair<std::int64_t, std::size_t>, ArrayMesh> primitives_;
    std::vector<ArrayMesh> placed_;
    Bounds claimed_;
    bool is_all_claimed_ = true;
    bool is_encoded_ = false;
};

}  // namespace

std::unique_ptr<MeshSource> open_gltf(std::unique_ptr<ooc::InputFile> file, bool is_binary,
                                      const OpenOptions& options, const Hooks& hooks) {
    return Scene(read_gltf(std::move(file), is_binary, options), options, hooks, Look::AtData)
        .open();
}

bool glance_gltf(std::unique_ptr<ooc::InputFile> file, bool is_binary, const OpenOptions& options,
                 InputReport& report) {
    return Scene(read_gltf(std::move(file), is_binary, options), options, {}, Look::AtDocument)
        .describe(report);
}

}  // namespace hewer::streaming
