// SPDX-License-Identifier: MIT
/// What happens to files: bad inputs, outputs that exist.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/run_program.h"

namespace hewer::test {
namespace {

using Names = std::vector<std::string>;

void expect_error(const Outcome& outcome, int code, const std::string& part) {
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.err.starts_with("hewer: error: ")) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
}

TEST(CliInput, that_does_not_exist_is_an_io_error) {
    const ScratchDir dir;
    expect_error(run_program({"info", dir.file("absent.ply")}), 4, "absent.ply");
    expect_error(
        run_program({"simplify", dir.file("absent.ply"), "-o", dir.file("a.ply"), "--ratio", "5%"}),
        4, "absent.ply");
    EXPECT_EQ(dir.list(), Names{});
}

TEST(CliInput, that_is_a_folder_without_meshes_is_an_io_error) {
    const ScratchDir dir;
    expect_error(run_program({"info", dir.path()}), 4, "without a mesh file");
}

TEST(CliInput, that_is_no_mesh_is_a_format_error) {
    const ScratchDir dir;
    write_file(dir.file("a.ply"), "This is a letter, not a mesh.\n");
    expect_error(run_program({"info", dir.file("a.ply")}), 3, "a.ply");
    expect_error(
        run_program({"simplify", dir.file("a.ply"), "-o", dir.file("b.ply"), "--ratio", "5%"}), 3,
        "a.ply");
    EXPECT_EQ(dir.list(), Names{"a.ply"});
}

TEST(CliInput, warns_of_a_second_file_behind_the_first_and_strict_refuses_it) {
    const ScratchDir dir;
    const std::string one =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    write_file(dir.file("two.ply"), one + one);
    const std::vector<std::string> command = {
        "simplify", dir.file("two.ply"), "-o", dir.file("a.ply"), "--ratio", "100%", "--force"};
    const Outcome outcome = run_program(command);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const std::string text = std::to_string(one.size()) + " bytes ";
    EXPECT_NE(outcome.err.find(text + "behind the mesh were not read"), std::string::npos)
        << outcome.err;
    std::vector<std::string> strict = command;
    strict.emplace_back("--strict");
    const Outcome refused = run_program(strict);
    EXPECT_EQ(refused.code, 3) << refused.err;
    EXPECT_NE(refused.err.find(text + "are behind the mesh"), std::string::npos) << refused.err;
}

TEST(CliOutput, warns_of_what_its_format_and_hewer_do_not_carry) {
    const ScratchDir dir;
    write_file(dir.file("a.ply"),
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
               "property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
               "property float quality\nelement face 1\nproperty list uchar int vertex_indices\n"
               "end_header\n5000000.1 0 0 9 9 9 1\n5000001 0 0 9 9 9 1\n5000000 1 0 9 9 9 1\n"
               "3 0 1 2\n");
    const auto warnings_of = [&](const std::string& output) {
        const Outcome outcome =
            run_program({"simplify", dir.file("a.ply"), "-o", dir.file(output), "--ratio", "100%",
                         "--report", dir.file("r.json"), "--force"});
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_NE(read_file(dir.file("r.json")).find("not carried: vertex.quality"),
                  std::string::npos);
        return outcome.err;
    };
    const std::string to_stl = warnings_of("a.stl");
    EXPECT_NE(to_stl.find("not carried: vertex.quality"), std::string::npos) << to_stl;
    EXPECT_NE(to_stl.find(".stl has no place for colours"), std::string::npos) << to_stl;
    EXPECT_NE(to_stl.find("too coarse"), std::string::npos) << to_stl;
    const std::string to_ply = warnings_of("b.ply");
    EXPECT_EQ(to_ply.find("no place"), std::string::npos) << to_ply;
    EXPECT_EQ(to_ply.find("too coarse"), std::string::npos) << to_ply;
}

TEST(CliInput, that_is_cut_short_is_a_format_error) {
    const ScratchDir dir;
    write_hills(dir.file("whole.ply"), 20);
    const std::string whole = read_file(dir.file("whole.ply"));
    write_file(dir.file("cut.ply"), whole.substr(0, whole.size() / 2));
    expect_error(
        run_program({"simplify", dir.file("cut.ply"), "-o", dir.file("b.ply"), "--ratio", "5%"}), 3,
        "cut.ply");
    EXPECT_EQ(dir.list(), (Names{"cut.ply", "whole.ply"}));
}

TEST(CliInput, that_is_text_gives_the_same_bytes_for_any_threads_and_memory) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 60);
    const auto simplify = [&](const std::string& in, const std::string& out,
                              const std::vector<std::string>& more) {
        std::vector<std::string> args{"simplify", dir.file(in), "-o",         dir.file(out),
                                      "--ratio",  "50%",        "--temp-dir", dir.path()};
        args.insert(args.end(), more.begin(), more.end());
        const Outcome outcome = run_program(args);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
    };
    simplify("in.ply", "a.obj", {});
    simplify("a.obj", "b.ply", {"--threads", "1"});
    simplify("a.obj", "c.ply", {"--threads", "4", "--memory", "64M"});
    EXPECT_EQ(read_file(dir.file("b.ply")), read_file(dir.file("c.ply")));
    EXPECT_EQ(dir.list(), (Names{"a.obj", "b.ply", "c.ply", "in.ply"}));
}

