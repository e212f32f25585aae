// SPDX-License-Identifier: MIT
/// Times and counts the stages of a run for its report.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hewer/report.h"
#include "ooc/context.h"

namespace hewer::rsimp {

class StageLog {
  public:
    /// `bytes_read` and `bytes_written` give running totals.
    StageLog(ooc::Context& context, std::function<std::uint64_t()> bytes_read)
        : context_(context), bytes_read_(std::move(bytes_read)) {}

    /// Ends the stage before, if any, and starts one.
    void begin(const std::string& name, std::uint64_t total, const std::string& unit);
    void end();
    void add_bytes_written(std::uint64_t bytes) { bytes_written_ += bytes; }

    [[nodiscard]] const std::vector<StageReport>& stages() const { return stages_; }
    [[nodiscard]] std::uint64_t bytes_written() const { return bytes_written_; }
    [[nodiscard]] std::uint64_t peak_budget_bytes() const { return peak_budget_; }

  private:
    ooc::Context& context_;
    std::function<std::uint64_t()> bytes_read_;
    std::uint64_t bytes_written_ = 0;
    std::uint64_t peak_budget_ = 0;
    std::vector<StageReport> stages_;
    bool is_open_ = false;
    std::chrono::steady_clock::time_point start_;
    std::uint64_t read_before_ = 0;
    std::uint64_t written_before_ = 0;
    std::uint64_t temp_read_before_ = 0;
    std::uint64_t temp_written_before_ = 0;
};

}  // namespace hewer::rsimp
