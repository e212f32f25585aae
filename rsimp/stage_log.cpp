// SPDX-License-Identifier: MIT
#include "rsimp/stage_log.h"

#include <algorithm>

#include "ooc/resource_usage.h"

namespace hewer::rsimp {

void StageLog::begin(const std::string& name, std::uint64_t total, const std::string& unit) {
    end();
    context_.budget().reset_peak();
    context_.begin_stage(name, total, unit);
    stages_.emplace_back();
    stages_.back().name = name;
    start_ = std::chrono::steady_clock::now();
    read_before_ = bytes_read_();
    written_before_ = bytes_written_;
    temp_read_before_ = context_.spill().bytes_read();
    temp_written_before_ = context_.spill().bytes_written();
    is_open_ = true;
}

void StageLog::end() {
    if (!is_open_) return;
    is_open_ = false;
    context_.end_stage();
    StageReport& s = stages_.back();
    s.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    s.bytes_read = bytes_read_() - read_before_;
    s.bytes_written = bytes_written_ - written_before_;
    s.temp_bytes_read = context_.spill().bytes_read() - temp_read_before_;
    s.temp_bytes_written = context_.spill().bytes_written() - temp_written_before_;
    s.peak_budget_bytes = context_.budget().peak();
    s.peak_resident_bytes = ooc::peak_resident_bytes();
    peak_budget_ = std::max(peak_budget_, s.peak_budget_bytes);
}

}  // namespace hewer::rsimp
