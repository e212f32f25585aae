// SPDX-License-Identifier: MIT
/// One result for any number of threads, any sufficient memory limit and any way in which a source
/// cuts its batches; a limit that is not sufficient is refused.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "tests/support/batch_source.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

constexpr std::uint64_t kMiB = 1 << 20;

const std::vector<BatchPlan> plans_to_try{{.smallest = 100'000'000, .largest = 100'000'000},
                                          {.smallest = 1, .largest = 50},
                                          {.seed = 5, .smallest = 1, .largest = 3000},
                                          {.seed = 6, .smallest = 500, .largest = 500}};

/// The same hash for everything that must not matter.
void expect_one_result(const Mesh& mesh, SimplifyOptions options, bool is_soup,
                       const std::string& name) {
    options.memory_bytes = 2048 * kMiB;
    options.n_threads = 1;
    BatchPlan plain;
    plain.is_soup = is_soup;
    BatchSource source(mesh, plain);
    const Outcome expected = run_simplify(source, options);
    ASSERT_FALSE(expected.report.result_hash.empty());
    for (const unsigned n_threads : {1U, 2U, 8U}) {
        for (const std::uint64_t memory : {200 * kMiB, 2048 * kMiB}) {
            for (BatchPlan plan : plans_to_try) {
                plan.is_soup = is_soup;
                BatchSource batches(mesh, plan);
                options.n_threads = n_threads;
                options.memory_bytes = memory;
                const Outcome run = run_simplify(batches, options);
                EXPECT_EQ(run.report.result_hash, expected.report.result_hash)
                    << name << ": " << n_threads << " threads, " << memory << " bytes, plan "
                    << plan.seed << ' ' << plan.largest;
                EXPECT_EQ(run.report.input.area, expected.report.input.area) << name;
                EXPECT_EQ(run.lods.back().triangles, expected.lods.back().triangles) << name;
                EXPECT_EQ(run.lods.back().positions, expected.lods.back().positions) << name;
                EXPECT_EQ(run.lods.back().colors, expected.lods.back().colors) << name;
            }
        }
    }
}

Mesh dirty_mesh() {
    Mesh mesh =
        joined(with_turned_triangles(cube_sphere(30, 0.05, 2), 0.1, 3), random_soup(200, 1500, 4));
    return mesh;
}

}  // namespace

TEST(Determinism, RefinedClosedMesh) {
    expect_one_result(cube_sphere(75, 0.01), options_for(Target::Kind::Triangles, 5000), false,
                      "sphere");
}

TEST(Determinism, SoupOfTriangles) {
    expect_one_result(torus(200, 80), options_for(Target::Kind::Triangles, 2000), true, "soup");
}

TEST(Determinism, ColouredMeshInSeveralLevels) {
    SimplifyOptions options;
    for (const double n : {4000.0, 800.0, 50.0}) {
        options.targets.push_back({Target::Kind::Triangles, n});
    }
    expect_one_result(with_colors(cube_sphere(60, 0.02)), options, false, "levels");
}

TEST(Determinism, WeightsOfAttributesVerticesAndPlaces) {
    Mesh mesh = with_colors(cube_sphere(60, 0.02));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        mesh.weights.push_back(static_cast<float>(v % 7) * 0.3F);
    }
    SimplifyOptions options = options_for(Target::Kind::Triangles, 4000);
    options.color_weight = 0.5;
    options.focus = {{{{0, 0, 0}, {1, 1, 1}}, 10}};
    expect_one_result(mesh, options, false, "weights");
}

TEST(Determinism, NonManifoldMesh) {
    expect_one_result(dirty_mesh(), options_for(Target::Kind::Ratio, 0.2), false, "dirty");
}

TEST(Determinism, ErrorBound) {
    expect_one_result(plane_grid(120, 0.003), options_for(Target::Kind::RelativeError, 0.01), false,
                      "error bound");
}

TEST(Determinism, UniformMethod) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, 3000);
    options.method = Method::Uniform;
    expect_one_result(cube_sphere(70, 0.01), options, false, "uniform");
}

TEST(Determinism, FullMethod) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, 3000);
    options.method = Method::Full;
    expect_one_result(many_spheres(3, 12), options, false, "full");
}

TEST(Determinism, NormalVariation) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, 1000);
    options.priority = SplitPriority::NormalVariation;
    expect_one_result(torus(160, 70), options, false, "normal variation");
}

TEST(Determinism, OtherTargetsGiveOtherResults) {
    const Mesh mesh = cube_sphere(20, 0.02);
    EXPECT_NE(run_simplify(mesh, options_for(Target::Kind::Triangles, 500)).report.result_hash,
              run_simplify(mesh, options_for(Target::Kind::Triangles, 502)).report.result_hash);
}

TEST(MemoryLimit, TooLittleIsRefusedAndTheOptionNamed) {
    const Mesh mesh = cube_sphere(150);
    for (const Method method : {Method::Refine, Method::Uniform, Method::Full}) {
        for (const unsigned n_threads : {1U, 8U}) {
            SimplifyOptions options = options_for(Target::Kind::Triangles, 50'000);
            options.method = method;
            options.n_threads = n_threads;
            options.memory_bytes = 18 * kMiB;
            try {
                run_simplify(mesh, options);
                ADD_FAILURE() << "18 MiB were enough";
            } catch (const OutOfMemoryBudget& error) {
                EXPECT_NE(std::string(error.what()).find("--memory"), std::string::npos)
                    << error.what();
            }
        }
    }
}

TEST(MemoryLimit, IsNotPassedByTheBudget) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, 20'000);
    options.memory_bytes = 200 * kMiB;
    const Outcome run = run_simplify(cube_sphere(100, 0.01), options);
    EXPECT_LE(run.report.peak_budget_bytes, options.memory_bytes);
    EXPECT_GT(run.report.peak_budget_bytes, 20 * kMiB);
    EXPECT_EQ(run.report.options.memory_bytes, options.memory_bytes);
}

}  // namespace hewer::test
