// SPDX-License-Identifier: MIT
/// Images of textures, PNG and JPEG, as streams of rows.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "ooc/memory_budget.h"
#include "streaming/file_range.h"

namespace hewer::streaming {

/// Thrown where an image cannot be used: damaged, too large, of a kind that is not read. Names no
/// file: the texture that it was for knows that.
struct ImageProblem {
    std::string what;
};

/// Rows from top to bottom, whatever the file has: palettes, grey and 16 bits become 8 bits of red,
/// green and blue; alpha is left out. Profiles and gamma chunks are not looked at: numbers are
/// sRGB.
class ImageRows {
  public:
    /// What is refused beyond, whatever a header says.
    static constexpr std::uint64_t kMostSide = 65536;
    static constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 30;

    virtual ~ImageRows() = default;
    [[nodiscard]] virtual const char* format() const = 0;
    [[nodiscard]] std::uint32_t width() const { return width_; }
    [[nodiscard]] std::uint32_t height() const { return height_; }
    /// The next row, 3 * width() bytes: height() times at most. Throws ImageProblem, IoError.
    virtual void read_row(std::uint8_t* rgb) = 0;

  protected:
    /// Throws ImageProblem beyond the limits above.
    void set_size(std::uint64_t width, std::uint64_t height);

  private:
    std::uint32_t width_ = 0;
    std::uint32_t height_ = 0;
};

/// The image in a file or in a part of one, by its content. Only the header is read.
///
/// Memory, reserved: of images that are stored row by row a few rows. Interlaced PNG is decoded as
/// a whole, 3 bytes a pixel; progressive JPEG waits as a whole, 2 bytes a coefficient (3 to 6 a
/// pixel). Throws: ImageProblem, IoError, OutOfMemoryBudget.
std::unique_ptr<ImageRows> open_image(const FileRange& range, ooc::MemoryBudget& budget);

/// Of open_image(): what is behind the two kinds.
std::unique_ptr<ImageRows> open_png(const FileRange& range, ooc::MemoryBudget& budget);
std::unique_ptr<ImageRows> open_jpeg(const FileRange& range, ooc::MemoryBudget& budget);

}  // namespace hewer::streaming
