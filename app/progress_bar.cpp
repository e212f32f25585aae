// SPDX-License-Identifier: MIT
#include "app/progress_bar.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/format_text.h"
#include "hewer/units.h"

namespace hewer::app {

namespace {

constexpr std::size_t kBarColumns = 24;
constexpr std::size_t kUsualColumns = 80;
// A rate over less time than this jumps about.
constexpr double kLeastSecondsForRate = 0.2;

std::size_t terminal_columns() {
    struct winsize size {};
    if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
    return kUsualColumns;
}

std::string format_rate(double rate, const std::string& unit) {
    std::array<char, 64> text{};
    if (unit == "bytes") {
        return format_bytes(static_cast<std::uint64_t>(rate)) + "/s";
    }
    const char* const format = rate >= 1e6 ? "%.1f M " : rate >= 1e3 ? "%.1f k " : "%.0f ";
    const double scaled = rate >= 1e6 ? rate / 1e6 : rate >= 1e3 ? rate / 1e3 : rate;
    std::snprintf(text.data(), text.size(), format, scaled);
    return text.data() + unit + "/s";
}

void put(const std::string& text) {
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
}

}  // namespace

ProgressStyle choose_progress_style(const std::string& choice, bool quiet) {
    if (choice == "bar") return ProgressStyle::Bar;
    if (choice == "json") return ProgressStyle::Json;
    if (choice == "none" || quiet) return ProgressStyle::None;
    return ::isatty(STDERR_FILENO) != 0 ? ProgressStyle::Bar : ProgressStyle::None;
}

std::string format_bar(const Progress& p, double rate, std::size_t columns) {
    const double fraction = std::clamp(p.fraction, 0.0, 1.0);
    const auto filled = static_cast<std::size_t>(fraction * kBarColumns);
    std::array<char, 16> percent{};
    std::snprintf(percent.data(), percent.size(), "] %3d %%  ", static_cast<int>(100 * fraction));
    std::string text =
        '[' + std::string(filled, '#') + std::string(kBarColumns - filled, ' ') + percent.data();
    text += p.stage;
    if (rate > 0) text += ", " + format_rate(rate, p.unit);
    if (p.remaining_seconds >= 0) text += ", " + format_seconds(p.remaining_seconds) + " left";
    if (text.size() > columns) text.resize(columns);
    return text;
}

std::string format_progress_json(const Progress& p) {
    nlohmann::ordered_json line;
    line["stage"] = p.stage;
    line["stage_fraction"] = p.stage_fraction;
    line["fraction"] = p.fraction;
    line["elapsed_seconds"] = p.elapsed_seconds;
    line["remaining_seconds"] = nullptr;
    if (p.remaining_seconds >= 0) line["remaining_seconds"] = p.remaining_seconds;
    line["done"] = p.done;
    line["total"] = p.total;
    line["unit"] = p.unit;
    return line.dump();
}

void ProgressPrinter::erase_bar() {
    if (is_bar_drawn_) put("\r\033[K");
    is_bar_drawn_ = false;
}

void ProgressPrinter::show(const Progress& progress) {
    const std::lock_guard lock(mutex_);
    if (style_ == ProgressStyle::None) return;
    if (style_ == ProgressStyle::Json) {
        put(format_progress_json(progress) + '\n');
        return;
    }
    if (progress.stage != stage_) {
        stage_ = progress.stage;
        stage_start_seconds_ = progress.elapsed_seconds;
    }
    const double seconds = progress.elapsed_seconds - stage_start_seconds_;
    const double rate =
        seconds > kLeastSecondsForRate ? static_cast<double>(progress.done) / seconds : 0;
    // One column stays free: many terminals wrap when the last one is written.
    put("\r" + format_bar(progress, rate, terminal_columns() - 1) + "\033[K");
    is_bar_drawn_ = true;
}

void ProgressPrinter::warn(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (style_ == ProgressStyle::Json) {
        put(nlohmann::json{{"warning", text}}.dump(-1, ' ', false,
                                                   nlohmann::json::error_handler_t::replace) +
            '\n');
        return;
    }
    erase_bar();
    put("hewer: warning: " + text + '\n');
}

void ProgressPrinter::finish() {
    const std::lock_guard lock(mutex_);
    erase_bar();
}

Hooks ProgressPrinter::hooks(std::stop_token stop) {
    Hooks hooks;
    if (style_ != ProgressStyle::None) {
        hooks.on_progress = [this](const Progress& progress) { show(progress); };
    }
    hooks.on_warning = [this](const std::string& text) { warn(text); };
    hooks.stop = std::move(stop);
    return hooks;
}

}  // namespace hewer::app
