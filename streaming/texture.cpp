// SPDX-License-Identifier: MIT
#include "streaming/texture.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace hewer::streaming {

namespace {

constexpr std::uint32_t kSide = TextureTile::kSide;

std::uint32_t tiles_across(std::uint32_t width) {
    return (width + kSide - 1) / kSide;
}

/// The level that is being written: its present row of tiles, and the row that waits for the next
/// one to be halved with it.
struct OpenLevel {
    OpenLevel(ooc::MemoryBudget& budget, std::uint32_t width)
        : tiles(budget, "rows of a texture", tiles_across(width)),
          even_row(budget, "rows of a texture", width) {}
    ooc::Array<TextureTile> tiles;
    ooc::Array<Texel> even_row;
    std::uint32_t n_rows = 0;
};

/// Means of 2 x 2 texels of two rows; of fewer where the width is odd.
void halve(std::span<const Texel> upper, std::span<const Texel> lower, std::span<Texel> out) {
    for (std::size_t x = 0; x < out.size(); ++x) {
        const std::size_t a = 2 * x;
        const std::size_t b = std::min(a + 1, upper.size() - 1);
        for (std::size_t k = 0; k < 3; ++k) {
            const int sum = upper[a][k] + upper[b][k] + lower[a][k] + lower[b][k];
            out[x][k] = static_cast<std::uint8_t>((sum + 2) / 4);
        }
    }
}

class PyramidBuilder {
  public:
    PyramidBuilder(ooc::MemoryBudget& budget, std::uint32_t width, std::uint32_t height,
                   std::vector<Texture::Level>& levels, ooc::Spool<TextureTile>& tiles)
        : levels_(levels), tiles_(tiles) {
        for (;; width = (width + 1) / 2, height = (height + 1) / 2) {
            levels_.push_back({width, height, {}});
            open_.emplace_back(budget, width);
            if (width == 1 && height == 1) break;
        }
        halves_ = {budget, "rows of a texture", levels_.front().width};
    }

    void add_row(std::span<const Texel> first) {
        std::span<const Texel> row = first;
        for (std::size_t l = 0;; ++l) {
            OpenLevel& open = open_[l];
            const std::uint32_t y = open.n_rows++;
            const bool is_last = open.n_rows == levels_[l].height;
            put(open, row, y);
            if (open.n_rows % kSide == 0 || is_last) append_tiles(l);
            if (l + 1 == levels_.size()) return;
            const bool is_even = y % 2 == 0;
            if (is_even && !is_last) {
                std::copy(row.begin(), row.end(), open.even_row.data());
                return;
            }
            // The rows of all levels are halved in one buffer: each is half of the one before.
            const std::span<Texel> half(halves_.data(), levels_[l + 1].width);
            halve(is_even ? row : std::span<const Texel>(open.even_row.span()), row, half);
            row = half;
        }
    }

  private:
    static void put(OpenLevel& open, std::span<const Texel> row, std::uint32_t y) {
        const std::size_t in_tile = std::size_t{y % kSide} * kSide;
        for (std::size_t x = 0; x < row.size(); x += kSide) {
            const std::size_t n = std::min<std::size_t>(kSide, row.size() - x);
            std::copy_n(
                row.begin() + static_cast<std::ptrdiff_t>(x), n,
                open.tiles[x / kSide].texels.begin() + static_cast<std::ptrdiff_t>(in_tile));
        }
    }
    void append_tiles(std::size_t l) {
        levels_[l].rows.push_back(tiles_.size());
        tiles_.append(open_[l].tiles.span());
    }

    std::vector<Texture::Level>& levels_;
    ooc::Spool<TextureTile>& tiles_;
    std::vector<OpenLevel> open_;
    ooc::Array<Texel> halves_;
};

}  // namespace

Texture::Texture(ooc::Context& context, ImageRows& image, ooc::Spool<TextureTile>& tiles) {
    PyramidBuilder builder(context.budget(), image.width(), image.height(), levels_, tiles);
    ooc::Array<Texel> row(context.budget(), "rows of a texture", image.width());
    for (std::uint32_t y = 0; y < image.height(); ++y) {
        image.read_row(row.data()->data());
        builder.add_row(row.span());
        context.check_stop();
    }
}

TexelCache::TexelCache(ooc::MemoryBudget& budget, const ooc::Spool<TextureTile>& tiles,
                       std::uint64_t n_lines)
    : tiles_(&tiles),
      shift_(64 - static_cast<unsigned>(std::countr_zero(n_lines))),
      held_(budget, "tiles of textures", n_lines),
      lines_(budget, "tiles of textures", n_lines),
      last_(std::numeric_limits<std::uint64_t>::max()) {}

void TexelCache::find(std::uint64_t tile) {
    // Fibonacci hashing: tiles above each other are often a power of two apart.
    const std::uint64_t line = (tile * 0x9e3779b97f4a7c15U) >> shift_;
    if (held_[line] != tile + 1) {
        held_[line] = 0;  // should read() throw
        tiles_->read(tile, {&lines_[line], 1});
        held_[line] = tile + 1;
    }
    last_ = tile;
    found_ = &lines_[line];
}

}  // namespace hewer::streaming
