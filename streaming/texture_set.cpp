// SPDX-License-Identifier: MIT
#include "streaming/texture_set.h"

#include <memory>
#include <utility>

#include "hewer/error.h"
#include "streaming/image_rows.h"

namespace hewer::streaming {

std::optional<std::size_t> TextureSet::add(const std::string& name,
                                           const std::function<FileRange()>& find, bool is_strict) {
    std::unique_ptr<ImageRows> image;
    try {
        image = open_image(find(), context_.budget());
        textures_.emplace_back(context_, *image, tiles_);
    } catch (const ImageProblem& problem) {
        miss("texture " + name, problem.what, is_strict);
        return {};
    } catch (const OutOfMemoryBudget& error) {
        throw OutOfMemoryBudget("texture " + name + ": " + error.what());
    } catch (const IoError& error) {
        // What opens, but cannot be read, or not be kept, is no missing texture.
        if (image) throw;
        miss("texture " + name, error.what(), is_strict);
        return {};
    }
    infos_.push_back({name, image->format(), image->width(), image->height()});
    return textures_.size() - 1;
}

std::optional<std::size_t> TextureSet::add_file(const std::filesystem::path& path, bool is_strict) {
    return add(
        path.string(),
        [&] {
            auto file = std::make_shared<ooc::InputFile>(path);
            const std::uint64_t size = file->size();
            return FileRange{std::move(file), 0, size};
        },
        is_strict);
}

void TextureSet::miss(const std::string& what, const std::string& why, bool is_strict) {
    if (is_strict) throw FormatError(what + ": " + why + "; strict mode refuses that");
    context_.warn(what + ": " + why + "; its colour is left out");
    missing_.push_back(what + " (" + why + ")");
}

}  // namespace hewer::streaming
