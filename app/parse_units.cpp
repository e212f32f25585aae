// SPDX-License-Identifier: MIT
#include "app/parse_units.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "hewer/error.h"

namespace hewer::app {

namespace {

[[noreturn]] void refuse(std::string_view text, const std::string& why) {
    throw InvalidArgument("'" + std::string(text) + "' " + why);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (;;) {
        const std::size_t at = text.find(separator);
        parts.push_back(text.substr(0, at));
        if (at == std::string_view::npos) return parts;
        text.remove_prefix(at + 1);
    }
}

// "12.5M" as 12, 5 of 10, "M": digits apart from the suffix, so that counts stay exact.
struct Decimal {
    std::uint64_t whole = 0;
    std::uint64_t fraction = 0;  // over `fraction_scale`
    std::uint64_t fraction_scale = 1;
    std::string_view suffix;
};

constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();

Decimal split_decimal(std::string_view text, const std::string& expectation) {
    Decimal d;
    std::size_t i = 0;
    bool has_digits = false;
    for (; i < text.size() && text[i] >= '0' && text[i] <= '9'; ++i) {
        const auto digit = static_cast<std::uint64_t>(text[i] - '0');
        if (d.whole > (kMost - digit) / 10) refuse(text, "is too large");
        d.whole = d.whole * 10 + digit;
        has_digits = true;
    }
    if (i < text.size() && text[i] == '.') {
        for (++i; i < text.size() && text[i] >= '0' && text[i] <= '9'; ++i) {
            if (d.fraction_scale > kMost / 100) refuse(text, "has too many decimals");
            d.fraction = d.fraction * 10 + static_cast<std::uint64_t>(text[i] - '0');
            d.fraction_scale *= 10;
            has_digits = true;
        }
    }
    if (!has_digits) refuse(text, "is not " + expectation);
    d.suffix = text.substr(i);
    return d;
}

// whole + fraction/scale times `unit`, and what is left of a division that does not come out even.
std::uint64_t multiply(std::string_view text, const Decimal& d, std::uint64_t unit, bool& is_even) {
    if (d.whole != 0 && unit > kMost / d.whole) refuse(text, "is too large");
    // Trailing zeros of "1.500" would overflow for nothing.
    std::uint64_t fraction = d.fraction;
    std::uint64_t scale = d.fraction_scale;
    while (scale > 1 && fraction % 10 == 0) {
        fraction /= 10;
        scale /= 10;
    }
    if (fraction != 0 && unit > kMost / fraction) refuse(text, "has too many decimals");
    const std::uint64_t product = fraction * unit;
    is_even = product % scale == 0;
    const std::uint64_t base = d.whole * unit;
    if (product / scale > kMost - base) refuse(text, "is too large");
    return base + product / scale;
}

struct Suffix {
    std::string_view text;
    std::uint64_t unit;
};

constexpr std::array<Suffix, 6> kCountSuffixes{{
    {"", 1},
    {"k", 1'000},
    {"K", 1'000},
    {"M", 1'000'000},
    {"G", 1'000'000'000},
    {"T", 1'000'000'000'000},
}};

constexpr std::array<Suffix, 10> kByteSuffixes{{
    {"", 1},
    {"k", 1ULL << 10},
    {"K", 1ULL << 10},
    {"KiB", 1ULL << 10},
    {"M", 1ULL << 20},
    {"MiB", 1ULL << 20},
    {"G", 1ULL << 30},
    {"GiB", 1ULL << 30},
    {"T", 1ULL << 40},
    {"TiB", 1ULL << 40},
}};

template <std::size_t N>
const Suffix* find_suffix(const std::array<Suffix, N>& suffixes, std::string_view text) {
    const auto* it = std::find_if(suffixes.begin(), suffixes.end(),
                                  [&](const Suffix& s) { return s.text == text; });
    return it == suffixes.end() ? nullptr : it;
}

bool is_written_as_ratio(std::string_view text) {
    if (text.ends_with('%')) return true;
    return text.find('.') != std::string_view::npos &&
           text.find_first_not_of("0123456789.") == std::string_view::npos;
}

}  // namespace

std::uint64_t parse_count(std::string_view text) {
    static const std::string expected = "a count; write for example 250000, 250k or 1.5M";
    const Decimal d = split_decimal(text, expected);
    if (d.suffix == "%") refuse(text, "is a share, not a count; --ratio takes shares");
    const Suffix* suffix = find_suffix(kCountSuffixes, d.suffix);
    if (suffix == nullptr) refuse(text, "is not " + expected);
    bool is_even = true;
    const std::uint64_t count = multiply(text, d, suffix->unit, is_even);
    if (!is_even) refuse(text, "is not a whole number");
    return count;
}

std::uint64_t parse_bytes(std::string_view text) {
    static const std::string expected = "a size; write for example 512M, 1.5GiB or 65536";
    const Decimal d = split_decimal(text, expected);
    if (d.suffix == "KB" || d.suffix == "kB" || d.suffix == "MB" || d.suffix == "GB" ||
        d.suffix == "TB") {
        refuse(text, "may mean powers of 1000 or of 1024; write " +
                         std::string(1, static_cast<char>(d.suffix[0] == 'k' ? 'K' : d.suffix[0])) +
                         "iB for powers of 1024");
    }
    const Suffix* suffix = find_suffix(kByteSuffixes, d.suffix);
    if (suffix == nullptr) refuse(text, "is not " + expected);
    bool is_even = true;
    const std::uint64_t bytes = multiply(text, d, suffix->unit, is_even);
    if (!is_even && suffix->unit == 1) refuse(text, "is not a whole number of bytes");
    return bytes;
}

double parse_number(std::string_view text) {
    double value = 0;
    std::string_view digits = text;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (code != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
        refuse(text, "is not a number");
    }
    return value;
}

double parse_ratio(std::string_view text) {
    if (text.ends_with('%')) {
        const double percent = parse_number(text.substr(0, text.size() - 1));
        if (!(percent > 0 && percent <= 100)) {
            refuse(text, "is out of range; a ratio is above 0% and at most 100%");
        }
        return percent / 100;
    }
    const double value = parse_number(text);
    if (value >= 1) {
        const std::string number(text);
        refuse(text, "is ambiguous: write " + number + "% for " + number +
                         " per cent, or a fraction below 1");
    }
    if (!(value > 0)) refuse(text, "is out of range; a ratio is above 0% and at most 100%");
    return value;
}

Target parse_error(std::string_view text) {
    const bool is_relative = text.ends_with('%');
    const double value = parse_number(is_relative ? text.substr(0, text.size() - 1) : text);
    if (!(value > 0)) refuse(text, "is out of range; an error is above 0");
    if (is_relative) return {Target::Kind::RelativeError, value / 100};
    return {Target::Kind::Error, value};
}

std::vector<Target> parse_lods(std::string_view text) {
    std::vector<Target> lods;
    for (const std::string_view part : split(text, ',')) {
        Target lod;
        if (is_written_as_ratio(part)) {
            lod = {Target::Kind::Ratio, parse_ratio(part)};
        } else {
            lod = {Target::Kind::Triangles, static_cast<double>(parse_count(part))};
            if (lod.value < 1) refuse(text, "asks for a level of detail without triangles");
        }
        if (!lods.empty() && lods.back().kind != lod.kind) {
            refuse(text, "mixes counts and ratios; write all levels of detail in one kind");
        }
        if (!lods.empty() && !(lod.value < lods.back().value)) {
            refuse(text, "does not go from fine to coarse: '" + std::string(part) +
                             "' is not below the level before it");
        }
        lods.push_back(lod);
    }
    if (lods.size() < 2) {
        refuse(text, "is a single level of detail; --triangles and --ratio are for one");
    }
    return lods;
}

Bounds parse_box(std::string_view text) {
    const std::vector<std::string_view> parts = split(text, ',');
    if (parts.size() != 6) refuse(text, "is not a box; write x0,y0,z0,x1,y1,z1");
    Bounds box;
    for (std::size_t i = 0; i < 3; ++i) {
        box.min[i] = parse_number(parts[i]);
        box.max[i] = parse_number(parts[i + 3]);
        if (box.min[i] > box.max[i]) {
            refuse(text,
                   "is not a box: the first corner has the larger " + std::string(1, "xyz"[i]));
        }
    }
    if (box.min == box.max) refuse(text, "is a point, not a box");
    return box;
}

FocusBox parse_focus(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) {
        refuse(text, "has no weight; write x0,y0,z0,x1,y1,z1:WEIGHT");
    }
    FocusBox focus{parse_box(text.substr(0, colon)), parse_number(text.substr(colon + 1))};
    if (!(focus.weight >= 0 && focus.weight <= kMostWeight)) {
        refuse(text, "has a weight that is not from 0 to 1000");
    }
    return focus;
}

std::array<std::uint64_t, 2> parse_pixels(std::string_view text) {
    const std::vector<std::string_view> parts = split(text, 'x');
    if (parts.size() != 2) refuse(text, "is not a picture size; write for example 1920x1080");
    return {parse_count(parts[0]), parse_count(parts[1])};
}

std::array<double, 2> parse_pair(std::string_view text) {
    const std::vector<std::string_view> parts = split(text, ',');
    if (parts.size() != 2) refuse(text, "is not a pair of numbers; write for example 30,20");
    return {parse_number(parts[0]), parse_number(parts[1])};
}

Quantization parse_quantization(std::string_view text) {
    if (text == "auto") return {Quantization::Kind::Auto, 0};
    constexpr std::string_view kBit = "bit";
    constexpr std::uint64_t kMostBits = 30;
    if (text.size() > kBit.size() && text.ends_with(kBit)) {
        const std::uint64_t bits = parse_count(text.substr(0, text.size() - kBit.size()));
        if (bits < 1 || bits > kMostBits) refuse(text, "is not from 1bit to 30bit");
        return {Quantization::Kind::Bits, static_cast<double>(bits)};
    }
    const double step = parse_number(text);
    if (!(step > 0)) refuse(text, "is not a step above 0; write auto, 14bit or 0.001");
    return {Quantization::Kind::Step, step};
}

}  // namespace hewer::app
