// SPDX-License-Identifier: MIT
/// Progress and warnings on standard error.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>

#include "hewer/progress.h"

namespace hewer::app {

enum class ProgressStyle {
    None,
    Bar,   ///< one line that is written over, and erased at the end
    Json,  ///< one object a line; warnings as {"warning": "..."}
};

/// The user's choice ("bar", "json", "none"), or if empty: a bar on a terminal unless `quiet`.
ProgressStyle choose_progress_style(const std::string& choice, bool quiet);

/// "[#####     ]  52 %  cluster, 3.1 M triangles/s, 12.0 s left", at most `columns` wide.
std::string format_bar(const Progress& progress, double rate, std::size_t columns);

/// One JSON object, without the end of the line. remaining_seconds is null while it is not known.
std::string format_progress_json(const Progress& progress);

/// Thread-safe. The destructor erases the bar.
class ProgressPrinter {
  public:
    explicit ProgressPrinter(ProgressStyle style) : style_(style) {}
    ProgressPrinter(const ProgressPrinter&) = delete;
    ProgressPrinter& operator=(const ProgressPrinter&) = delete;
    ~ProgressPrinter() { finish(); }

    void show(const Progress& progress);
    void warn(const std::string& text);
    void finish();

    /// Hooks that call this object, which must outlive them.
    Hooks hooks(std::stop_token stop);

  private:
    void erase_bar();

    ProgressStyle style_;
    std::mutex mutex_;
    bool is_bar_drawn_ = false;
    std::string stage_;
    double stage_start_seconds_ = 0;
};

}  // namespace hewer::app
