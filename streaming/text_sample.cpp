// SPDX-License-Identifier: MIT
#include "streaming/text_sample.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

namespace hewer::streaming {

namespace {

constexpr std::uint64_t kPieces = 128;
constexpr std::uint64_t kPieceBytes = 64 << 10;

constexpr bool is_blank(char c) {
    return c == ' ' || c == '\t';
}

/// The words of a line.
class Words {
  public:
    explicit Words(std::string_view line) : rest_(line) {}
    /// Empty at the end.
    std::string_view next() {
        while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
        const std::size_t n = std::min(rest_.find_first_of(" \t"), rest_.size());
        const std::string_view word = rest_.substr(0, n);
        rest_.remove_prefix(n);
        return word;
    }
    std::size_t count() {
        std::size_t n = 0;
        while (!next().empty()) ++n;
        return n;
    }
    /// Three numbers, if they are.
    void extend(Bounds& bounds) {
        Vec3 p{};
        for (double& x : p) {
            const std::string_view word = next();
            const auto result = std::from_chars(word.data(), word.data() + word.size(), x);
            if (result.ec != std::errc{} || !std::isfinite(x)) return;
        }
        bounds.extend(p);
    }

  private:
    std::string_view rest_;
};

/// take(line) for the whole lines of each piece. Returns by what to multiply.
template <typename Take>
double for_sampled_lines(const ooc::InputFile& file, const Take& take) {
    std::vector<char> bytes(kPieceBytes);
    std::uint64_t n_seen = 0;
    const std::uint64_t distance = std::max(file.size() / kPieces, kPieceBytes);
    for (std::uint64_t offset = 0; offset < file.size(); offset += distance) {
        std::string_view text(bytes.data(), file.read_at(offset, bytes.data(), bytes.size()));
        // A line belongs to the piece that it begins in; the last one is cut.
        const std::size_t begin = offset == 0 ? 0 : text.find_first_of("\r\n");
        const std::size_t end = text.find_last_of("\r\n");
        if (begin == text.npos || end <= begin) continue;
        text = text.substr(begin, end - begin);
        n_seen += text.size();
        while (!text.empty()) {
            const std::size_t n = std::min(text.find_first_of("\r\n"), text.size());
            take(text.substr(0, n));
            text.remove_prefix(std::min(n + 1, text.size()));
        }
    }
    return n_seen == 0 ? 0 : static_cast<double>(file.size()) / static_cast<double>(n_seen);
}

std::uint64_t scaled(std::uint64_t n, double factor) {
    return static_cast<std::uint64_t>(std::llround(static_cast<double>(n) * factor));
}

}  // namespace

void sample_obj(const ooc::InputFile& file, InputReport& report) {
    constexpr std::size_t kWithColor = 6;  // numbers of a vertex line: x y z r g b
    std::uint64_t n_normals = 0;
    const double factor = for_sampled_lines(file, [&](std::string_view line) {
        Words words(line);
        const std::string_view keyword = words.next();
        if (keyword == "v") {
            ++report.vertices;
            report.has_colors = report.has_colors || Words(words).count() >= kWithColor;
            words.extend(report.bounds);
        } else if (keyword == "vn") {
            ++n_normals;
        } else if (keyword == "f") {
            ++report.faces;
            report.triangles += std::max<std::size_t>(words.count(), 2) - 2;
        }
    });
    report.has_normals = n_normals > 0;
    report.vertices = scaled(report.vertices, factor);
    report.faces = scaled(report.faces, factor);
    report.triangles = scaled(report.triangles, factor);
}

void sample_ascii_stl(const ooc::InputFile& file, InputReport& report) {
    // Facets are counted by their corners: they may stand on a line each, or all on one.
    std::uint64_t n_corners = 0;
    const double factor = for_sampled_lines(file, [&](std::string_view line) {
        Words words(line);
        for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
            if (word != "vertex" && word != "VERTEX") continue;
            ++n_corners;
            words.extend(report.bounds);
        }
    });
    report.faces = scaled(n_corners, factor / 3);
    report.triangles = report.faces;
}

}  // namespace hewer::streaming
