// SPDX-License-Identifier: MIT
#include "streaming/image_rows.h"

#include <array>
#include <string_view>

namespace hewer::streaming {

namespace {

/// How files begin that textures are kept in, too.
struct Magic {
    std::size_t offset;
    std::string_view bytes;
    const char* name;
};
constexpr std::array<Magic, 9> kOthers{{{1, "KTX 20", "KTX2"},
                                        {1, "KTX 11", "KTX"},
                                        {8, "WEBP", "WebP"},
                                        {0, "DDS ", "DDS"},
                                        {0, "BM", "BMP"},
                                        {0, "GIF8", "GIF"},
                                        {0, "II*", "TIFF"},
                                        {0, "MM", "TIFF"},
                                        {0, "v/1\x01", "OpenEXR"}}};

}  // namespace

void ImageRows::set_size(std::uint64_t width, std::uint64_t height) {
    if (width == 0 || height == 0) throw ImageProblem{"an image without pixels"};
    if (width > kMostSide || height > kMostSide || width * height > kMostPixels) {
        throw ImageProblem{std::to_string(width) + " x " + std::to_string(height) +
                           " pixels are beyond what hewer reads"};
    }
    width_ = static_cast<std::uint32_t>(width);
    height_ = static_cast<std::uint32_t>(height);
}

std::unique_ptr<ImageRows> open_image(const FileRange& range, ooc::MemoryBudget& budget) {
    std::array<char, 16> start{};
    const std::size_t n = range.file->read_at(range.offset, start.data(),
                                              std::min<std::uint64_t>(start.size(), range.n_bytes));
    const std::string_view begin(start.data(), n);
    if (begin.starts_with("\x89PNG\r\n\x1a\n")) return open_png(range, budget);
    if (begin.starts_with("\xff\xd8\xff")) return open_jpeg(range, budget);
    for (const Magic& magic : kOthers) {
        if (begin.size() >= magic.offset && begin.substr(magic.offset).starts_with(magic.bytes)) {
            throw ImageProblem{std::string(magic.name) +
                               " is not read; textures are PNG or JPEG here"};
        }
    }
    throw ImageProblem{"neither PNG nor JPEG"};
}

}  // namespace hewer::streaming
