// SPDX-License-Identifier: MIT
/// Base colour textures of glTF as colours of the vertices.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hewer/mesh_source.h"
#include "ooc/context.h"
#include "streaming/array_source.h"
#include "streaming/gltf_arrays.h"
#include "streaming/gltf_document.h"
#include "streaming/texture_set.h"
#include "streaming/vertex_paint.h"

namespace hewer::streaming {

/// Each image is decoded once, when a primitive first needs it. Images are sRGB, factors and
/// colours of vertices are linear light: these are multiplied with the mean of the texture as
/// light.
///
/// Temporary disk: 8 bytes a vertex, held by the mesh; 15 a triangle and the textures, until this
/// is gone. Memory: as TextureSet and paint_vertices().
class GltfTextures {
  public:
    /// All must outlive it.
    GltfTextures(GltfDocument& document, GltfArrays& arrays, const OpenOptions& options,
                 const Hooks& hooks);

    /// Puts colours at the vertices of `mesh`, times those that it has and its factor, which
    /// becomes white; nothing where the texture cannot be used. Precondition: as open_arrays(), and
    /// texture coordinates for all vertices.
    void paint(const gltf::TextureUse& use, ArrayMesh& mesh);

    [[nodiscard]] std::vector<TextureInfo> infos() const;
    [[nodiscard]] std::vector<std::string> missing() const;

  private:
    /// Made with the first texture.
    struct Tools {
        Tools(const ooc::ResourceLimits& limits, Hooks hooks)
            : context(limits, std::move(hooks)), textures(context) {}
        ooc::Context context;
        TextureSet textures;
    };
    Tools& tools();
    std::optional<Paint> make_paint(const gltf::TextureUse& use);
    std::optional<std::size_t> find_texture(std::int64_t image, const std::string& extension);
    FileRange open_data(std::int64_t image, const std::string& extension);
    StridedArray make_colors(const ArrayMesh& mesh, const Paint& paint);

    GltfDocument& document_;
    GltfArrays& arrays_;
    const OpenOptions& options_;
    Hooks hooks_;
    std::unique_ptr<Tools> tools_;
    std::map<std::int64_t, std::optional<std::size_t>> numbers_;  // of textures, by image
};

}  // namespace hewer::streaming
