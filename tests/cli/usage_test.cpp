// SPDX-License-Identifier: MIT
/// Help, version, and command lines that are refused before any work.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/run_program.h"

namespace hewer::test {
namespace {

using Args = std::vector<std::string>;

struct Refusal {
    const char* name;
    Args args;
    const char* reason;  ///< part of the sentence on standard error
};

class RefusedCommandLine : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedCommandLine, exits_with_2_and_says_why) {
    const Outcome outcome = run_program(GetParam().args);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.err.starts_with("hewer: error: ")) << outcome.err;
    EXPECT_NE(outcome.err.find(GetParam().reason), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("--help"), std::string::npos) << outcome.err;
}

// The input does not exist: a refusal must come before anybody looks for it.
Args simplify(const Args& rest) {
    Args args{"simplify", "absent.ply", "-o", "result.ply"};
    args.insert(args.end(), rest.begin(), rest.end());
    return args;
}

INSTANTIATE_TEST_SUITE_P(
    Cli, RefusedCommandLine,
    testing::Values(
        Refusal{"no_command", {}, "no command"},
        Refusal{"unknown_command", {"simplfy"}, "unknown command 'simplfy'"},
        Refusal{"no_input", {"simplify"}, "INPUT is missing"},
        Refusal{"no_output", {"simplify", "absent.ply", "--ratio", "5%"}, "--output is missing"},
        Refusal{"second_input",
                {"render", "a.ply", "b.ply", "c.ply"},
                "one argument too many: 'c.ply'"},
        Refusal{"unknown_option", simplify({"--triangels", "5"}), "did you mean --triangles?"},
        Refusal{"missing_value", simplify({"--triangles"}), "its value is missing"},
        Refusal{"twice", simplify({"--ratio", "5%", "--ratio", "6%"}), "more than once"},
        Refusal{"no_target", simplify({}), "no target"},
        Refusal{"focus_without_weight", simplify({"--ratio", "5%", "--focus", "0,0,0,1,1,1"}),
                "--focus: '0,0,0,1,1,1' has no weight"},
        Refusal{
            "focus_too_heavy",
            simplify({"--ratio", "5%", "--focus", "0,0,0,1,1,1:2", "--focus", "0,0,0,1,1,1:1001"}),
            "not from 0 to 1000"},
        Refusal{"focus_turned_over", simplify({"--ratio", "5%", "--focus", "1,0,0,0,1,1:2"}),
                "the first corner has the larger x"},
        Refusal{"negative_color_weight", simplify({"--ratio", "5%", "--color-weight", "-1"}),
                "is below 0"},
        Refusal{"color_weight_and_uniform",
                simplify({"--ratio", "5%", "--method", "uniform", "--color-weight", "1"}),
                "--color-weight and --method uniform contradict"},
        Refusal{"normal_weight_and_normal_priority",
                simplify({"--ratio", "5%", "--priority", "normal", "--normal-weight", "1"}),
                "--normal-weight and --priority normal contradict"},
        Refusal{"empty_weight_property", simplify({"--ratio", "5%", "--weight-property", ""}),
                "the name is empty"},
        Refusal{"two_targets", simplify({"--triangles", "5", "--ratio", "5%"}),
                "--triangles and --ratio contradict"},
        Refusal{"error_and_vertices", simplify({"--vertices", "5", "--error", "1"}),
                "--vertices and --error contradict"},
        Refusal{"lods_and_triangles", simplify({"--triangles", "5", "--lods", "20,10"}),
                "--triangles and --lods contradict"},
        Refusal{"lods_and_error", simplify({"--error", "5", "--lods", "20,10"}),
                "--error and --lods contradict"},
        Refusal{"lods_coarse_to_fine", simplify({"--lods", "10,20"}), "from fine to coarse"},
        Refusal{"lods_equal", simplify({"--lods", "20,20"}), "from fine to coarse"},
        Refusal{"lods_mixed", simplify({"--lods", "20k,5%"}), "mixes counts and ratios"},
        Refusal{"one_lod", simplify({"--lods", "20"}), "single level of detail"},
        Refusal{"no_triangles", simplify({"--triangles", "0"}), "'0' is below 1"},
        Refusal{"negative", simplify({"--triangles", "-5"}), "'-5' is not a count"},
        Refusal{"bare_ratio", simplify({"--ratio", "5"}), "ambiguous"},
        Refusal{"copy_fewer", simplify({"--method", "copy", "--triangles", "10"}),
                "--triangles and --method copy contradict"},
        Refusal{"copy_half", simplify({"--method", "copy", "--ratio", "50%"}),
                "--ratio and --method copy contradict"},
        Refusal{"copy_fit", simplify({"--method", "copy", "--fit", "2"}),
                "--fit and --method copy"},
        Refusal{"large_ratio", simplify({"--ratio", "150%"}), "at most 100%"},
        Refusal{"no_error", simplify({"--error", "0"}), "above 0"},
        Refusal{"error_and_displacement", simplify({"--error", "1", "--displacement", "1"}),
                "--error and --displacement contradict"},
        Refusal{"error_of_a_plan", {"plan", "absent.ply", "--error", "1"}, "unknown option"},
        Refusal{"cell_with_full", simplify({"--ratio", "5%", "--method", "full", "--cell", "1"}),
                "--cell and --method full contradict"},
        Refusal{"cell_with_uniform_target",
                simplify({"--ratio", "5%", "--method", "uniform", "--cell", "1"}),
                "--cell and --ratio contradict"},
        Refusal{"cell_alone", simplify({"--cell", "1"}), "no target"},
        Refusal{"priority_with_uniform",
                simplify({"--ratio", "5%", "--method", "uniform", "--priority", "normal"}),
                "--priority and --method uniform contradict"},
        Refusal{"unknown_method", simplify({"--ratio", "5%", "--method", "best"}),
                "'best' is none of auto, refine, uniform, full, copy"},
        Refusal{"flat_box", simplify({"--ratio", "5%", "--bounds", "0,0,0,0,0,0"}), "a point"},
        Refusal{"box_inside_out", simplify({"--ratio", "5%", "--bounds", "1,0,0,0,1,1"}),
                "larger x"},
        Refusal{"memory_without_suffix", simplify({"--ratio", "5%", "--memory", "512"}),
                "did you mean 512M?"},
        Refusal{"ambiguous_size", simplify({"--ratio", "5%", "--memory", "1GB"}), "write GiB"},
        Refusal{"no_threads", simplify({"--ratio", "5%", "--threads", "0"}), "below 1"},
        Refusal{"no_temp_dir", simplify({"--ratio", "5%", "--temp-dir", "/no/such/folder"}),
                "is not a folder"},
        Refusal{"unknown_extension",
                {"simplify", "absent.ply", "-o", "a.xyz", "--ratio", "5%"},
                ".xyz"},
        Refusal{
            "no_extension", {"simplify", "absent.ply", "-o", "a", "--ratio", "5%"}, "no extension"},
        Refusal{"missing_folder",
                {"simplify", "absent.ply", "-o", "/no/such/folder/a.ply", "--ratio", "5%"},
                "the folder /no/such/folder does not exist"},
        Refusal{"output_is_input",
                {"simplify", "a.ply", "-o", "./a.ply", "--ratio", "5%"},
                "would replace the input"},
        Refusal{"report_is_output", simplify({"--ratio", "5%", "--report", "result.ply"}),
                "the report would replace the output"},
        Refusal{"report_is_lod", simplify({"--lods", "20,10", "--report", "result_lods.json"}),
                "the report would replace the list of levels"},
        Refusal{"plan_no_target", {"plan", "absent.ply", "--memory", "1G"}, "no target"},
        Refusal{"generate_obj", {"generate", "a.obj"}, "hewer writes .ply here"},
        Refusal{"render_jpg", {"render", "a.ply", "-o", "a.jpg"}, "hewer writes .png here"},
        Refusal{
            "map_obj", {"measure", "a.ply", "b.ply", "--map", "c.obj"}, "hewer writes .ply here"},
        Refusal{"map_of_no_map",
                {"measure", "a.ply", "b.ply", "--map-of", "original"},
                "say what --map shows"},
        Refusal{"map_is_input", {"measure", "a.ply", "b.ply", "--map", "b.ply"}, "would replace"},
        Refusal{"huge_picture",
                {"render", "a.ply", "-o", "a.png", "--size", "99999x2"},
                "is above 32768"}),
    [](const testing::TestParamInfo<Refusal>& test) { return std::string(test.param.name); });

