// SPDX-License-Identifier: MIT
#include "rsimp/block_collapse.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "ooc/parallel.h"
#include "rsimp/edge_collapse.h"
#include "rsimp/step_selection.h"

namespace hewer::rsimp {

namespace {

// One of so many blocks is tried first.
constexpr std::size_t kSampleStride = 8;
constexpr std::size_t kLeastSample = 3;
// So few that are tried are kept to go on; of so few, of unequal size, all are tried at once, since
// one that is left for later may be the largest.
constexpr std::size_t kFewBlocks = 4;
// Memory that must be left for one that was tried to be kept: for spools, of what others do.
constexpr std::uint64_t kSpareToKeep = 16 << 20;
// The first run goes on to this times the cost that the sample suggests. Keys fall with about the
// cube of the number of vertices, so this is some per cent of them.
constexpr float kKeyMargin = 1.25F;
constexpr double kLeastRaise = 1.5;
constexpr double kMostRaise = 64;

class LevelCollapse {
  public:
    LevelCollapse(ooc::Context& context, const PieceStore& blocks,
                  const std::vector<std::uint64_t>& n_open, const CollapseNeed& need)
        : context_(context), blocks_(blocks), n_open_(n_open), need_(need), tried_(blocks.size()) {
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            n_all_open_ += n_open[b];
            most_bytes_ = std::max(most_bytes_, bytes_for(b));
        }
        n_alive_ = most_blocks_alive(context, most_bytes_);
    }

    StepStore run() {
        if (need_.rules.most_displacement) return run_all({});
        CollapseLimit limit;
        if (blocks_.size() == 1) {
            if (need_.faces != 0) {
                limit.most_faces = need_.faces;
            } else {
                limit.most_vertices = need_.vertices;
            }
            return run_all(limit);
        }
        limit.most_key = first_key();
        for (;;) {
            StepStore logs = run_all(limit);
            const double got = static_cast<double>(n_got_);
            const double wanted = static_cast<double>(std::max(need_.faces, need_.vertices));
            if (got >= wanted || n_unfinished_ == 0) return logs;
            const double missing = wanted / std::max(got, 1.0);
            limit.most_key *= static_cast<float>(
                std::clamp(missing * missing * missing, kLeastRaise, kMostRaise));
            if (!(limit.most_key > 0)) limit.most_key = std::numeric_limits<float>::min();
        }
    }

  private:
    struct Log {
        std::vector<CollapseStep> steps;
        bool is_finished;
    };

    [[nodiscard]] std::uint64_t bytes_for(std::size_t b) const {
        const std::uint64_t n = blocks_.n_vertices(b);
        const std::uint64_t f = blocks_.n_faces(b);
        return n * (sizeof(StoredVertex) + blocks_.attributes().bytes()) + f * sizeof(LocalFace) +
               EdgeCollapse::bytes_for(n, f, blocks_.attributes().quadrics);
    }

    /// A block's collapse, as far as it has got.
    struct Collapse {
        ooc::Reservation bytes;
        std::unique_ptr<EdgeCollapse> collapse;
    };

    Collapse begin_block(std::size_t b) {
        Collapse begun{context_.budget().reserve("a block's collapse", bytes_for(b)), nullptr};
        const BlockMesh mesh = blocks_.load(b, b + 1);
        begun.collapse = std::make_unique<EdgeCollapse>(context_.workers(), mesh, need_.rules);
        return begun;
    }
    Log run_block(const Collapse& block, const CollapseLimit& limit) {
        block.collapse->run(limit);
        context_.check_stop();
        // One that was tried may have gone farther than it would now.
        const std::vector<CollapseStep>& steps = block.collapse->steps();
        const auto end = std::partition_point(
            steps.begin(), steps.end(),
            [&](const CollapseStep& step) { return step.key <= limit.most_key; });
        return {{steps.begin(), end}, end == steps.end() && block.collapse->is_finished()};
    }
    Log run_block(std::size_t b, const CollapseLimit& limit) {
        // One that was tried goes on, and is given up afterwards.
        Collapse block = std::exchange(tried_[b], {});
        if (!block.collapse) block = begin_block(b);
        return run_block(block, limit);
    }
    /// The same, but it is kept to go on later if there is room beside what works at once.
    Log try_block(std::size_t b, const CollapseLimit& limit) {
        Collapse block = begin_block(b);
        Log log = run_block(block, limit);
        const std::uint64_t needed = n_alive_ * most_bytes_ + kSpareToKeep;
        if (context_.budget().available() >= needed) tried_[b] = std::move(block);
        return log;
    }

