// SPDX-License-Identifier: MIT
#include "app/exit_code.h"

#include <array>
#include <new>

#include "hewer/error.h"

namespace hewer::app {

namespace {

constexpr std::array<ExitMeaning, 10> kMeanings{{
    {ExitCode::Ok, "done"},
    {ExitCode::TooFar, "measure --within: a point is farther, or that none is could not be shown"},
    {ExitCode::Usage, "usage: options that are wrong, contradictory, or would overwrite a file"},
    {ExitCode::Format, "an input is not what it claims to be"},
    {ExitCode::Io, "a file could not be read or written"},
    {ExitCode::Memory, "the memory limit is too small"},
    {ExitCode::Disk, "the limit on temporary disk space is too small"},
    {ExitCode::Internal, "an error of hewer itself"},
    {ExitCode::Interrupted, "interrupted (SIGINT); no file is left behind"},
    {ExitCode::Terminated, "terminated (SIGTERM, SIGHUP); no file is left behind"},
}};

template <typename E>
bool is(const std::exception& error) {
    return dynamic_cast<const E*>(&error) != nullptr;
}

}  // namespace

std::span<const ExitMeaning> exit_meanings() {
    return kMeanings;
}

ExitCode classify(const std::exception& error) {
    if (is<InvalidArgument>(error)) return ExitCode::Usage;
    if (is<FormatError>(error)) return ExitCode::Format;
    if (is<IoError>(error)) return ExitCode::Io;
    if (is<OutOfMemoryBudget>(error) || is<std::bad_alloc>(error)) return ExitCode::Memory;
    if (is<OutOfDiskBudget>(error)) return ExitCode::Disk;
    if (is<Cancelled>(error)) return ExitCode::Interrupted;
    return ExitCode::Internal;
}

}  // namespace hewer::app
