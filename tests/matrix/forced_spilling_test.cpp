// SPDX-License-Identifier: MIT
/// One result for every way in which data may go to disk: tiny pages, tables, windows, sorted runs,
/// the least memory and plenty, one thread and more than there are.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "hewer/error.h"
#include "hewer/mesh_sink.h"
#include "rsimp/memory_model.h"
#include "tests/support/batch_source.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_dir.h"

namespace hewer::test {

namespace {

/// The collapse goes in blocks of 2^15 vertices, of which this surface fills more than one; the
/// half without a lid has borders.
Mesh surface() {
    return joined(cube_sphere(66, 0.01), translated(plane_grid(100, 0.004), {2, 0, 0}));
}

void write_mesh(const Mesh& mesh, const std::filesystem::path& path) {
    const auto sink = create_mesh_file(path);
    SinkHeader header;
    header.n_vertices = mesh.positions.size();
    header.n_triangles = mesh.triangles.size();
    for (const Vec3& p : mesh.positions) header.bounds.extend(p);
    sink->begin(header);
    sink->add_vertices({mesh.positions, {}, {}});
    sink->add_triangles(mesh.triangles);
    sink->finish();
}

enum class Input {
    Coherent,         ///< PLY, vertices can be sought
    Shuffled,         ///< the same in no order
    Soup,             ///< STL
    ColoredInMemory,  ///< in no order, with attributes, and vertices that cannot be sought
    Weighed           ///< the same with weights, which the attributes have, too
};
enum class Goal { One, Levels, Error };
using Case = std::tuple<Input, Method, Goal>;

/// The input of a case, and sources of it.
class Source {
  public:
    explicit Source(Input input) : input_(input) {
        switch (input) {
            case Input::Coherent:
                write_mesh(surface(), path_);
                break;
            case Input::Shuffled:
                write_mesh(shuffled(surface(), 5), path_);
                break;
            case Input::Soup:
                path_ = folder_.path() / "mesh.stl";
                write_mesh(surface(), path_);
                break;
            case Input::ColoredInMemory:
                mesh_ = with_colors(shuffled(surface(), 7));
                break;
            case Input::Weighed:
                mesh_ = with_colors(shuffled(surface(), 7));
                for (std::size_t v = 0; v < mesh_.positions.size(); ++v) {
                    mesh_.weights.push_back(static_cast<float>(v % 5) * 0.7F);
                }
                break;
        }
    }
    [[nodiscard]] std::unique_ptr<MeshSource> open() const {
        if (mesh_.positions.empty()) return open_mesh(path_);
        return std::make_unique<BatchSource>(mesh_, BatchPlan{.smallest = 1, .largest = 2000});
    }