    StepStore run_all(const CollapseLimit& limit) {
        StepStore logs(context_);
        n_got_ = 0;
        n_unfinished_ = 0;
        context_.workers().in_order(
            blocks_.size(), n_alive_, [&](std::uint64_t b) { return run_block(b, limit); },
            [&](std::uint64_t, const Log& log) {
                for (const CollapseStep& step : log.steps) {
                    n_got_ += need_.faces != 0 ? step.n_faces : step.n_vertices;
                }
                if (!log.is_finished) ++n_unfinished_;
                logs.append(log.steps);
            });
        return logs;
    }

    /// The cost at which a few blocks have lost their share of what has to go, and a little more;
    /// where all of them were tried, it is enough for certain: what they have not got to yet only
    /// adds to what goes up to it.
    float first_key() {
        // The others have nothing to tell.
        std::vector<std::size_t> open;
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            if (n_open_[b] > 0) open.push_back(b);
        }
        const std::size_t n = open.size();
        const std::size_t n_sample =
            n <= kFewBlocks ? n : std::max(kLeastSample, n / kSampleStride);
        struct Key {
            float key;
            std::uint32_t weight;
        };
        std::vector<Key> keys;
        double share = 0;
        const double wanted = static_cast<double>(std::max(need_.faces, need_.vertices));
        const auto block = [&](std::uint64_t i) { return open[(2 * i + 1) * n / (2 * n_sample)]; };
        const auto share_of = [&](std::size_t b) {
            return wanted * static_cast<double>(n_open_[b]) /
                   static_cast<double>(std::max<std::uint64_t>(1, n_all_open_));
        };
        context_.workers().in_order(
            n_sample, n_alive_,
            [&](std::uint64_t i) {
                CollapseLimit limit;
                const auto most = static_cast<std::uint64_t>(std::ceil(1.1 * share_of(block(i))));
                (need_.faces != 0 ? limit.most_faces : limit.most_vertices) = most;
                return n_sample <= kFewBlocks ? try_block(block(i), limit)
                                              : run_block(block(i), limit);
            },
            [&](std::uint64_t i, const Log& log) {
                share += share_of(block(i));
                for (const CollapseStep& step : log.steps) {
                    keys.push_back({step.key, need_.faces != 0 ? step.n_faces : step.n_vertices});
                }
            });
        std::sort(keys.begin(), keys.end(),
                  [](const Key& a, const Key& b) { return a.key < b.key; });
        double sum = 0;
        float key = std::numeric_limits<float>::min();
        for (const Key& k : keys) {
            key = std::max(key, k.key);
            if ((sum += k.weight) >= share) break;
        }
        return n_sample == n ? key : kKeyMargin * key;
    }

    ooc::Context& context_;
    const PieceStore& blocks_;
    const std::vector<std::uint64_t>& n_open_;
    CollapseNeed need_;
    std::uint64_t n_all_open_ = 0;
    std::uint64_t most_bytes_ = 0;  // that a block takes
    std::size_t n_alive_ = 1;
    std::vector<Collapse> tried_;  // by block
    std::uint64_t n_got_ = 0;
    std::uint64_t n_unfinished_ = 0;
};

}  // namespace

std::size_t most_blocks_alive(ooc::Context& context, std::uint64_t bytes_a_block) {
    const std::uint64_t fits =
        context.budget().limit() / 2 / std::max<std::uint64_t>(1, bytes_a_block);
    return static_cast<std::size_t>(std::clamp<std::uint64_t>(fits, 1, context.n_threads()));
}

CollapseLogs collapse_blocks(ooc::Context& context, const PieceStore& blocks,
                             const std::vector<std::uint64_t>& n_open, const CollapseNeed& need) {
    if (need.is_none()) {
        CollapseLogs none{StepStore(context), std::vector<std::uint64_t>(blocks.size())};
        for (std::size_t b = 0; b < blocks.size(); ++b) none.logs.append({});
        return none;
    }
    CollapseLogs result{LevelCollapse(context, blocks, n_open, need).run(), {}};
    if (need.rules.most_displacement) {
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            result.n_steps.push_back(result.logs.n_steps(b));
        }
    } else {
        result.n_steps = select_steps(result.logs, need.faces, need.vertices);
    }
    return result;
}

}  // namespace hewer::rsimp
