// SPDX-License-Identifier: MIT
/// What machines read: reports, JSON on standard output, progress lines.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "tests/support/run_program.h"

namespace hewer::test {
namespace {

using nlohmann::json;
using Keys = std::set<std::string>;

Keys keys_of(const json& object) {
    Keys keys;
    for (const auto& [key, value] : object.items()) keys.insert(key);
    return keys;
}

const Keys input_keys{
    "path",      "format",  "bytes",       "opening_seconds", "vertices",    "faces",
    "triangles", "bounds",  "has_normals", "has_colors",      "has_weights", "textures",
    "ignored",   "defects", "area",        "vertex_passes",   "basis",       "triangle_passes"};

TEST(CliInfo, tells_counts_bounds_and_area) {
    const ScratchDir dir;
    write_file(dir.file("square.ply"),
               "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
               "property float z\nelement face 3\nproperty list uchar int vertex_indices\n"
               "end_header\n0 0 0\n2 0 0\n2 2 0\n0 2 0\nnan 0 0\n4 0 1 2 3\n3 0 1 1\n3 0 1 4\n");
    const Outcome outcome = run_program({"info", dir.file("square.ply"), "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json info = json::parse(outcome.out);
    EXPECT_EQ(info["vertices"], 5);
    EXPECT_EQ(info["faces"], 3);
    EXPECT_EQ(info["triangles"], 3);
    EXPECT_EQ(info["area"], 4.0);
    EXPECT_EQ(info["bounds"]["max"], (json{2, 2, 0}));
    EXPECT_EQ(info["defects"]["polygons"], 1);
    EXPECT_EQ(info["defects"]["degenerate_triangles"], 1);
    EXPECT_EQ(info["defects"]["nonfinite_vertices"], 1);
    EXPECT_EQ(info["defects"]["nonfinite_triangles"], 1);
    EXPECT_NE(info["defects"]["first_nonfinite"].get<std::string>().find("vertex 4"),
              std::string::npos);
    EXPECT_EQ(info["ignored"], json::array());
    const Keys keys = keys_of(info);
    for (const std::string& key : input_keys) EXPECT_EQ(keys.count(key), 1U) << key;
}

TEST(CliInfo, says_the_same_for_any_number_of_threads) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 200);
    const std::string one =
        run_program({"info", dir.file("in.ply"), "--json", "--threads", "1"}).out;
    const std::string many =
        run_program({"info", dir.file("in.ply"), "--json", "--threads", "7"}).out;
    EXPECT_EQ(json::parse(one)["triangles"], 80000);
    EXPECT_EQ(one, many);
}

TEST(CliInfo, leaves_out_the_area_when_the_vertices_do_not_fit) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 600);  // 361,201 vertices, 12 bytes each
    const Outcome outcome = run_program({"info", dir.file("in.ply"), "--json", "--memory", "18M"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json info = json::parse(outcome.out);
    EXPECT_EQ(info["area"], 0.0);
    EXPECT_EQ(info["triangles"], 720000);
    EXPECT_NE(outcome.err.find("hewer: warning: "), std::string::npos) << outcome.err;
}

TEST(CliReport, of_simplify_has_all_figures) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 60);
    const Outcome outcome =
        run_program({"simplify", dir.file("in.ply"), "-o", dir.file("out.ply"), "--triangles",
                     "0.5k", "--threads", "2", "--report", dir.file("report.json")});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("7,200 triangles"), std::string::npos) << outcome.out;
    const json report = json::parse(read_file(dir.file("report.json")));
    EXPECT_EQ(keys_of(report), (Keys{"version",
                                     "command",
                                     "options",
                                     "method",
                                     "input",
                                     "grid",
                                     "kept_topology",
                                     "aggregate",
                                     "dropped",
                                     "refined_clusters",
                                     "feedback",
                                     "joined_necks",
                                     "collapses",
                                     "lods",
                                     "search",
                                     "stages",
                                     "warnings",
                                     "seconds",
                                     "bytes_read",
                                     "bytes_written",
                                     "temp_bytes_read",
                                     "temp_bytes_written",
                                     "peak_temp_bytes",
                                     "peak_budget_bytes",
                                     "peak_resident_bytes",
                                     "result_hash"}));
    EXPECT_EQ(keys_of(report["input"]), input_keys);
    EXPECT_EQ(keys_of(report["grid"]),
              (Keys{"cell_size", "dimensions", "occupied_cells", "border_cells",
                    "surviving_triangles", "is_consistently_wound"}));
    ASSERT_EQ(report["lods"].size(), 1U);
    const json& lod = report["lods"][0];
    EXPECT_EQ(keys_of(lod),
              (Keys{"path", "target", "target_triangles", "triangles", "vertices", "bounds",
                    "error_bound", "quantization", "lost_cells", "lost", "fit", "folded",
                    "topology", "measured", "proven_within", "is_nested", "bytes"}));
    EXPECT_EQ(lod["target"], (json{{"kind", "triangles"}, {"value", 500}}));
    EXPECT_LE(lod["triangles"], 500);
    EXPECT_GE(lod["triangles"], 495);
    ASSERT_FALSE(report["stages"].empty());
    EXPECT_EQ(keys_of(report["stages"][0]),
              (Keys{"name", "seconds", "bytes_read", "bytes_written", "temp_bytes_read",
                    "temp_bytes_written", "peak_budget_bytes", "peak_resident_bytes"}));
    EXPECT_EQ(report["options"]["triangles"], 500);
    EXPECT_EQ(report["options"]["ratio"], nullptr);
    EXPECT_EQ(report["options"]["method"], "auto");
    EXPECT_EQ(report["method"], "full");  // what a small input gets
    EXPECT_EQ(report["options"]["threads"], 2);
    EXPECT_EQ(report["options"]["strict"], false);
    EXPECT_GT(report["options"]["memory"], 0) << "the default is filled in";
    EXPECT_EQ(report["input"]["triangles"], 7200);
}

