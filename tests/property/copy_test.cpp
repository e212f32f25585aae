// SPDX-License-Identifier: MIT
/// Method::Copy: what it keeps, what it leaves out, and that it is the same under any limit.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include "hewer/error.h"
#include "hewer/simplify.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/ply_builder.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

SimplifyOptions copy_options() {
    SimplifyOptions options;
    options.method = Method::Copy;
    return options;
}

TEST(Copy, is_what_a_ratio_of_one_means_unless_options_ask_for_work) {
    const Mesh mesh = test::torus(12, 8);
    SimplifyOptions options = test::options_for(Target::Kind::Ratio, 1);
    EXPECT_EQ(test::run_simplify(mesh, options).report.options.method, Method::Copy);
    options.fit_rounds = 1;
    EXPECT_EQ(test::run_simplify(mesh, options).report.options.method, Method::Full);
    options = test::options_for(Target::Kind::Ratio, 0.5);
    EXPECT_EQ(test::run_simplify(mesh, options).report.options.method, Method::Full);
}

TEST(Copy, refuses_what_contradicts_it) {
    const Mesh mesh = test::torus(12, 8);
    SimplifyOptions options = copy_options();
    options.targets = {{Target::Kind::Triangles, 10}};
    EXPECT_THROW(test::run_simplify(mesh, options), InvalidArgument);
    options = copy_options();
    options.cell_size = 0.1;
    EXPECT_THROW(test::run_simplify(mesh, options), InvalidArgument);
    options = copy_options();
    options.drop_parts = Target{Target::Kind::Error, 0.1};
    EXPECT_THROW(test::run_simplify(mesh, options), InvalidArgument);
}

TEST(Copy, leaves_out_what_is_of_no_use_and_counts_it) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {9, 9, 9}, {1, 0, 0}, {0, 1, 0}, {kNan, 0, 0}, {1, 1, 0}};
    mesh.triangles = {{0, 2, 3}, {2, 2, 3}, {0, 2, 4}, {2, 5, 3}, {0, 2, 3}};
    const test::Outcome run = test::run_simplify(mesh, copy_options());
    const Mesh& out = run.lods.at(0);
    EXPECT_EQ(out.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
    EXPECT_EQ(out.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}, {0, 1, 2}}));
    EXPECT_EQ(run.report.input.defects.degenerate_triangles, 1U);
    EXPECT_EQ(run.report.input.defects.nonfinite_triangles, 1U);
    EXPECT_EQ(run.report.input.defects.nonfinite_vertices, 1U);
    EXPECT_EQ(run.report.input.triangles, 4U);
    SimplifyOptions strict = copy_options();
    strict.strict = true;
    EXPECT_THROW(test::run_simplify(mesh, strict), FormatError);
}

TEST(Copy, of_nothing_usable_is_refused) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}};
    mesh.triangles = {{0, 1, 1}};
    EXPECT_THROW(test::run_simplify(mesh, copy_options()), FormatError);
}

TEST(Copy, tells_the_topology_of_what_went_out) {
    const Mesh mesh = test::joined(test::torus(12, 8), test::plane_grid(4));
    const test::Outcome run = test::run_simplify(mesh, copy_options());
    const TopologyReport& t = run.report.lods.at(0).topology;
    EXPECT_EQ(t.components, 2U);
    EXPECT_EQ(t.border_edges, 16U);
    EXPECT_EQ(t.euler, 1);
}

std::string content_of(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
}

class CopiedFile : public ::testing::TestWithParam<const char*> {};

/// Closed surfaces of 3,072 triangles, in a file of the kind.
std::filesystem::path write_input(const test::TempDir& dir, bool is_soup) {
    const Mesh mesh = test::shuffled(test::cube_sphere(16), 3);
    if (!is_soup) {
        test::PlyMesh ply;
        ply.positions.assign(mesh.positions.begin(), mesh.positions.end());
        for (const Triangle& t : mesh.triangles) {
            ply.faces.push_back({static_cast<std::int64_t>(t[0]), static_cast<std::int64_t>(t[1]),
                                 static_cast<std::int64_t>(t[2])});
        }
        return dir.write("in.ply", test::ply_file(ply));
    }
    std::vector<std::array<std::array<double, 3>, 3>> soup;
    for (const Triangle& t : mesh.triangles) {
        soup.push_back({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
    }
    return dir.write("in.stl", test::stl_file(soup, static_cast<std::uint32_t>(soup.size())));
}

TEST_P(CopiedFile, is_the_same_for_any_memory_and_threads) {
    for (const bool is_soup : {false, true}) {
        const test::TempDir dir;
        const std::filesystem::path in = write_input(dir, is_soup);
        const std::filesystem::path out = dir.path() / (std::string("out.") + GetParam());
        std::string first;
        for (const unsigned n_threads : {1U, 3U}) {
            for (const bool is_tight : {false, true}) {
                SimplifyOptions options = copy_options();
                options.n_threads = n_threads;
                // Less than four times the vertices, so that their places are joined by sorting.
                if (is_tight) {
                    options.tuning.sort_bytes = 1 << 14;
                    options.tuning.page_bytes = 1 << 14;
                    options.tuning.spills_at_once = true;
                    options.tuning.window_vertices = 1;
                }
                const SimplifyReport report = simplify_file(in, out, options, {}, true);
                EXPECT_EQ(report.lods.at(0).triangles, 12U * 16 * 16);
                EXPECT_TRUE(report.lods.at(0).topology.border_edges == 0);
                if (first.empty()) first = content_of(out);
                EXPECT_EQ(content_of(out), first) << n_threads << is_tight;
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(To, CopiedFile, ::testing::Values("ply", "stl"));

}  // namespace
}  // namespace hewer
