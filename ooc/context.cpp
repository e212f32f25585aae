// SPDX-License-Identifier: MIT
#include "ooc/context.h"

#include <algorithm>
#include <bit>
#include <thread>
#include <utility>

#include "hewer/error.h"
#include "ooc/parallel.h"

namespace hewer::ooc {

namespace {
// Some twenty spools are open at once, each with a page at its end that stays in memory.
constexpr std::uint64_t kPagesInMemory = 512;
constexpr std::uint64_t kLeastPageBytes = 64 << 10;
constexpr std::uint64_t kMostPageBytes = 1 << 20;
constexpr std::uint64_t kSortBytes = 2 << 20;
constexpr std::int64_t kReportIntervalNs = 100'000'000;
// A guess at the time left from less than this says nothing.
constexpr double kLeastFractionForEta = 0.02;
}  // namespace

unsigned thread_count(unsigned asked) {
    return asked != 0 ? asked : std::max(1U, std::thread::hardware_concurrency());
}

Context::Context(const ResourceLimits& limits, Hooks hooks, std::vector<StageWeight> stages)
    : hooks_(std::move(hooks)),
      n_threads_(thread_count(limits.n_threads)),
      budget_(limits.memory_bytes != 0 ? limits.memory_bytes : default_memory_limit()),
      page_bytes_(limits.page_bytes != 0
                      ? limits.page_bytes
                      : std::clamp(std::bit_floor(budget_.limit() / kPagesInMemory),
                                   kLeastPageBytes, kMostPageBytes)),
      sort_bytes_(limits.sort_bytes != 0 ? limits.sort_bytes : kSortBytes),
      spills_at_once_(limits.spills_at_once),
      spill_(limits.temp_dir, limits.max_temp_bytes),
      evictor_(budget_),
      workers_(std::make_unique<Workers>(n_threads_)),
      stages_(std::move(stages)),
      start_(std::chrono::steady_clock::now()) {
    for (const StageWeight& s : stages_) weight_sum_ += s.weight;
}

Context::~Context() = default;

HeldInput Context::hold(const MeshSource& input) {
    return {budget_.reserve("input", input.held_memory_bytes()),
            SpillSpace::Share(spill_, input.held_temp_bytes())};
}

void Context::check_stop() const {
    if (hooks_.stop.stop_requested()) throw Cancelled();
}

double Context::elapsed_seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Context::begin_stage(const std::string& name, std::uint64_t total, const std::string& unit) {
    check_stop();
    {
        const std::lock_guard lock(mutex_);
        stage_ = name;
        unit_ = unit;
        total_ = total;
        done_ = 0;
        const auto it = std::find_if(stages_.begin(), stages_.end(),
                                     [&](const StageWeight& s) { return s.name == name; });
        weight_ = it != stages_.end() ? it->weight : 0;
    }
    report(true);
}

void Context::advance(std::uint64_t amount) {
    check_stop();
    done_.fetch_add(amount, std::memory_order_relaxed);
    if (!hooks_.on_progress) return;
    report(false);
}

void Context::end_stage() {
    {
        const std::lock_guard lock(mutex_);
        if (total_ != 0) done_ = total_;
    }
    report(true);
    const std::lock_guard lock(mutex_);
    weight_before_ += weight_;
    weight_ = 0;
}

void Context::report(bool always) {
    if (!hooks_.on_progress) return;
    const std::int64_t now = std::chrono::duration_cast<std::chrono::nanoseconds>(
                                 std::chrono::steady_clock::now() - start_)
                                 .count();
    std::int64_t next = next_report_ns_.load(std::memory_order_relaxed);
    if (!always && (now < next || !next_report_ns_.compare_exchange_strong(
                                      next, now + kReportIntervalNs, std::memory_order_relaxed))) {
        return;
    }
    const std::lock_guard lock(mutex_);
    Progress p;
    p.stage = stage_;
    p.done = done_.load(std::memory_order_relaxed);
    p.total = total_;
    p.unit = unit_;
    p.stage_fraction =
        total_ != 0 ? std::min(1.0, static_cast<double>(p.done) / static_cast<double>(total_)) : 0;
    if (weight_sum_ > 0) {
        last_fraction_ = std::clamp((weight_before_ + weight_ * p.stage_fraction) / weight_sum_,
                                    last_fraction_, 1.0);
    } else {
        last_fraction_ = std::max(last_fraction_, p.stage_fraction);
    }
    p.fraction = last_fraction_;
    p.elapsed_seconds = static_cast<double>(now) * 1e-9;
    if (p.fraction > kLeastFractionForEta) {
        p.remaining_seconds = p.elapsed_seconds * (1 - p.fraction) / p.fraction;
    }
    hooks_.on_progress(p);
}

void Context::warn(const std::string& text) {
    const std::lock_guard lock(mutex_);
    warnings_.push_back(text);
    if (hooks_.on_warning) hooks_.on_warning(text);
}

}  // namespace hewer::ooc
