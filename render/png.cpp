// SPDX-License-Identifier: MIT
#include "render/png.h"

#include <png.h>

#include <string>

#include "hewer/error.h"
#include "ooc/array.h"

namespace hewer::raster {

void write_png(ooc::OutputFile& file, std::span<const std::uint8_t> pixels, unsigned width,
               unsigned height, ooc::MemoryBudget& budget) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = width;
    image.height = height;
    image.format = PNG_FORMAT_RGB;
    // Encoded in memory: libpng reports errors of its own stream writers by longjmp.
    png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
    ooc::Array<std::uint8_t> encoded(budget, "encoded picture", bytes);
    if (png_image_write_to_memory(&image, encoded.data(), &bytes, 0, pixels.data(), 0, nullptr) ==
        0) {
        throw InternalError(file.path().string() + ": cannot encode the picture: " + image.message);
    }
    file.write(encoded.data(), bytes);
}

}  // namespace hewer::raster