TEST(CliInput, that_is_text_with_a_bad_line_names_it) {
    const ScratchDir dir;
    write_file(dir.file("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n");
    EXPECT_EQ(run_program({"info", dir.file("a.obj")}).code, 0);
    expect_error(run_program({"simplify", dir.file("a.obj"), "-o", dir.file("b.ply"), "--ratio",
                              "50%", "--strict"}),
                 3, "face 1 (line 5)");
    write_file(dir.file("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 one 0\nf 1 2 3\n");
    expect_error(run_program({"info", dir.file("a.obj")}), 3, "line 3: 'one' is not a number");
    EXPECT_EQ(dir.list(), Names{"a.obj"});
}

TEST(CliOutput, that_exists_is_kept_without_force) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 20);
    write_file(dir.file("out.ply"), "precious");
    write_file(dir.file("report.json"), "precious");
    const std::vector<std::string> args{"simplify",          dir.file("in.ply"), "-o",
                                        dir.file("out.ply"), "--ratio",          "20%"};
    expect_error(run_program(args), 2, "--force");
    EXPECT_EQ(read_file(dir.file("out.ply")), "precious");
    expect_error(run_program({"simplify", dir.file("in.ply"), "-o", dir.file("new.ply"), "--ratio",
                              "20%", "--report", dir.file("report.json")}),
                 2, "--force");
    EXPECT_EQ(read_file(dir.file("report.json")), "precious");
    expect_error(run_program({"generate", dir.file("out.ply")}), 2, "--force");
    EXPECT_EQ(read_file(dir.file("out.ply")), "precious");
    EXPECT_EQ(dir.list(), (Names{"in.ply", "out.ply", "report.json"}));

    std::vector<std::string> forced = args;
    forced.emplace_back("--force");
    EXPECT_EQ(run_program(forced).code, 0);
    EXPECT_TRUE(read_file(dir.file("out.ply")).starts_with("ply\n"));
}

TEST(CliOutput, one_of_the_levels_that_exists_is_kept_without_force) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 20);
    write_file(dir.file("out_lod1.ply"), "precious");
    expect_error(run_program({"simplify", dir.file("in.ply"), "-o", dir.file("out.ply"), "--lods",
                              "400,100"}),
                 2, "out_lod1.ply");
    EXPECT_EQ(read_file(dir.file("out_lod1.ply")), "precious");
    EXPECT_EQ(dir.list(), (Names{"in.ply", "out_lod1.ply"}));
}

}  // namespace
}  // namespace hewer::test
