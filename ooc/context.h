// SPDX-License-Identifier: MIT
/// What every stage is handed: memory, threads, a stop request, progress.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "hewer/mesh_source.h"
#include "hewer/progress.h"
#include "ooc/memory_budget.h"
#include "ooc/page_evictor.h"
#include "ooc/spill.h"

namespace hewer::ooc {

class Workers;

/// What a run may use. Nothing in here changes its result.
struct ResourceLimits {
    std::uint64_t memory_bytes = 0;    ///< 0: default_memory_limit()
    unsigned n_threads = 0;            ///< 0: as many as the machine has
    std::filesystem::path temp_dir{};  ///< empty: TMPDIR, else /tmp
    std::uint64_t max_temp_bytes = 0;  ///< 0: no limit
    std::uint64_t page_bytes = 0;      ///< of spools; 0: by the memory limit
    std::uint64_t sort_bytes = 0;      ///< of the buffers of sorters; 0: 2 MiB
    bool spills_at_once = false;       ///< see SimplifyOptions::Tuning
};

/// `asked`, or for 0 as many as the machine has.
unsigned thread_count(unsigned asked);

/// What an input holds besides the run's own data, as long as the run lasts.
struct HeldInput {
    Reservation memory;
    SpillSpace::Share temp;
};

/// A stage of a run, for progress: its name and its expected share of the time.
struct StageWeight {
    std::string name;
    double weight = 1;
};

/// Lives as long as the run. advance() may be called by any thread; the callback runs on the
/// caller's thread, never twice at once, at most ten times a second.
class Context {
  public:
    /// Throws IoError if limits.temp_dir is named and cannot be used.
    explicit Context(const ResourceLimits& limits, Hooks hooks = {},
                     std::vector<StageWeight> stages = {});
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    /// Counts what `input` holds, memory and temporary files, against the limits of this run. The
    /// result must not outlive it.
    [[nodiscard]] HeldInput hold(const MeshSource& input);

    MemoryBudget& budget() { return budget_; }
    Workers& workers() { return *workers_; }
    SpillSpace& spill() { return spill_; }
    PageEvictor& evictor() { return evictor_; }
    [[nodiscard]] unsigned n_threads() const { return n_threads_; }
    /// Of the spools of this run. Changes nothing but speed.
    [[nodiscard]] std::uint64_t page_bytes() const { return page_bytes_; }
    /// Pages of spools go to disk as soon as they are full.
    [[nodiscard]] bool spills_at_once() const { return spills_at_once_; }
    /// Of the buffer of an ExternalSorter of this run. Changes nothing but speed.
    [[nodiscard]] std::uint64_t sort_bytes() const { return sort_bytes_; }

    /// Throws Cancelled if the caller asked for an end.
    void check_stop() const;

    /// A stage starts; `total` in `unit`, 0 if not known. Unknown names get weight 0.
    void begin_stage(const std::string& name, std::uint64_t total, const std::string& unit);
    /// `amount` more is done. Also a check_stop().
    void advance(std::uint64_t amount);
    void end_stage();

    void warn(const std::string& text);
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
    [[nodiscard]] double elapsed_seconds() const;

  private:
    void report(bool always);

    Hooks hooks_;
    unsigned n_threads_;
    MemoryBudget budget_;
    std::uint64_t page_bytes_;
    std::uint64_t sort_bytes_;
    bool spills_at_once_;
    SpillSpace spill_;
    PageEvictor evictor_;
    std::unique_ptr<Workers> workers_;
    std::vector<StageWeight> stages_;
    std::vector<std::string> warnings_;
    std::chrono::steady_clock::time_point start_;

    std::mutex mutex_;
    std::string stage_;
    std::string unit_;
    std::atomic<std::uint64_t> done_{0};
    std::uint64_t total_ = 0;
    double weight_before_ = 0;  // of the stages that are over
    double weight_ = 0;         // of the current stage
    double weight_sum_ = 0;
    double last_fraction_ = 0;
    std::atomic<std::int64_t> next_report_ns_{0};
};

}  // namespace hewer::ooc
