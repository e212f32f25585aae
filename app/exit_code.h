// SPDX-License-Identifier: MIT
/// How a run ended, for scripts.
#pragma once

#include <exception>
#include <span>
#include <string_view>

namespace hewer::app {

enum class ExitCode : int {
    Ok = 0,
    TooFar = 1,
    Usage = 2,
    Format = 3,
    Io = 4,
    Memory = 5,
    Disk = 6,
    Internal = 70,
    Interrupted = 130,
    Terminated = 143,
};

struct ExitMeaning {
    ExitCode code;
    std::string_view meaning;
};

/// All codes, ascending: for --help and the README.
std::span<const ExitMeaning> exit_meanings();

/// The code for what was thrown. Cancelled gives Interrupted; who knows the signal knows better.
ExitCode classify(const std::exception& error);

}  // namespace hewer::app
