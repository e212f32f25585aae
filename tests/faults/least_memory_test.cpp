// SPDX-License-Identifier: MIT
/// A limit that is too small is refused before any work with a number, and the number will do.
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "tests/faults/fault_run.h"

namespace hewer::test {
namespace {

enum class Input { Coherent, Shuffled, Soup };

struct Case {
    const char* name;
    Input input;
    Args args;
};

void PrintTo(const Case& test, std::ostream* out) {
    *out << test.name;
}

/// "55MiB" of "... raise --memory to 55 MiB or more".
std::string sufficient(const std::string& message) {
    const std::string before = "raise --memory to ";
    const std::size_t at = message.find(before);
    if (at == std::string::npos) return {};
    const std::size_t begin = at + before.size();
    const std::size_t end = message.find_first_not_of("0123456789", begin);
    return message.compare(end, 4, " MiB") == 0 ? message.substr(begin, end - begin) + "MiB" : "";
}

class LeastMemory : public testing::TestWithParam<Case> {};

TEST_P(LeastMemory, is_named_and_will_do) {
    const FaultRun run;
    std::string input = run.inputs.file("scan.ply");
    Args generate{"generate", input, "--triangles", "300k", "--quiet"};
    if (GetParam().input == Input::Shuffled) generate.emplace_back("--shuffle");
    ASSERT_EQ(run_program(generate).code, 0);
    if (GetParam().input == Input::Soup) {
        const std::string soup = run.inputs.file("scan.stl");
        ASSERT_EQ(
            run_program({"simplify", input, "-o", soup, "--triangles", "300k", "--quiet"}).code, 0);
        input = soup;
    }
    Args args{"simplify", input, "-o", run.outputs.file("out.ply"), "--quiet"};
    args.insert(args.end(), GetParam().args.begin(), GetParam().args.end());
    const auto run_with = [&](const std::string& memory, const std::string& threads) {
        Args all = args;
        all.insert(all.end(), {"--memory", memory, "--threads", threads});
        return run_program(all);
    };
    ASSERT_EQ(run_with("4GiB", "2").code, 0);
    const auto expected = run.results();
    for (const std::string threads : {"1", "8"}) {
        std::string named;
        for (const std::string little : {"1MiB", "16MiB", "17MiB", "40MiB"}) {
            run.remove_results();
            const Outcome refused = run_with(little, threads);
            EXPECT_EQ(refused.code, 5) << refused.err;
            EXPECT_NE(sufficient(refused.err), "") << little << ": " << refused.err;
            EXPECT_TRUE(named.empty() || named == sufficient(refused.err)) << refused.err;
            named = sufficient(refused.err);
            EXPECT_EQ(run.outputs.list(), Names{});
        }
        const Outcome enough = run_with(named, threads);
        EXPECT_EQ(enough.code, 0) << named << ", " << threads << " threads: " << enough.err;
        EXPECT_TRUE(run.results() == expected) << "another result";
    }
}

std::string name_of_case(const testing::TestParamInfo<Case>& test) {
    return test.param.name;
}

INSTANTIATE_TEST_SUITE_P(
    Faults, LeastMemory,
    testing::Values(
        Case{"refine", Input::Coherent, {"--triangles", "60k"}},
        Case{"uniform_soup", Input::Soup, {"--triangles", "60k", "--method", "uniform"}},
        Case{"full_shuffled", Input::Shuffled, {"--triangles", "60k", "--method", "full"}},
        Case{"levels", Input::Coherent, {"--lods", "100k,50k,1k"}}),
    name_of_case);

INSTANTIATE_TEST_SUITE_P(
    slow, LeastMemory,
    testing::Values(
        Case{"refine_shuffled", Input::Shuffled, {"--triangles", "60k"}},
        Case{"refine_soup", Input::Soup, {"--triangles", "60k"}},
        Case{"nearly_all", Input::Coherent, {"--triangles", "290k"}},
        Case{"more_than_there_is", Input::Coherent, {"--triangles", "100M"}},
        Case{"uniform", Input::Coherent, {"--triangles", "60k", "--method", "uniform"}},
        Case{"uniform_shuffled", Input::Shuffled, {"--triangles", "60k", "--method", "uniform"}},
        Case{"full", Input::Coherent, {"--triangles", "60k", "--method", "full"}},
        Case{"full_soup", Input::Soup, {"--triangles", "60k", "--method", "full"}},
        Case{"levels_shuffled", Input::Shuffled, {"--lods", "100k,50k,1k"}},
        Case{"displacement", Input::Coherent, {"--displacement", "0.1%"}},
        Case{"normal_variation", Input::Coherent, {"--triangles", "60k", "--priority", "normal"}}),
    name_of_case);

}  // namespace
}  // namespace hewer::test
