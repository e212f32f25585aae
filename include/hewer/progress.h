// SPDX-License-Identifier: MIT
/// How a long run speaks to its caller, and how the caller stops it.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>

namespace hewer {

/// One report of progress. `fraction` never falls during a run; `stage_fraction` never during a
/// stage.
struct Progress {
    std::string stage;          ///< "cluster", "refine", ...
    double stage_fraction = 0;  ///< of this stage, 0..1
    double fraction = 0;  ///< of the whole run, 0..1, by the stages' expected share of the time
    double elapsed_seconds = 0;
    double remaining_seconds = -1;  ///< negative: not known yet
    std::uint64_t done = 0;         ///< in `unit`
    std::uint64_t total = 0;        ///< in `unit`; 0: not known
    std::string unit;               ///< "triangles", "bytes", ...
};

/// Hooks of the caller; any of them may be empty. Called from one thread at a time (not always the
/// same one), at most about ten times a second, so they may print. They must not throw.
struct Hooks {
    std::function<void(const Progress&)> on_progress;
    std::function<void(const std::string&)> on_warning;
    /// Checked at least once per batch of work: a stop request ends the run with Cancelled soon,
    /// and leaves no file behind.
    std::stop_token stop;
};

}  // namespace hewer
