// SPDX-License-Identifier: MIT
#include "streaming/text_colors.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace hewer::streaming {

namespace {

constexpr float kLeastByte = 2;
constexpr float kMost = 65535;
constexpr Rgba16 kWhite{65535, 65535, 65535, 65535};

bool has_color(const TextColor& c) {
    return c[0] >= 0;
}

std::uint16_t channel(float value, float one) {
    // The condition is false for NaN, too.
    if (!(value > 0)) return 0;
    return static_cast<std::uint16_t>(std::lround(std::min(value / one, 1.0F) * kMost));
}

}  // namespace

TextColor make_text_color(std::span<const double> numbers) {
    TextColor color = kNoTextColor;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        color[i] = static_cast<float>(std::max(numbers[i], 0.0));
    }
    return color;
}

void TextColors::append_missing(std::uint64_t n) {
    std::vector<Rgba16> white(std::min<std::uint64_t>(n, 4096), kWhite);
    for (std::uint64_t done = 0; done < n; done += white.size()) {
        white.resize(std::min<std::uint64_t>(n - done, white.size()), kWhite);
        colors_.append(white);
    }
}

void TextColors::add(std::span<const TextColor> colors, std::uint64_t n_vertices) {
    if (std::none_of(colors.begin(), colors.end(), has_color)) {
        n_missing_ += n_vertices;
        return;
    }
    has_missing_ = has_missing_ || n_missing_ > 0;
    append_missing(std::exchange(n_missing_, n_vertices - colors.size()));
    std::vector<Rgba16> piece;
    piece.reserve(colors.size());
    for (const TextColor& c : colors) {
        if (!has_color(c)) {
            has_missing_ = true;
            piece.push_back(kWhite);
            continue;
        }
        if (!has_bytes_ && std::max({c[0], c[1], c[2], c[3]}) >= kLeastByte) {
            has_bytes_ = true;
            n_as_floats_ = colors_.size() + piece.size();
        }
        const float one = has_bytes_ ? 255.0F : 1.0F;
        const bool has_alpha = c[3] >= 0;
        has_alpha_ = has_alpha_ || has_alpha;
        piece.push_back({channel(c[0], one), channel(c[1], one), channel(c[2], one),
                         has_alpha ? channel(c[3], one) : kWhite[3]});
    }
    colors_.append(piece);
}

void TextColors::finish() {
    if (colors_.empty()) return;
    if (has_alpha_) import_.set_has_alpha();
    if (!has_bytes_ || n_as_floats_ == 0) {
        import_.take_colors(std::move(colors_));
        return;
    }
    ooc::Spool<Rgba16> scaled(import_.context(), "imported colours");
    ooc::SpoolReader<Rgba16> reader(colors_);
    while (const Rgba16* color = reader.next()) {
        Rgba16 c = *color;
        if (scaled.size() < n_as_floats_ && !(has_missing_ && c == kWhite)) {
            const std::size_t n_channels = has_alpha_ ? 4 : 3;
            for (std::size_t k = 0; k < n_channels; ++k) {
                c[k] = static_cast<std::uint16_t>((c[k] + 127) / 255);
            }
        }
        scaled.push(c);
    }
    import_.take_colors(std::move(scaled));
}

}  // namespace hewer::streaming