TEST(CliReport, of_measure_has_all_figures) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 30);
    write_hills(dir.file("coarse.ply"), 15);
    const Outcome outcome = run_program({"measure", dir.file("in.ply"), dir.file("coarse.ply"),
                                         "--samples", "10k", "--report", dir.file("report.json")});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("maximum"), std::string::npos) << outcome.out;
    const json report = json::parse(read_file(dir.file("report.json")));
    EXPECT_EQ(keys_of(report),
              (Keys{"version", "command", "options", "forward", "backward", "bounds", "diagonal",
                    "original_triangles", "simplified_triangles", "map_range", "within",
                    "temp_bytes_written", "seconds", "peak_resident_bytes"}));
    const Keys distance{"maximum",     "mean",       "rms",        "vertex_maximum",
                        "vertex_mean", "vertex_rms", "n_vertices", "n_samples",
                        "quantiles",   "histogram",  "worst"};
    EXPECT_EQ(keys_of(report["forward"]), distance);
    EXPECT_EQ(keys_of(report["backward"]), distance);
    EXPECT_EQ(report["original_triangles"], 1800);
    EXPECT_GT(report["forward"]["maximum"], 0);
}

TEST(CliReport, of_measure_has_what_is_proven_and_the_exit_code_tells) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 30);
    write_hills(dir.file("coarse.ply"), 15);
    const auto measure = [&](const char* distance) {
        return run_program({"measure", dir.file("in.ply"), dir.file("coarse.ply"), "--samples",
                            "10k", "--within", distance, "--report", dir.file("report.json"),
                            "--force"});
    };
    const Outcome near = measure("50%");
    EXPECT_EQ(near.code, 0) << near.err;
    EXPECT_NE(near.out.find("proven"), std::string::npos) << near.out;
    json within = json::parse(read_file(dir.file("report.json")))["within"];
    EXPECT_EQ(keys_of(within), (Keys{"distance", "verdict", "forward", "backward", "n_pieces"}));
    EXPECT_EQ(within["verdict"], "proven");
    const Outcome far = measure("0.001%");
    EXPECT_EQ(far.code, 1) << far.err;
    EXPECT_NE(far.out.find("not within"), std::string::npos) << far.out;
    within = json::parse(read_file(dir.file("report.json")))["within"];
    EXPECT_EQ(within["verdict"], "refuted");
    EXPECT_FALSE(within["forward"].empty() && within["backward"].empty());
    EXPECT_EQ(measure("1e-12").code, 1) << "what cannot be told is not proven";
    EXPECT_EQ(measure("0").code, 2);
}

TEST(CliReport, of_measure_has_the_range_of_the_map_and_a_picture_shows_it) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 30);
    write_hills(dir.file("coarse.ply"), 15);
    for (const char* which : {"simplified", "original"}) {
        const Outcome outcome =
            run_program({"measure", dir.file("in.ply"), dir.file("coarse.ply"), "--samples", "10k",
                         "--map", dir.file("map.ply"), "--map-of", which, "--map-range", "0.25",
                         "--report", dir.file("report.json"), "--force"});
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_NE(outcome.out.find("yellow is 0.25"), std::string::npos) << outcome.out;
        EXPECT_EQ(json::parse(read_file(dir.file("report.json")))["map_range"], 0.25);
        const Outcome info = run_program({"info", dir.file("map.ply"), "--json"});
        EXPECT_EQ(json::parse(info.out)["has_colors"], true);
        EXPECT_EQ(json::parse(info.out)["triangles"],
                  std::string(which) == "original" ? 1800 : 450);
    }
    const Outcome picture =
        run_program({"render", dir.file("in.ply"), dir.file("coarse.ply"), "--map",
                     dir.file("map.ply"), "--size", "40x30", "-o", dir.file("all.png")});
    ASSERT_EQ(picture.code, 0) << picture.err;
    // Width and height in the header of a PNG: three times 40, 30.
    EXPECT_EQ(read_file(dir.file("all.png")).substr(16, 8), std::string("\0\0\0x\0\0\0\x1e", 8));
}

