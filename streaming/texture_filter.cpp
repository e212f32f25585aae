// SPDX-License-Identifier: MIT
#include "streaming/texture_filter.h"

#include <algorithm>
#include <cmath>

namespace hewer::streaming {

namespace {

// Of the pieces of a triangle: the diagonal of a texel.
constexpr double kLongestEdge = 1.41421356237309505;
// Along an edge of a triangle.
constexpr unsigned kMostParts = 16;

/// A place along one axis, 0..1, for any coordinate.
double wrapped(double x, Wrap wrap) {
    switch (wrap) {
        case Wrap::Repeat:
            return x - std::floor(x);
        case Wrap::Mirror: {
            const double in_two = x - 2 * std::floor(x / 2);
            return in_two > 1 ? 2 - in_two : in_two;
        }
        case Wrap::Clamp:
            return std::clamp(x, 0.0, 1.0);
    }
    return 0;
}

/// Two texels along an axis and the share of the second.
struct Pair {
    std::uint32_t first;
    std::uint32_t second;
    float share;
};

/// @param texels  of the image along the axis; @param size  the same of the level.
Pair find_pair(double x, Wrap wrap, double texels, double per_texel, std::uint32_t size) {
    // Texel i has its centre at i + 0.5.
    const double at = wrapped(x, wrap) * texels * per_texel - 0.5;
    const double floor = std::floor(at);
    const auto last = static_cast<std::int64_t>(size) - 1;
    const auto first = static_cast<std::int64_t>(floor);
    const auto inside = [&](std::int64_t i) {
        if (wrap == Wrap::Repeat) return i < 0 ? last : i > last ? std::int64_t{0} : i;
        return std::clamp<std::int64_t>(i, 0, last);
    };
    return {static_cast<std::uint32_t>(inside(first)),
            static_cast<std::uint32_t>(inside(first + 1)), static_cast<float>(at - floor)};
}

/// One level of a texture, to be read at any place.
class LevelReader {
  public:
    LevelReader(TexelCache& texels, const Texture& texture, std::size_t level,
                std::array<Wrap, 2> wrap)
        : texels_(texels),
          level_(texture.levels()[level]),
          size_{static_cast<double>(texture.width()), static_cast<double>(texture.height())},
          per_texel_(std::ldexp(1.0, -static_cast<int>(level))),
          wrap_(wrap) {}

    MeanColor at(const TexCoord& p) {
        const Pair x = find_pair(p[0], wrap_[0], size_[0], per_texel_, level_.width);
        const Pair y = find_pair(p[1], wrap_[1], size_[1], per_texel_, level_.height);
        MeanColor color{};
        add(x.first, y.first, (1 - x.share) * (1 - y.share), color);
        add(x.second, y.first, x.share * (1 - y.share), color);
        add(x.first, y.second, (1 - x.share) * y.share, color);
        add(x.second, y.second, x.share * y.share, color);
        return color;
    }

  private:
    void add(std::uint32_t x, std::uint32_t y, float share, MeanColor& color) {
        const Texel& texel = texels_.at(level_, x, y);
        for (std::size_t k = 0; k < 3; ++k) color[k] += share * static_cast<float>(texel[k]);
    }

    TexelCache& texels_;
    const Texture::Level& level_;
    std::array<double, 2> size_;
    double per_texel_;
    std::array<Wrap, 2> wrap_;
};

/// Sums of samples by corner.
class CornerSums {
  public:
    /// `b`: three times m times the barycentric coordinates of the sample.
    void add(const std::array<unsigned, 3>& b, const MeanColor& color) {
        const unsigned most = std::max({b[0], b[1], b[2]});
        const auto n_nearest = static_cast<float>((b[0] == most) + (b[1] == most) + (b[2] == most));
        for (std::size_t c = 0; c < 3; ++c) {
            if (b[c] != most) continue;
            for (std::size_t k = 0; k < 3; ++k) sums_[c][k] += color[k] / n_nearest;
            weights_[c] += 1 / n_nearest;
        }
    }
    [[nodiscard]] std::array<MeanColor, 3> means() const {
        std::array<MeanColor, 3> result;
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t k = 0; k < 3; ++k) result[c][k] = sums_[c][k] / weights_[c] / 255;
        }
        return result;
    }

  private:
    std::array<MeanColor, 3> sums_{};
    std::array<float, 3> weights_{};
};

}  // namespace

std::array<MeanColor, 3> TextureFilter::corner_means(const Texture& texture,
                                                     const std::array<TexCoord, 3>& triangle,
                                                     std::array<Wrap, 2> wrap) {
    double longest = 0;  // edge, in edges of pieces
    for (std::size_t c = 0; c < 3; ++c) {
        const TexCoord& a = triangle[c];
        const TexCoord& b = triangle[(c + 1) % 3];
        longest = std::max(
            longest, std::hypot((b[0] - a[0]) * texture.width(), (b[1] - a[1]) * texture.height()) /
                         kLongestEdge);
    }
    std::size_t level = 0;
    while (longest > kMostParts && level + 1 < texture.levels().size()) {
        longest /= 2;
        ++level;
    }
    const auto m =
        static_cast<unsigned>(std::clamp(std::ceil(longest), 1.0, static_cast<double>(kMostParts)));

    LevelReader reader(texels_, texture, level, wrap);
    CornerSums sums;
    const double scale = 1.0 / (3 * m);
    const auto sample = [&](unsigned b0, unsigned b1, unsigned b2) {
        TexCoord p;
        for (std::size_t k = 0; k < 2; ++k) {
            p[k] = scale * (b0 * triangle[0][k] + b1 * triangle[1][k] + b2 * triangle[2][k]);
        }
        sums.add({b0, b1, b2}, reader.at(p));
    };
    for (unsigned i = 0; i < m; ++i) {
        for (unsigned j = 0; i + j < m; ++j) {
            sample(3 * i + 1, 3 * j + 1, 3 * (m - 1 - i - j) + 1);
            // The one beside it, upside down.
            if (i + j + 1 < m) sample(3 * i + 2, 3 * j + 2, 3 * (m - 2 - i - j) + 2);
        }
    }
    return sums.means();
}

}  // namespace hewer::streaming
