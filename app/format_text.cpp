// SPDX-License-Identifier: MIT
#include "app/format_text.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "hewer/units.h"

namespace hewer::app {

namespace {

template <typename... Args>
std::string print(const char* format, Args... args) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), format, args...);
    return text.data();
}

}  // namespace

std::string format_length(double value) {
    return print("%.6g", value);
}

std::string format_seconds(double seconds) {
    constexpr double kMinute = 60;
    constexpr double kHour = 3600;
    if (seconds < 99.95) return print("%.1f s", seconds);
    if (seconds < kHour) {
        const auto whole = static_cast<unsigned long long>(std::llround(seconds));
        return print("%llu min %02llu s", whole / 60, whole % 60);
    }
    const auto minutes = static_cast<unsigned long long>(std::llround(seconds / kMinute));
    return print("%llu h %02llu min", minutes / 60, minutes % 60);
}

std::string format_percent(double value, double whole) {
    if (!(whole > 0)) return "-";
    return print("%.3g %%", 100 * value / whole);
}

std::string format_bounds(const Bounds& bounds) {
    if (bounds.is_empty()) return "empty";
    std::string text;
    for (const double x : bounds.min) text += format_length(x) + ' ';
    text += "to";
    for (const double x : bounds.max) text += ' ' + format_length(x);
    return text;
}

std::string format_plural(std::uint64_t count, const std::string& noun) {
    return format_count(count) + ' ' + noun + (count == 1 ? "" : "s");
}

}  // namespace hewer::app
