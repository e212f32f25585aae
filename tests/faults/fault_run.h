// SPDX-License-Identifier: MIT
/// Runs of the real program that spill, and what they leave behind.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "tests/support/run_program.h"

namespace hewer::test {

using Args = std::vector<std::string>;
using Names = std::vector<std::string>;

/// A command with folders of its own: its inputs, its outputs (nothing else), its temporary files.
struct FaultRun {
    ScratchDir inputs;
    ScratchDir outputs;
    ScratchDir temp;
    Args args;

    /// Names and contents of what is in `outputs`.
    [[nodiscard]] std::map<std::string, std::string> results() const;
    void remove_results() const;
};

/// What the tests make trouble for.
enum class Job {
    Levels,    ///< two coloured LODs, the finer one more than half of the scan
    Shuffled,  ///< 600 k triangles in no order
    Full,      ///< `--method full`
    Soup,      ///< STL, three passes
    Doubles,   ///< a box scan before the vertices
    Generate,
    Measure,
};

/// Fills in `run`: makes the input, and the command, whose memory is so small that it spills.
void prepare(Job job, FaultRun& run);

/// For the names of tests.
std::string name_of(Job job);
void PrintTo(Job job, std::ostream* out);

/// The stages in what `--progress json` wrote, one entry each time that one begins.
std::vector<std::string> stages_begun(const std::string& err);

/// Waits until the program has begun `n` stages or is over.
void wait_for_stage(RunningProgram& program, std::size_t n);

/// A small file system of memory over `folder`, for a while.
class SmallDisk {
  public:
    SmallDisk(const ScratchDir& folder, const std::string& size);
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;
    ~SmallDisk();

    /// False where nobody may mount: the test has to be skipped.
    [[nodiscard]] bool is_there() const { return is_there_; }

  private:
    std::string folder_;
    bool is_there_;
};

constexpr const char* kNoSmallDisk = "a small file system can be mounted by root only";

}  // namespace hewer::test