TEST(CliHelp, goes_to_standard_output_with_exit_0) {
    for (const Args& args : {Args{"--help"}, Args{"help"}, Args{"simplify", "--help"},
                             Args{"help", "measure"}, Args{"plan", "-h"}}) {
        const Outcome outcome = run_program(args);
        EXPECT_EQ(outcome.code, 0);
        EXPECT_EQ(outcome.err, "");
        EXPECT_NE(outcome.out.find("Usage: hewer "), std::string::npos);
        EXPECT_NE(outcome.out.find("130 "), std::string::npos) << "exit codes are listed";
    }
}

TEST(CliHelp, is_given_even_when_required_arguments_are_missing) {
    const Outcome outcome = run_program({"render", "--help"});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_NE(outcome.out.find("--size WxH"), std::string::npos);
}

TEST(CliHelp, markdown_has_a_row_for_every_option) {
    const Outcome outcome = run_program({"help", "--markdown"});
    EXPECT_EQ(outcome.code, 0);
    for (const char* option : {"--triangles", "--lods", "--border-weight", "--samples", "--y-up"}) {
        EXPECT_NE(outcome.out.find(option), std::string::npos) << option;
    }
}

TEST(CliVersion, is_one_line) {
    const Outcome outcome = run_program({"--version"});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_TRUE(outcome.out.starts_with("hewer 0.")) << outcome.out;
}

}  // namespace
}  // namespace hewer::test
