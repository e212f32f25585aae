// SPDX-License-Identifier: MIT
/// SIGINT, SIGTERM and SIGHUP in every stage.
#include <gtest/gtest.h>

#include <csignal>
#include <cstring>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "tests/faults/fault_run.h"

namespace hewer::test {
namespace {

struct Signal {
    int number;
    int exit_code;
};

void PrintTo(const Signal& signal, std::ostream* out) {
    *out << ::sigabbrev_np(signal.number);
}

using Interruption = std::tuple<Signal, Job>;

class InterruptedRun : public testing::TestWithParam<Interruption> {};

TEST_P(InterruptedRun, says_so_and_leaves_no_file) {
    const auto [signal, job] = GetParam();
    FaultRun run;
    prepare(job, run);
    const Outcome undisturbed = run_program(run.args);
    ASSERT_EQ(undisturbed.code, 0) << undisturbed.err;
    const std::size_t n_results = run.outputs.list().size();
    const std::vector<std::string> stages = stages_begun(undisturbed.err);
    std::size_t n_interrupted = 0;
    for (std::size_t n = 1; n <= stages.size(); ++n) {
        SCOPED_TRACE("stage " + std::to_string(n) + ", " + stages[n - 1]);
        run.remove_results();
        RunningProgram program(run.args);
        wait_for_stage(program, n);
        program.send(signal.number);
        const Outcome outcome = program.wait();
        EXPECT_EQ(run.temp.list(), Names{});
        if (outcome.code == 0) {  // it was done before the signal came
            EXPECT_EQ(run.outputs.list().size(), n_results);
            continue;
        }
        ++n_interrupted;
        EXPECT_EQ(outcome.code, signal.exit_code) << outcome.err;
        EXPECT_NE(outcome.err.find("interrupted"), std::string::npos) << outcome.err;
        EXPECT_EQ(run.outputs.list(), Names{});
    }
    EXPECT_GE(n_interrupted, stages.size() / 2);
}

std::string name_of_case(const testing::TestParamInfo<Interruption>& test) {
    return ::sigabbrev_np(std::get<Signal>(test.param).number) +
           ("_" + name_of(std::get<Job>(test.param)));
}

const Signal interrupt{SIGINT, 130};
const Signal terminate{SIGTERM, 143};
const Signal hang_up{SIGHUP, 143};

INSTANTIATE_TEST_SUITE_P(
    Faults, InterruptedRun,
    testing::Values(Interruption{interrupt, Job::Soup}, Interruption{terminate, Job::Soup},
                    Interruption{hang_up, Job::Soup}, Interruption{interrupt, Job::Levels},
                    Interruption{interrupt, Job::Measure}, Interruption{interrupt, Job::Generate},
                    Interruption{terminate, Job::Generate}),
    name_of_case);
INSTANTIATE_TEST_SUITE_P(slow, InterruptedRun,
                         testing::Values(Interruption{terminate, Job::Shuffled}), name_of_case);

}  // namespace
}  // namespace hewer::test
