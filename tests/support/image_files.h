// SPDX-License-Identifier: MIT
/// PNG and JPEG files as strings, by the libraries that wrote the formats.
#pragma once

// jpeglib.h wants size_t and FILE before it.
#include <cstddef>
#include <cstdio>
//
#include <jpeglib.h>
#include <png.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

namespace hewer::test {

using Rgb8 = std::array<std::uint8_t, 3>;

/// An image by a function of its columns and rows, top row first.
struct Picture {
    Picture(std::uint32_t w, std::uint32_t h,
            const std::function<Rgb8(std::uint32_t, std::uint32_t)>& color)
        : width(w), height(h) {
        for (std::uint32_t y = 0; y < h; ++y) {
            for (std::uint32_t x = 0; x < w; ++x) {
                for (const std::uint8_t c : color(x, y)) rgb.push_back(c);
            }
        }
    }
    std::uint32_t width;
    std::uint32_t height;
    std::vector<std::uint8_t> rgb;
};

struct PngKind {
    int color_type = PNG_COLOR_TYPE_RGB;
    int bit_depth = 8;
    bool is_interlaced = false;
};

/// Of the other kinds than RGB: grey takes the red of the picture, a palette has its index in red
/// and the colours (40 i, 0, 255 - 40 i), alpha is 0.
inline std::string png_of(const Picture& picture, const PngKind& kind = {}) {
    std::string file;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(
        png, &file,
        [](png_structp p, png_bytep data, std::size_t n) {
            static_cast<std::string*>(png_get_io_ptr(p))
                ->append(reinterpret_cast<const char*>(data), n);
        },
        nullptr);
    png_set_IHDR(png, info, picture.width, picture.height, kind.bit_depth, kind.color_type,
                 kind.is_interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    std::array<png_color, 7> palette{};
    for (std::size_t i = 0; i < palette.size(); ++i) {
        palette[i] = {static_cast<png_byte>(40 * i), 0, static_cast<png_byte>(255 - 40 * i)};
    }
    const bool has_palette = kind.color_type == PNG_COLOR_TYPE_PALETTE;
    if (has_palette) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
    png_write_info(png, info);
    const bool is_grey = has_palette || (kind.color_type & PNG_COLOR_MASK_COLOR) == 0;
    const bool has_alpha = (kind.color_type & PNG_COLOR_MASK_ALPHA) != 0;
    const auto n_bytes = static_cast<std::size_t>(kind.bit_depth == 16 ? 2 : 1);
    std::vector<std::vector<png_byte>> rows;
    std::vector<png_bytep> pointers;
    for (std::size_t y = 0; y < picture.height; ++y) {
        auto& row = rows.emplace_back();
        for (std::size_t x = 0; x < picture.width; ++x) {
            const std::uint8_t* const c = &picture.rgb[3 * (y * picture.width + x)];
            for (std::size_t k = 0; k < (is_grey ? 1U : 3U); ++k)
                row.insert(row.end(), n_bytes, c[k]);
            if (has_alpha) row.insert(row.end(), n_bytes, 0);
        }
    }
    for (auto& row : rows) pointers.push_back(row.data());
    png_write_image(png, pointers.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return file;
}

struct JpegKind {
    bool is_progressive = false;
    bool is_grey = false;  ///< of the picture's red
    bool is_cmyk = false;  ///< inverted, as Adobe writes it: cyan, magenta, yellow are the picture
};

inline std::string jpeg_of(const Picture& picture, const JpegKind& kind = {}) {
    jpeg_compress_struct c{};
    jpeg_error_mgr errors{};
    c.err = jpeg_std_error(&errors);
    jpeg_create_compress(&c);
    unsigned char* buffer = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&c, &buffer, &size);
    c.image_width = picture.width;
    c.image_height = picture.height;
    c.input_components = kind.is_grey ? 1 : kind.is_cmyk ? 4 : 3;
    c.in_color_space = kind.is_grey ? JCS_GRAYSCALE : kind.is_cmyk ? JCS_CMYK : JCS_RGB;
    jpeg_set_defaults(&c);
    jpeg_set_quality(&c, 100, TRUE);
    if (kind.is_progressive) jpeg_simple_progression(&c);
    jpeg_start_compress(&c, TRUE);
    for (std::size_t y = 0; y < picture.height; ++y) {
        std::vector<JSAMPLE> row;
        for (std::size_t x = 0; x < picture.width; ++x) {
            const std::uint8_t* const rgb = &picture.rgb[3 * (y * picture.width + x)];
            row.insert(row.end(), rgb, rgb + (kind.is_grey ? 1 : 3));
            if (kind.is_cmyk) row.push_back(255);
        }
        JSAMPROW pointer = row.data();
        jpeg_write_scanlines(&c, &pointer, 1);
    }
    jpeg_finish_compress(&c);
    std::string file(reinterpret_cast<const char*>(buffer), size);
    jpeg_destroy_compress(&c);
    std::free(buffer);
    return file;
}

}  // namespace hewer::test
