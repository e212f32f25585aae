// SPDX-License-Identifier: MIT
#include "streaming/gltf_textures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hewer/error.h"
#include "ooc/memory_budget.h"
#include "streaming/mesh_import.h"
#include "streaming/temporary_input.h"

namespace hewer::streaming {

namespace {

constexpr double kFullScale = 65535;
constexpr Rgba16 kWhite{65535, 65535, 65535, 65535};

/// Light for a number of sRGB, both 0..1 (IEC 61966-2-1), and back.
double to_light(double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double from_light(double l) {
    return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
}

std::uint16_t product(float texture, std::uint16_t base) {
    const auto c = static_cast<double>(texture);
    // Nearly always: no factor, no colours of vertices.
    const double both =
        base == kWhite[0] ? c : from_light(to_light(c) * to_light(base / kFullScale));
    return static_cast<std::uint16_t>(std::lround(both * kFullScale));
}

Wrap wrap_of(std::int64_t mode) {
    switch (mode) {
        case 33071:
            return Wrap::Clamp;
        case 33648:
            return Wrap::Mirror;
        default:
            return Wrap::Repeat;
    }
}

template <typename T>
const T* find(const std::vector<T>& list, std::int64_t index) {
    return index >= 0 && static_cast<std::size_t>(index) < list.size()
               ? &list[static_cast<std::size_t>(index)]
               : nullptr;
}

/// Positions and triangles alone.
std::unique_ptr<MeshSource> open_shape(const ArrayMesh& mesh) {
    ArrayMesh shape = mesh;
    shape.normals = {};
    shape.colors = {};
    shape.weights = {};
    shape.color_factor = {1, 1, 1, 1};
    return open_arrays(std::move(shape), false);
}

}  // namespace

GltfTextures::GltfTextures(GltfDocument& document, GltfArrays& arrays, const OpenOptions& options,
                           const Hooks& hooks)
    : document_(document),
      arrays_(arrays),
      options_(options),
      hooks_{.on_progress = {}, .on_warning = hooks.on_warning, .stop = hooks.stop} {}

GltfTextures::Tools& GltfTextures::tools() {
    if (!tools_) {
        tools_ = std::make_unique<Tools>(
            ooc::ResourceLimits{.memory_bytes = options_.memory_bytes,
                                .n_threads = options_.n_threads,
                                .temp_dir = options_.temp_dir,
                                .max_temp_bytes = arrays_.rest().max_temp_bytes},
            hooks_);
    }
    return *tools_;
}

std::vector<TextureInfo> GltfTextures::infos() const {
    return tools_ ? tools_->textures.infos() : std::vector<TextureInfo>();
}

std::vector<std::string> GltfTextures::missing() const {
    return tools_ ? tools_->textures.missing() : std::vector<std::string>();
}

FileRange GltfTextures::open_data(std::int64_t image, const std::string& extension) {
    if (image == gltf::kNone && !extension.empty()) {
        throw ImageProblem{extension + " is not read; textures are PNG or JPEG here"};
    }
    try {
        return open_image_data(document_, image, arrays_.rest());
    } catch (const FormatError& error) {
        throw ImageProblem{error.what()};
    }
}

std::optional<std::size_t> GltfTextures::find_texture(std::int64_t image,
                                                      const std::string& extension) {
    const auto [it, is_new] = numbers_.try_emplace(image);
    if (!is_new) return it->second;
    const gltf::Image* const found = find(document_.model.images, image);
    const bool has_address = found != nullptr && found->uri && !found->uri->starts_with("data:");
    const std::string name = has_address ? *found->uri + " of " + document_.name
                                         : document_.name + ", image " + std::to_string(image);
    it->second = tools().textures.add(
        name, [&] { return open_data(image, extension); }, options_.strict);
    return it->second;
}

std::optional<Paint> GltfTextures::make_paint(const gltf::TextureUse& use) {
    const gltf::Texture* const texture = find(document_.model.textures, use.texture);
    Paint paint;
    paint.texture = texture != nullptr ? find_texture(texture->image, texture->extension)
                                       : find_texture(gltf::kNone, {});
    if (!paint.texture) return {};
    paint.to_image = use.to_image;
    if (const auto* const sampler = find(document_.model.samplers, texture->sampler)) {
        paint.wrap = {wrap_of(sampler->wrap_s), wrap_of(sampler->wrap_t)};
    }
    return paint;
}

void GltfTextures::paint(const gltf::TextureUse& use, ArrayMesh& mesh) {
    const std::optional<Paint> paint = make_paint(use);
    if (!paint) return;
    mesh.colors = make_colors(mesh, *paint);
    mesh.color_factor = {1, 1, 1, 1};
    mesh.has_linear_colors = false;
}

StridedArray GltfTextures::make_colors(const ArrayMesh& mesh, const Paint& paint) {
    ooc::Context& context = tools().context;
    const std::unique_ptr<MeshSource> shape = open_shape(mesh);
    const ooc::Spool<PackedTriangle> triangles = copy_triangles(context, *shape);
    PaintedMesh painted;
    painted.n_vertices = painted.n_texcoords = mesh.positions.count;
    painted.load_positions = [&](std::uint64_t first, std::uint64_t n, Vec3* out) {
        VertexBatch batch;
        shape->read_vertices(first, n, batch);
        std::copy(batch.positions.begin(), batch.positions.end(), out);
    };
    painted.load_texcoords = [&](std::uint64_t first, std::uint64_t n, std::array<float, 2>* out) {
        load_texcoords(mesh, first, n, out);
    };
    painted.n_triangles = triangles.size();
    painted.read_triangles = [&](std::uint64_t first, std::span<PaintedTriangle> out) {
        std::vector<PackedTriangle> packed(out.size());
        triangles.read(first, packed);
        for (std::size_t i = 0; i < out.size(); ++i) {
            const Triangle t = packed[i].unpack();
            out[i] = {t, t, 0};
        }
    };
    painted.paints = {paint};

    const std::unique_ptr<MeshSource> colored = open_arrays(mesh, false);
    const SourceInfo& info = colored->info();
    TemporaryInput out(arrays_.rest());
    VertexBatch base;
    std::uint64_t first = 0;
    paint_vertices(context, painted, tools().textures, [&](std::span<const VertexColor> colors) {
        if (info.has_colors) {
            colored->read_vertices(first, colors.size(), base);
        } else {
            base.colors.assign(colors.size(), kWhite);
        }
        for (std::size_t i = 0; i < colors.size(); ++i) {
            if (!colors[i]) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                base.colors[i][k] = product((*colors[i])[k], base.colors[i][k]);
            }
        }
        out.append(base.colors.data(), base.colors.size() * sizeof(Rgba16));
        first += colors.size();
    });
    arrays_.add_held_temp_bytes(out.size());
    const unsigned n_components = info.has_alpha ? 4 : 3;
    return {out.finish(document_.name), 0,   sizeof(Rgba16), mesh.positions.count, n_components,
            ScalarType::UInt16,         true};
}

}  // namespace hewer::streaming