  private:
    Input input_;
    TempDir folder_;
    std::filesystem::path path_ = folder_.path() / "mesh.ply";
    Mesh mesh_;
};

SimplifyOptions options_of(const Case& test) {
    SimplifyOptions options;
    options.method = std::get<Method>(test);
    if (std::get<Input>(test) == Input::Weighed) {
        if (options.method != Method::Uniform) options.color_weight = 0.5;
        options.focus = {{{{0, 0, 0}, {1, 1, 1}}, 10}};
    }
    switch (std::get<Goal>(test)) {
        case Goal::One:
            options.targets = {{Target::Kind::Triangles, 50'000}};
            break;
        case Goal::Levels:
            options.targets = {{Target::Kind::Triangles, 56'000},
                               {Target::Kind::Triangles, 6'000},
                               {Target::Kind::Triangles, 300}};
            break;
        case Goal::Error:
            options.targets = {{Target::Kind::RelativeError, 0.004}};
            break;
    }
    return options;
}

/// A way to run it.
struct Way {
    bool has_tiny_pages = false;  // and all of them on disk
    bool has_tiny_table = false;
    bool has_tiny_window = false;
    bool has_tiny_runs = false;
    bool has_least_memory = false;
    unsigned n_threads = 1;
};

std::ostream& operator<<(std::ostream& out, const Way& way) {
    return out << (way.has_tiny_pages ? "tiny pages, " : "")
               << (way.has_tiny_table ? "tiny table, " : "")
               << (way.has_tiny_window ? "tiny window, " : "")
               << (way.has_tiny_runs ? "tiny runs, " : "")
               << (way.has_least_memory ? "least memory, " : "ample memory, ") << way.n_threads
               << " threads";
}

SimplifyReport run(const Source& source, SimplifyOptions options, const Way& way) {
    const auto input = source.open();
    options.n_threads = way.n_threads;
    if (way.has_tiny_pages) {
        options.tuning.page_bytes = 4096;
        options.tuning.spills_at_once = true;
    }
    if (way.has_tiny_table) options.tuning.table_cells = 8000;
    if (way.has_tiny_window) options.tuning.window_vertices = 1024;
    if (way.has_tiny_runs) options.tuning.sort_bytes = 2048;
    options.memory_bytes =
        way.has_least_memory ? rsimp::least_limit(options, input->info()) : std::uint64_t{4} << 30;
    return run_simplify(*input, options).report;
}

void expect_one_result(const Case& test, const std::vector<Way>& ways) {
    const Source source(std::get<Input>(test));
    const SimplifyOptions options = options_of(test);
    const SimplifyReport expected = run(source, options, {});
    ASSERT_FALSE(expected.result_hash.empty());
    bool has_spilled = false;
    for (const Way& way : ways) {
        SCOPED_TRACE(testing::Message() << way);
        const SimplifyReport report = run(source, options, way);
        EXPECT_EQ(report.result_hash, expected.result_hash);
        EXPECT_EQ(report.grid.occupied_cells, expected.grid.occupied_cells);
        EXPECT_EQ(report.grid.surviving_triangles, expected.grid.surviving_triangles);
        EXPECT_EQ(report.input.area, expected.input.area);
        EXPECT_LE(report.peak_budget_bytes, report.options.memory_bytes);
        has_spilled |= report.temp_bytes_written > 0;
    }
    EXPECT_TRUE(has_spilled);
}

class ForcedSpilling : public testing::TestWithParam<Case> {};
class EveryWay : public testing::TestWithParam<Case> {};

std::string name_of(const testing::TestParamInfo<Case>& test) {
    constexpr std::array<const char*, 5> kInputs{"coherent", "shuffled", "soup", "colored",
                                                 "weighed"};
    constexpr std::array<const char*, 3> kMethods{"refine", "uniform", "full"};
    constexpr std::array<const char*, 3> kGoals{"one", "levels", "error"};
    const auto& [input, method, goal] = test.param;
    return std::string(kInputs.at(static_cast<std::size_t>(input))) + '_' +
           kMethods.at(static_cast<std::size_t>(method)) + '_' +
           kGoals.at(static_cast<std::size_t>(goal));
}

}  // namespace

TEST_P(ForcedSpilling, ChangesNothing) {
    expect_one_result(GetParam(),
                      {{.has_tiny_pages = true,
                        .has_tiny_table = true,
                        .has_tiny_window = true,
                        .has_tiny_runs = true,
                        .has_least_memory = true,
                        .n_threads = 8},
                       {.has_tiny_pages = true, .has_tiny_window = true, .has_least_memory = true},
                       {.has_tiny_table = true, .has_tiny_runs = true, .n_threads = 2}});
}

TEST_P(EveryWay, LeadsToOneResult) {
    std::vector<Way> ways;
    for (unsigned choice = 0; choice < 32; ++choice) {
        constexpr std::array<unsigned, 3> kThreads{1, 2, 8};
        ways.push_back({.has_tiny_pages = (choice & 1U) != 0,
                        .has_tiny_table = (choice & 2U) != 0,
                        .has_tiny_window = (choice & 4U) != 0,
                        .has_tiny_runs = (choice & 8U) != 0,
                        .has_least_memory = (choice & 16U) != 0,
                        .n_threads = kThreads.at(choice % 3)});
    }
    expect_one_result(GetParam(), ways);
}

/// The uniform method has one goal only.
std::vector<Case> all_cases() {
    std::vector<Case> cases;
    for (const Input input :
         {Input::Coherent, Input::Shuffled, Input::Soup, Input::ColoredInMemory}) {
        for (const Method method : {Method::Refine, Method::Full}) {
            for (const Goal goal : {Goal::One, Goal::Levels, Goal::Error}) {
                cases.emplace_back(input, method, goal);
            }
        }
        cases.emplace_back(input, Method::Uniform, Goal::One);
    }
    cases.emplace_back(Input::Weighed, Method::Refine, Goal::Levels);
    cases.emplace_back(Input::Weighed, Method::Refine, Goal::Error);
    cases.emplace_back(Input::Weighed, Method::Full, Goal::One);
    cases.emplace_back(Input::Weighed, Method::Uniform, Goal::One);
    return cases;
}

INSTANTIATE_TEST_SUITE_P(Matrix, ForcedSpilling, testing::ValuesIn(all_cases()), name_of);
INSTANTIATE_TEST_SUITE_P(slow, EveryWay, testing::ValuesIn(all_cases()), name_of);

}  // namespace hewer::test
