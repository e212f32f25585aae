// SPDX-License-Identifier: MIT
/// The textures of a model.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hewer/mesh_source.h"
#include "ooc/context.h"
#include "streaming/texture.h"

namespace hewer::streaming {

/// Decodes images, one after the other, to pyramids on one spool. Memory: of the image that is
/// being decoded (see open_image() and Texture), and what the spool keeps, which is all that is
/// free. Temporary disk, where that is not enough: 4 bytes a pixel.
class TextureSet {
  public:
    explicit TextureSet(ooc::Context& context) : context_(context), tiles_(context, "textures") {}

    /// Number of the texture. Nothing, after a warning, if the image is missing, damaged or of a
    /// kind that is not read; in strict mode that is thrown as FormatError.
    /// @param name  for messages and SourceInfo::textures. @param find  may throw IoError.
    std::optional<std::size_t> add(const std::string& name, const std::function<FileRange()>& find,
                                   bool is_strict);

    /// The same of an image in a file of its own.
    std::optional<std::size_t> add_file(const std::filesystem::path& path, bool is_strict);

    [[nodiscard]] const Texture& operator[](std::size_t i) const { return textures_[i]; }
    [[nodiscard]] const ooc::Spool<TextureTile>& tiles() const { return tiles_; }
    /// Of those that were decoded, in the order of their numbers.
    [[nodiscard]] const std::vector<TextureInfo>& infos() const { return infos_; }
    /// "texture NAME (why)", for SourceInfo::ignored.
    [[nodiscard]] const std::vector<std::string>& missing() const { return missing_; }
    /// The same for what is no image, with the warning.
    void miss(const std::string& what, const std::string& why, bool is_strict);

  private:
    ooc::Context& context_;
    ooc::Spool<TextureTile> tiles_;
    std::vector<Texture> textures_;
    std::vector<TextureInfo> infos_;
    std::vector<std::string> missing_;
};

}  // namespace hewer::streaming
