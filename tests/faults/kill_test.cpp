// SPDX-License-Identifier: MIT
/// kill -9 in every stage; then the same command again.
#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <vector>

#include "tests/faults/fault_run.h"

namespace hewer::test {
namespace {

class KilledRun : public testing::TestWithParam<Job> {};

/// Reports carry times: those of two runs differ in digits only.
std::string without_digits(const std::string& text) {
    std::string rest;
    for (const char c : text) {
        if (std::string("0123456789.e+-").find(c) == std::string::npos) rest += c;
    }
    return rest;
}

TEST_P(KilledRun, leaves_nothing_that_the_next_one_minds) {
    FaultRun run;
    prepare(GetParam(), run);
    const Outcome undisturbed = run_program(run.args);
    ASSERT_EQ(undisturbed.code, 0) << undisturbed.err;
    const auto expected = run.results();
    ASSERT_FALSE(expected.empty());
    const bool is_report = GetParam() == Job::Measure;
    const auto expect_results = [&] {
        const auto found = run.results();
        ASSERT_EQ(run.outputs.list().size(), expected.size());
        for (const auto& [name, content] : expected) {
            ASSERT_EQ(found.count(name), 1U) << name;
            EXPECT_TRUE(is_report ? without_digits(found.at(name)) == without_digits(content)
                                  : found.at(name) == content)
                << name << " differs";
        }
    };
    const std::vector<std::string> stages = stages_begun(undisturbed.err);
    ASSERT_GE(stages.size(), 3U);
    for (std::size_t n = 1; n <= stages.size(); ++n) {
        SCOPED_TRACE("stage " + std::to_string(n) + ", " + stages[n - 1]);
        run.remove_results();
        RunningProgram program(run.args);
        wait_for_stage(program, n);
        program.send(SIGKILL);
        const Outcome killed = program.wait();
        EXPECT_EQ(run.temp.list(), Names{});
        if (run.outputs.list().size() == expected.size() &&
            run.outputs.list().front().find(".hewer-") == std::string::npos) {
            expect_results();  // the signal came too late, to a whole result
            continue;
        }
        EXPECT_EQ(killed.code, 1000 + SIGKILL) << killed.err;
        for (const std::string& name : run.outputs.list()) {
            // Only where the file system knows no files without a name.
            EXPECT_NE(name.find(".hewer-"), std::string::npos) << name;
        }
        // Where nothing is left the next run is one like the first: one of them shows it.
        if (run.outputs.list().empty() && n != stages.size()) continue;
        const Outcome again = run_program(run.args);
        EXPECT_EQ(again.code, 0) << again.err;
        expect_results();
        EXPECT_EQ(run.temp.list(), Names{});
    }
}

std::string name_of_case(const testing::TestParamInfo<Job>& test) {
    return name_of(test.param);
}

INSTANTIATE_TEST_SUITE_P(Faults, KilledRun,
                         testing::Values(Job::Levels, Job::Full, Job::Soup, Job::Doubles,
                                         Job::Generate, Job::Measure),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(slow, KilledRun, testing::Values(Job::Shuffled), name_of_case);

/// A simplification that never goes to disk would prove little.
class SpillingRun : public testing::TestWithParam<Job> {};

TEST_P(SpillingRun, spills) {
    FaultRun run;
    prepare(GetParam(), run);
    Args args = run.args;
    args.insert(args.end(), {"--max-temp", "1M"});
    const Outcome outcome = run_program(args);
    EXPECT_EQ(outcome.code, 6) << outcome.err;
    EXPECT_EQ(run.outputs.list(), Names{});
    EXPECT_EQ(run.temp.list(), Names{});
}

INSTANTIATE_TEST_SUITE_P(Faults, SpillingRun,
                         testing::Values(Job::Levels, Job::Shuffled, Job::Full, Job::Soup),
                         name_of_case);

}  // namespace
}  // namespace hewer::test