TEST(CliMeasure, refuses_a_limit_that_is_too_small_and_names_one) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 30);
    const Outcome outcome = run_program(
        {"measure", dir.file("in.ply"), dir.file("in.ply"), "--memory", "20M", "--threads", "2"});
    EXPECT_EQ(outcome.code, 5);
    EXPECT_NE(outcome.err.find("raise --memory to more than"), std::string::npos) << outcome.err;
}

TEST(CliPlan, prints_json_on_request) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 60);
    const Outcome outcome = run_program(
        {"plan", dir.file("in.ply"), "--triangles", "500", "--memory", "512M", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json plan = json::parse(outcome.out);
    EXPECT_EQ(plan["memory_limit_bytes"], 512U << 20);
    EXPECT_EQ(plan["target_triangles"], 500);
    EXPECT_TRUE(plan["fits"].is_boolean());
}

TEST(CliProgress, json_is_one_object_a_line_and_never_goes_back) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 100);
    const Outcome outcome = run_program({"info", dir.file("in.ply"), "--progress", "json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::istringstream lines(outcome.err);
    int n_lines = 0;
    double fraction = 0;
    for (std::string line; std::getline(lines, line); ++n_lines) {
        const json progress = json::parse(line);
        EXPECT_EQ(keys_of(progress), (Keys{"stage", "stage_fraction", "fraction", "elapsed_seconds",
                                           "remaining_seconds", "done", "total", "unit"}));
        EXPECT_GE(progress["fraction"].get<double>(), fraction);
        fraction = progress["fraction"];
    }
    EXPECT_GE(n_lines, 4) << "begin and end of two stages";
    EXPECT_EQ(fraction, 1.0);
}

TEST(CliProgress, bar_is_erased_at_the_end) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 100);
    const Outcome outcome = run_program({"info", dir.file("in.ply"), "--progress", "bar"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find('%'), std::string::npos);
    EXPECT_TRUE(outcome.err.ends_with("\r\033[K")) << outcome.err;
}

TEST(CliProgress, is_silent_when_standard_error_is_no_terminal) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 10);
    EXPECT_EQ(run_program({"info", dir.file("in.ply")}).err, "");
}

TEST(CliSimplify, quiet_prints_nothing) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 20);
    const Outcome outcome = run_program(
        {"simplify", dir.file("in.ply"), "-o", dir.file("out.ply"), "--ratio", "20%", "--quiet"});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.out + outcome.err, "");
}

TEST(CliSimplify, uniform_with_a_cell_size_needs_no_target) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 60);
    const Outcome outcome = run_program({"simplify", dir.file("in.ply"), "-o", dir.file("out.ply"),
                                         "--method", "uniform", "--cell", "0.1"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(read_file(dir.file("out.ply")).starts_with("ply\n"));
}

const Keys topology_keys{"components",        "border_edges",         "border_loops",
                         "nonmanifold_edges", "nonmanifold_vertices", "euler"};

TEST(CliInfo, counts_the_topology_when_asked) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 50);
    const json plain = json::parse(run_program({"info", dir.file("in.ply"), "--json"}).out);
    EXPECT_FALSE(plain.contains("topology"));
    const Outcome outcome = run_program(
        {"info", dir.file("in.ply"), "--json", "--topology", "--temp-dir", dir.file("")});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json info = json::parse(outcome.out);
    EXPECT_EQ(keys_of(info["topology"]), topology_keys);
    EXPECT_EQ(info["topology"]["components"], 1);
    EXPECT_EQ(info["topology"]["border_edges"], 200);
    EXPECT_EQ(info["topology"]["border_loops"], 1);
    EXPECT_EQ(info["topology"]["euler"], 1);
    const Outcome words = run_program({"info", dir.file("in.ply"), "--topology"});
    EXPECT_NE(words.out.find("200 border edges in 1 loop"), std::string::npos) << words.out;
}

