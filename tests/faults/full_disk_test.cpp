// SPDX-License-Identifier: MIT
/// Disks that are full and limits on disk space: the exit code, what the message says, and that
/// nothing is left while old files stay.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/faults/fault_run.h"

namespace hewer::test {
namespace {

void expect_error(const Outcome& outcome, int code, const std::vector<std::string>& parts) {
    EXPECT_EQ(outcome.code, code) << outcome.err;
    const std::size_t at = outcome.err.find("hewer: error: ");
    ASSERT_NE(at, std::string::npos) << outcome.err;
    const std::string message = outcome.err.substr(at);
    for (const std::string& part : parts) {
        EXPECT_NE(message.find(part), std::string::npos) << part << " is not in " << message;
    }
}

Args with(Args args, const Args& more) {
    args.insert(args.end(), more.begin(), more.end());
    return args;
}

TEST(TemporaryDisk, that_is_full_ends_the_run_with_6) {
    FaultRun run;
    prepare(Job::Levels, run);
    const SmallDisk disk(run.temp, "3m");
    if (!disk.is_there()) GTEST_SKIP() << kNoSmallDisk;
    const Outcome outcome = run_program(run.args);
    expect_error(
        outcome, 6,
        {run.temp.path().string(), "3.00 MiB in all", "MiB are in use", "--temp-dir", "--memory"});
    EXPECT_EQ(run.outputs.list(), Names{});
    EXPECT_EQ(run.temp.list(), Names{});

    write_file(run.outputs.file("out_lod1.ply"), "precious");
    EXPECT_EQ(run_program(with(run.args, {"--force"})).code, 6);
    EXPECT_EQ(run.results(), (std::map<std::string, std::string>{{"out_lod1.ply", "precious"}}));
}

TEST(TemporarySpace, beyond_its_limit_ends_the_run_with_6) {
    for (const Job job : {Job::Levels, Job::Shuffled}) {
        FaultRun run;
        prepare(job, run);
        expect_error(run_program(with(run.args, {"--max-temp", "2MiB"})), 6,
                     {run.temp.path().string(), "are in use", "the limit is 2.00 MiB", "--max-temp",
                      "--memory"});
        EXPECT_EQ(run.outputs.list(), Names{});
        EXPECT_EQ(run.temp.list(), Names{});
    }
}

TEST(TemporaryFolder, that_does_not_exist_is_refused_before_any_work) {
    const ScratchDir dir;
    const Outcome outcome =
        run_program({"simplify", dir.file("absent.ply"), "-o", dir.file("out.ply"), "--ratio", "5%",
                     "--temp-dir", dir.file("absent")});
    expect_error(outcome, 2, {"--temp-dir", dir.file("absent")});
    EXPECT_EQ(dir.list(), Names{});
}

class OutputDisk : public testing::TestWithParam<const char*> {};

TEST_P(OutputDisk, that_is_full_ends_the_run_with_4_and_keeps_the_old_file) {
    FaultRun run;
    prepare(Job::Doubles, run);
    const SmallDisk disk(run.outputs, "700k");
    if (!disk.is_there()) GTEST_SKIP() << kNoSmallDisk;
    const std::string name = std::string("full") + GetParam();
    const Args args{"simplify",    run.inputs.file("scan.ply"),
                    "-o",          run.outputs.file(name),
                    "--triangles", "70k"};
    const std::vector<std::string> parts{name, "cannot write", "No space left", "free some space"};
    expect_error(run_program(args), 4, parts);
    EXPECT_EQ(run.outputs.list(), Names{});

    write_file(run.outputs.file(name), "precious");
    expect_error(run_program(with(args, {"--force"})), 4, parts);
    EXPECT_EQ(run.results(), (std::map<std::string, std::string>{{name, "precious"}}));
}

INSTANTIATE_TEST_SUITE_P(Faults, OutputDisk, testing::Values(".ply", ".obj", ".stl", ".glb"),
                         [](const auto& test) { return std::string(test.param + 1); });

TEST(OutputDisk, with_room_for_a_part_of_the_levels_gets_none_of_them) {
    FaultRun run;
    prepare(Job::Doubles, run);
    const SmallDisk disk(run.outputs, "1400k");  // 60k triangles take 1.2 MB
    if (!disk.is_there()) GTEST_SKIP() << kNoSmallDisk;
    const Args args{"simplify", run.inputs.file("scan.ply"),
                    "-o",       run.outputs.file("out.ply"),
                    "--lods",   "60k,50k"};
    expect_error(run_program(args), 4, {"out_lod1.ply", "No space left"});
    EXPECT_EQ(run.outputs.list(), Names{});
    write_file(run.outputs.file("out_lod0.ply"), "precious");
    EXPECT_EQ(run_program(with(args, {"--force"})).code, 4);
    EXPECT_EQ(run.results(), (std::map<std::string, std::string>{{"out_lod0.ply", "precious"}}));
}

TEST(OutputDisk, that_is_full_ends_generate_with_4) {
    const FaultRun run;
    const SmallDisk disk(run.outputs, "1m");
    if (!disk.is_there()) GTEST_SKIP() << kNoSmallDisk;
    const Args args{"generate", run.outputs.file("big.ply"), "--triangles", "1M"};
    expect_error(run_program(args), 4, {"big.ply", "No space left", "free some space"});
    EXPECT_EQ(run.outputs.list(), Names{});
    write_file(run.outputs.file("big.ply"), "precious");
    EXPECT_EQ(run_program(with(args, {"--force"})).code, 4);
    EXPECT_EQ(run.results(), (std::map<std::string, std::string>{{"big.ply", "precious"}}));
}

TEST(OutputFile, beyond_the_size_that_the_system_allows_is_an_io_error) {
    const FaultRun run;
    expect_error(run_program({"generate", run.outputs.file("big.ply"), "--triangles", "1M"},
                             {"sh", "-c", R"(ulimit -f 1000; exec "$@")", "sh"}),
                 4, {"big.ply", "cannot write", "File too large"});
    EXPECT_EQ(run.outputs.list(), Names{});
}

TEST(ReportDisk, that_is_full_ends_the_run_with_4_after_the_results) {
    const FaultRun run;
    const std::string mesh = run.inputs.file("mesh.ply");
    write_hills(mesh, 20);
    const SmallDisk disk(run.outputs, "64k");
    if (!disk.is_there()) GTEST_SKIP() << kNoSmallDisk;
    write_file(run.outputs.file("fill"), std::string(std::size_t{1} << 20, 'x'));
    const Args report{"--report", run.outputs.file("report.json")};
    const Outcome measured = run_program(with({"measure", mesh, mesh}, report));
    expect_error(measured, 4, {"report.json", "No space left"});
    EXPECT_NE(measured.out.find("maximum"), std::string::npos) << "what was measured is not lost";
    EXPECT_EQ(run.outputs.list(), Names{"fill"});

    const Outcome simplified = run_program(
        with({"simplify", mesh, "-o", run.inputs.file("out.ply"), "--ratio", "50%"}, report));
    expect_error(simplified, 4, {"report.json", "No space left"});
    EXPECT_EQ(run.inputs.list(), (Names{"mesh.ply", "out.ply"}));
    EXPECT_EQ(run.outputs.list(), Names{"fill"});
}

TEST(Devices, are_no_places_for_outputs) {
    const FaultRun run;
    const std::string mesh = run.inputs.file("mesh.ply");
    write_hills(mesh, 10);
    std::filesystem::create_symlink("/dev/full", run.outputs.file("full.ply"));
    for (const Args& args :
         {Args{"measure", mesh, mesh, "--report", "/dev/full"},
          Args{"generate", run.outputs.file("full.ply"), "--triangles", "1k"},
          Args{"simplify", mesh, "-o", run.outputs.file("full.ply"), "--ratio", "50%"}}) {
        expect_error(run_program(args), 2, {"device"});
        expect_error(run_program(with(args, {"--force"})), 2, {"device"});
    }
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
    EXPECT_TRUE(std::filesystem::is_symlink(run.outputs.file("full.ply")));
}

TEST(StandardOutput, that_is_full_is_an_io_error) {
    const FaultRun run;
    const std::string mesh = run.inputs.file("mesh.ply");
    write_hills(mesh, 10);
    const Args to_full{"sh", "-c", R"(exec "$@" > /dev/full)", "sh"};
    for (const Args& args : {Args{"info", mesh}, Args{"info", mesh, "--json"},
                             Args{"measure", mesh, mesh}, Args{"plan", mesh, "--ratio", "50%"}}) {
        expect_error(run_program(args, to_full), 4, {"standard output"});
    }
}

}  // namespace
}  // namespace hewer::test
