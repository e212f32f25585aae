// SPDX-License-Identifier: MIT
/// Textures as pyramids of tiles on a spool: any texel of any level in bounded memory.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ooc/array.h"
#include "ooc/context.h"
#include "ooc/spool.h"
#include "streaming/image_rows.h"

namespace hewer::streaming {

/// Red, green, blue, 0..255, as in the image (sRGB).
using Texel = std::array<std::uint8_t, 3>;

/// Side x side texels, row by row. What hangs over the edge of its level is not to be read.
struct TextureTile {
    static constexpr unsigned kBits = 5;
    static constexpr std::uint32_t kSide = 1U << kBits;
    std::array<Texel, std::size_t{kSide} * kSide> texels;
};

/// Level 0 is the image; each next one has half the width and height, rounded up, down to one
/// texel: means of two by two texels, fewer at the edges, so that texel (x, y) of level l stands
/// for the texels x * 2^l .. and y * 2^l .. of the image, whatever its size.
class Texture {
  public:
    struct Level {
        std::uint32_t width;
        std::uint32_t height;
        std::vector<std::uint64_t> rows;  ///< number of the first tile of each row of tiles
    };

    /// Reads the image through, appending tiles to `tiles`. Memory: a row of tiles for each level,
    /// some 200 bytes a column of the image, while it runs. Throws: as ImageRows,
    /// OutOfMemoryBudget, OutOfDiskBudget, Cancelled.
    Texture(ooc::Context& context, ImageRows& image, ooc::Spool<TextureTile>& tiles);

    [[nodiscard]] const std::vector<Level>& levels() const { return levels_; }
    [[nodiscard]] std::uint32_t width() const { return levels_.front().width; }
    [[nodiscard]] std::uint32_t height() const { return levels_.front().height; }

  private:
    std::vector<Level> levels_;
};

/// Single texels. One thread. Keeps the tiles that were asked for last, direct-mapped by a hash of
/// their numbers. Memory: kLineBytes for each of `n_lines`, reserved.
class TexelCache {
  public:
    static constexpr std::uint64_t kLineBytes = sizeof(TextureTile) + sizeof(std::uint64_t);
    static constexpr std::uint64_t kLeastLines = 64;

    /// @param n_lines  a power of two.
    TexelCache(ooc::MemoryBudget& budget, const ooc::Spool<TextureTile>& tiles,
               std::uint64_t n_lines);

    /// Precondition: x and y are inside the level.
    const Texel& at(const Texture::Level& level, std::uint32_t x, std::uint32_t y) {
        constexpr std::uint32_t kMask = TextureTile::kSide - 1;
        const std::uint64_t tile = level.rows[y >> TextureTile::kBits] + (x >> TextureTile::kBits);
        const std::size_t i = (y & kMask) << TextureTile::kBits | (x & kMask);
        if (tile != last_) find(tile);
        return found_->texels[i];
    }

  private:
    void find(std::uint64_t tile);

    const ooc::Spool<TextureTile>* tiles_;
    unsigned shift_;
    ooc::Array<std::uint64_t> held_;  // tile + 1, by line
    ooc::Array<TextureTile> lines_;
    std::uint64_t last_;
    const TextureTile* found_ = nullptr;
};

}  // namespace hewer::streaming