TEST(CliReport, has_the_topology_of_the_input_when_asked) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 50);
    const auto report_with = [&](const std::vector<std::string>& more) {
        std::vector<std::string> args{"simplify",          dir.file("in.ply"),      "-o",
                                      dir.file("out.ply"), "--triangles",           "500",
                                      "--report",          dir.file("report.json"), "--force"};
        args.insert(args.end(), more.begin(), more.end());
        const Outcome outcome = run_program(args);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return json::parse(read_file(dir.file("report.json")));
    };
    const json plain = report_with({});
    EXPECT_FALSE(plain["input"].contains("topology"));
    EXPECT_EQ(keys_of(plain["lods"][0]["topology"]), topology_keys);
    EXPECT_EQ(keys_of(plain["lods"][0]["lost"]), (Keys{"places", "cells", "list"}));
    EXPECT_EQ(plain["lods"][0]["topology"]["border_loops"], 1);
    const json report = report_with({"--topology-report"});
    EXPECT_EQ(report["input"]["topology"]["border_edges"], 200);
    EXPECT_EQ(report["input"]["triangle_passes"], plain["input"]["triangle_passes"].get<int>() + 1);
    EXPECT_EQ(report["result_hash"], plain["result_hash"]);
}

/// A sheet of hills and a triangle far above it.
void write_hills_and_speck(const ScratchDir& dir) {
    write_hills(dir.file("hills.ply"), 40);
    const Outcome outcome = run_program(
        {"simplify", dir.file("hills.ply"), "-o", dir.file("hills.stl"), "--triangles", "3k"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::string stl = read_file(dir.file("hills.stl"));
    constexpr std::size_t kHeader = 80;
    constexpr std::size_t kTriangle = 50;
    std::string speck = stl.substr(kHeader + 4, kTriangle);
    for (std::size_t corner = 0; corner < 3; ++corner) {
        // z is raised to 2 (0x40000000).
        speck.replace(12 + 12 * corner + 8, 4, std::string{'\0', '\0', '\0', '\x40'});
    }
    const std::size_t n = (stl.size() - kHeader - 4) / kTriangle + 1;
    stl += speck;
    for (std::size_t i = 0; i < 4; ++i) {
        stl[kHeader + i] = static_cast<char>(n >> (8 * i) & 0xff);
    }
    write_file(dir.file("in.stl"), stl);
}

TEST(CliReport, lists_dropped_parts) {
    const ScratchDir dir;
    write_hills_and_speck(dir);
    const Outcome outcome =
        run_program({"simplify", dir.file("in.stl"), "-o", dir.file("out.ply"), "--triangles",
                     "500", "--drop-parts", "20%", "--report", dir.file("report.json")});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("dropped    1 part"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("; the report lists them"), std::string::npos) << outcome.out;
    const json report = json::parse(read_file(dir.file("report.json")));
    EXPECT_EQ(report["options"]["drop_parts"], (json{{"kind", "relative_error"}, {"value", 0.2}}));
    EXPECT_EQ(report["dropped"]["places"], 1);
    EXPECT_NEAR(report["dropped"]["list"][0]["center"][2].get<double>(), 2, 0.01);
    EXPECT_EQ(report["lods"][0]["topology"]["components"], 1);
    EXPECT_LT(report["lods"][0]["bounds"]["max"][2], 1.9);

    const Outcome all = run_program({"simplify", dir.file("in.stl"), "-o", dir.file("none.ply"),
                                     "--triangles", "500", "--drop-parts", "1000"});
    EXPECT_EQ(all.code, 2);
    EXPECT_NE(all.err.find("--drop-parts"), std::string::npos) << all.err;
    EXPECT_FALSE(std::filesystem::exists(dir.file("none.ply")));
}

TEST(CliReport, of_simplify_and_plan_know_weights) {
    const ScratchDir dir;
    write_hills(dir.file("in.ply"), 60);
    const std::vector<std::string> options{"--triangles",     "500",     "--focus",
                                           "0,0,-9,9,9,9:20", "--focus", "-1,-1,-9,0,0,9:0.5",
                                           "--normal-weight", "0.5"};
    std::vector<std::string> simplify{"simplify", dir.file("in.ply"), "-o",     dir.file("out.ply"),
                                      "--report", dir.file("r.json"), "--quiet"};
    simplify.insert(simplify.end(), options.begin(), options.end());
    const Outcome outcome = run_program(simplify);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::vector<std::string> plan{"plan", dir.file("in.ply"), "--json"};
    plan.insert(plan.end(), options.begin(), options.end());
    const Outcome planned = run_program(plan);
    ASSERT_EQ(planned.code, 0) << planned.err;
    for (const std::string& text : {read_file(dir.file("r.json")), planned.out}) {
        const json report = json::parse(text);
        ASSERT_EQ(report["options"]["focus"].size(), 2U);
        EXPECT_EQ(report["options"]["focus"][0]["weight"], 20);
        EXPECT_EQ(report["options"]["focus"][1]["box"]["min"], (json{-1, -1, -9}));
        EXPECT_EQ(report["options"]["normal_weight"], 0.5);
        EXPECT_EQ(report["options"]["color_weight"], 0);
        EXPECT_EQ(report["options"]["weight_property"], nullptr);
        EXPECT_EQ(report["input"]["has_weights"], false);
    }
}

}  // namespace
}  // namespace hewer::test
