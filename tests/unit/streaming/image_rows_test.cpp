// SPDX-License-Identifier: MIT
#include "streaming/image_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "hewer/error.h"
#include "ooc/context.h"
#include "streaming/texture.h"
#include "tests/support/image_files.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

using streaming::ImageProblem;
using test::Picture;
using test::PngKind;

constexpr std::uint64_t kLimit = std::uint64_t{64} << 20;

Picture ramp(std::uint32_t width, std::uint32_t height) {
    return {width, height, [](std::uint32_t x, std::uint32_t y) {
                return test::Rgb8{static_cast<std::uint8_t>(5 * x),
                                  static_cast<std::uint8_t>(3 * y),
                                  static_cast<std::uint8_t>(x + y)};
            }};
}

class Images : public testing::Test {
  protected:
    streaming::FileRange range(const std::string& bytes) {
        // Bytes around it belong to others, as in a GLB.
        const auto file =
            std::make_shared<ooc::InputFile>(dir_.write("image", "before" + bytes + "behind"));
        return {file, 6, bytes.size()};
    }
    std::vector<std::uint8_t> read(const std::string& bytes) {
        ooc::MemoryBudget budget(kLimit);
        const auto image = streaming::open_image(range(bytes), budget);
        std::vector<std::uint8_t> rgb(std::size_t{3} * image->width() * image->height());
        for (std::size_t y = 0; y < image->height(); ++y) {
            image->read_row(rgb.data() + y * 3 * image->width());
        }
        return rgb;
    }
    std::string problem(const std::string& bytes) {
        try {
            read(bytes);
        } catch (const ImageProblem& problem) {
            return problem.what;
        } catch (const OutOfMemoryBudget& error) {
            return error.what();
        }
        return {};
    }
    test::TempDir dir_;
};

void expect_near(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b, int most) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], most) << i;
}

TEST_F(Images, PngOfAllKindsBecomesBytesOfRedGreenBlue) {
    const Picture picture = ramp(37, 21);
    std::vector<std::uint8_t> grey;
    for (std::size_t i = 0; i < picture.rgb.size(); i += 3)
        grey.insert(grey.end(), 3, picture.rgb[i]);
    for (const bool is_interlaced : {false, true}) {
        for (const int depth : {8, 16}) {
            const auto kind = [&](int type) { return PngKind{type, depth, is_interlaced}; };
            EXPECT_EQ(read(png_of(picture, kind(PNG_COLOR_TYPE_RGB))), picture.rgb);
            EXPECT_EQ(read(png_of(picture, kind(PNG_COLOR_TYPE_RGB_ALPHA))), picture.rgb);
            EXPECT_EQ(read(png_of(picture, kind(PNG_COLOR_TYPE_GRAY))), grey);
            EXPECT_EQ(read(png_of(picture, kind(PNG_COLOR_TYPE_GRAY_ALPHA))), grey);
        }
        const Picture indices(9, 5, [](std::uint32_t x, std::uint32_t y) {
            return test::Rgb8{static_cast<std::uint8_t>((x + y) % 7), 0, 0};
        });
        const Picture colors(9, 5, [](std::uint32_t x, std::uint32_t y) {
            const std::uint32_t i = (x + y) % 7;
            return test::Rgb8{static_cast<std::uint8_t>(40 * i), 0,
                              static_cast<std::uint8_t>(255 - 40 * i)};
        });
        EXPECT_EQ(read(png_of(indices, {PNG_COLOR_TYPE_PALETTE, 8, is_interlaced})), colors.rgb);
    }
}

TEST_F(Images, JpegOfAllKindsBecomesBytesOfRedGreenBlue) {
    const Picture picture(40, 24, [](std::uint32_t x, std::uint32_t y) {
        return test::Rgb8{static_cast<std::uint8_t>(4 * x + 2 * y),
                          static_cast<std::uint8_t>(200 - 3 * y), 90};
    });
    std::vector<std::uint8_t> grey;
    for (std::size_t i = 0; i < picture.rgb.size(); i += 3)
        grey.insert(grey.end(), 3, picture.rgb[i]);
    for (const bool is_progressive : {false, true}) {
        expect_near(read(jpeg_of(picture, {is_progressive, false, false})), picture.rgb, 6);
        expect_near(read(jpeg_of(picture, {is_progressive, true, false})), grey, 3);
        expect_near(read(jpeg_of(picture, {is_progressive, false, true})), picture.rgb, 3);
    }
}

