// SPDX-License-Identifier: MIT
/// The logs of the collapses in the blocks of one level.
#pragma once

#include <cstdint>
#include <vector>

#include "ooc/context.h"
#include "ooc/spool.h"
#include "rsimp/edge_collapse.h"

namespace hewer::rsimp {

class StepStore {
  public:
    explicit StepStore(ooc::Context& context) : steps_(context, "collapses"), first_(1) {}

    void append(const std::vector<CollapseStep>& log) {
        steps_.append(log);
        first_.push_back(steps_.size());
    }
    /// Number of logs.
    [[nodiscard]] std::size_t size() const { return first_.size() - 1; }
    [[nodiscard]] std::uint64_t n_steps(std::size_t log) const {
        return first_[log + 1] - first_[log];
    }
    /// The first n steps of a log. Any thread.
    [[nodiscard]] std::vector<CollapseStep> load(std::size_t log, std::uint64_t n) const {
        std::vector<CollapseStep> steps(n);
        steps_.read(first_[log], steps);
        return steps;
    }
    /// visit(log, step) for all steps, in order.
    template <typename Visit>
    void for_each(const Visit& visit) const {
        for (std::size_t log = 0; log < size(); ++log) {
            ooc::SpoolReader<CollapseStep> reader(steps_, first_[log], first_[log + 1]);
            while (const CollapseStep* step = reader.next()) visit(log, *step);
        }
    }

  private:
    ooc::Spool<CollapseStep> steps_;
    std::vector<std::uint64_t> first_;
};

}  // namespace hewer::rsimp
