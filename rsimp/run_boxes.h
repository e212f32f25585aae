// SPDX-License-Identifier: MIT
/// Where the records of a long sequence in Morton order lie, by runs.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

#include "ooc/array.h"
#include "rsimp/mesh_piece.h"

namespace hewer::rsimp {

/// A box for each run and one for every 64 runs, so that whoever looks for a place passes by what
/// is far from it. Memory: 24 bytes a run.
class RunBoxes {
  public:
    RunBoxes(ooc::MemoryBudget& budget, std::string_view what, std::uint64_t n_runs)
        : runs_(budget, what, n_runs) {}

    [[nodiscard]] std::uint64_t size() const { return runs_.size(); }
    /// Different runs by different threads; then finish().
    void set(std::uint64_t run, const FloatBox& box) { runs_[run] = box; }
    void finish() {
        groups_.assign((runs_.size() + kRunsPerGroup - 1) / kRunsPerGroup, {});
        for (std::uint64_t run = 0; run < runs_.size(); ++run) {
            groups_[run / kRunsPerGroup].extend(runs_[run]);
        }
    }

    /// visit(run) for the runs that are within `reach` of `box`, in order. Any thread.
    template <typename Visit>
    void for_each_near(const FloatBox& box, double reach, const Visit& visit) const {
        for (std::uint64_t group = 0; group < groups_.size(); ++group) {
            if (!box.meets(groups_[group], reach)) continue;
            const std::uint64_t end = std::min(runs_.size(), (group + 1) * kRunsPerGroup);
            for (std::uint64_t run = group * kRunsPerGroup; run < end; ++run) {
                if (box.meets(runs_[run], reach)) visit(run);
            }
        }
    }

  private:
    static constexpr std::uint64_t kRunsPerGroup = 64;
    ooc::Array<FloatBox> runs_;
    std::vector<FloatBox> groups_;
};

}  // namespace hewer::rsimp