TEST_F(Images, ThatAreCutShortAreRefusedWhereverTheyEnd) {
    const Picture picture = ramp(64, 48);
    for (const std::string& whole :
         {png_of(picture), png_of(picture, {PNG_COLOR_TYPE_RGB, 8, true}), jpeg_of(picture),
          jpeg_of(picture, {true, false, false})}) {
        for (std::size_t n = 0; n < whole.size() - 40; n += 41) {
            EXPECT_FALSE(problem(whole.substr(0, n)).empty()) << n << " of " << whole.size();
        }
    }
}

TEST_F(Images, WithAnythingInTheirBytesAreReadOrRefused) {
    const Picture picture = ramp(40, 30);
    std::mt19937 random(1);
    for (const std::string& whole :
         {png_of(picture), jpeg_of(picture), jpeg_of(picture, {true, false, false})}) {
        for (int round = 0; round < 200; ++round) {
            std::string bytes = whole;
            for (int i = 0; i < 4; ++i)
                bytes[random() % bytes.size()] = static_cast<char>(random());
            (void)problem(bytes);
        }
    }
}

TEST_F(Images, OfImpossibleSizesAreRefusedBeforeTheyTakeMemory) {
    const std::string png = png_of(ramp(8, 8));
    // The checksum of the header no longer fits, but the size is what libpng looks at first.
    std::string huge = png;
    huge.replace(16, 8, std::string("\x7f\xff\xff\xff\x00\x00\x00\x08", 8));
    EXPECT_FALSE(problem(huge).empty());
    std::string jpeg = jpeg_of(ramp(8, 8), {true, false, false});
    const std::size_t frame = jpeg.find("\xff\xc2");
    jpeg.replace(frame + 5, 4, "\xff\xdc\xff\xdc");
    EXPECT_NE(problem(jpeg).find("65500 x 65500"), std::string::npos) << problem(jpeg);
    jpeg.replace(frame + 5, 4, std::string("\x40\x00\x40\x00", 4));
    EXPECT_NE(problem(jpeg).find("raise --memory"), std::string::npos) << problem(jpeg);
}

TEST_F(Images, OfOtherFormatsAreRefusedByName) {
    EXPECT_NE(problem(std::string("RIFF\x10\0\0\0WEBPVP8 ", 16)).find("WebP"), std::string::npos);
    EXPECT_NE(problem("\xabKTX 20\xbb\r\n").find("KTX2"), std::string::npos);
    EXPECT_NE(problem("anything").find("neither PNG nor JPEG"), std::string::npos);
    EXPECT_FALSE(problem("").empty());
}

TEST_F(Images, PyramidsHaveTheMeansOfTheirTexels) {
    for (const auto& [width, height] : {std::pair{1U, 1U}, {65U, 33U}, {7U, 130U}, {128U, 64U}}) {
        const Picture picture = ramp(width, height);
        ooc::Context context({.memory_bytes = kLimit});
        ooc::Spool<streaming::TextureTile> tiles(context, "tiles");
        const auto image = streaming::open_image(range(png_of(picture)), context.budget());
        const streaming::Texture texture(context, *image, tiles);
        streaming::TexelCache cache(context.budget(), tiles, streaming::TexelCache::kLeastLines);
        const auto& levels = texture.levels();
        EXPECT_EQ(levels.back().width, 1U);
        EXPECT_EQ(levels.back().height, 1U);
        for (std::size_t l = 0; l < levels.size(); ++l) {
            const std::uint32_t step = 1U << l;
            for (std::uint32_t y = 0; y < levels[l].height; ++y) {
                for (std::uint32_t x = 0; x < levels[l].width; ++x) {
                    if ((x + 1) * step > width || (y + 1) * step > height) continue;  // at the edge
                    double sum = 0;
                    for (std::uint32_t j = 0; j < step; ++j) {
                        for (std::uint32_t i = 0; i < step; ++i) {
                            sum += picture.rgb[3 * ((y * step + j) * width + x * step + i)];
                        }
                    }
                    ASSERT_NEAR(cache.at(levels[l], x, y)[0], sum / (step * step),
                                0.5 + 0.3 * static_cast<double>(l));
                }
            }
        }
    }
}

}  // namespace
}  // namespace hewer
