// SPDX-License-Identifier: MIT
/// Targets are met: never passed, and used up where the input has enough.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

struct NamedMesh {
    std::string name;
    Mesh mesh;
};

std::vector<NamedMesh> closed_meshes() {
    std::vector<NamedMesh> meshes;
    meshes.push_back({"smooth sphere", cube_sphere(20)});
    meshes.push_back({"noisy sphere", cube_sphere(30, 0.05, 3)});
    meshes.push_back({"torus", torus(80, 40)});
    meshes.push_back({"cube", cube(16)});
    meshes.push_back({"thin slab", scaled(cube_sphere(24, 0.02, 5), {1, 1, 0.01})});
    meshes.push_back({"shuffled sphere", shuffled(cube_sphere(25, 0.02, 7), 9)});
    return meshes;
}

std::vector<NamedMesh> all_meshes() {
    std::vector<NamedMesh> meshes = closed_meshes();
    meshes.push_back({"noisy plane", plane_grid(60, 0.01, 2)});
    meshes.push_back({"two sheets", two_sheets(40, 0.001)});
    meshes.push_back({"spheres", many_spheres(3, 6)});
    meshes.push_back({"book", book(5, 20)});
    meshes.push_back({"moebius strip", moebius_strip(150, 15)});
    meshes.push_back({"turned triangles", with_turned_triangles(cube_sphere(25, 0.02, 4), 0.3, 6)});
    return meshes;
}

}  // namespace

TEST(Budget, TrianglesStayBelowTheTargetAndUseItUp) {
    for (const auto& [name, mesh] : all_meshes()) {
        for (const double target : {200.0, 777.0, 2000.0}) {
            const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, target));
            const auto n = static_cast<double>(run.lods[0].triangles.size());
            EXPECT_LE(n, target) << name;
            EXPECT_GE(n, 0.99 * target) << name;
            EXPECT_EQ(run.report.lods[0].triangles, run.lods[0].triangles.size()) << name;
            EXPECT_EQ(run.report.lods[0].target_triangles, target) << name;
        }
    }
}

TEST(Budget, TinyTargetsAreNeverPassedAndNeverEmpty) {
    for (const auto& [name, mesh] : all_meshes()) {
        for (const double target : {4.0, 10.0, 50.0}) {
            const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, target));
            const auto n = static_cast<double>(run.lods[0].triangles.size());
            EXPECT_LE(n, target) << name;
            EXPECT_GE(n, 1) << name << ", " << target;
        }
    }
}

TEST(Budget, ClosedMeshesReachATetrahedron) {
    for (const double target : {4.0, 10.0, 50.0}) {
        const Outcome run =
            run_simplify(cube_sphere(20, 0.02), options_for(Target::Kind::Triangles, target));
        EXPECT_EQ(run.lods[0].triangles.size(), target);
        EXPECT_TRUE(count(run.lods[0]).is_closed());
    }
}

TEST(Budget, VerticesStayBelowTheTargetAndUseItUp) {
    for (const auto& [name, mesh] : all_meshes()) {
        for (const double target : {150.0, 501.0}) {
            const Outcome run = run_simplify(mesh, options_for(Target::Kind::Vertices, target));
            const auto n = static_cast<double>(run.lods[0].positions.size());
            EXPECT_LE(n, target) << name;
            EXPECT_GE(n, 0.99 * target) << name;
        }
    }
}

TEST(Budget, RatiosAreOfTheTrianglesOfTheInput) {
    for (const auto& [name, mesh] : all_meshes()) {
        for (const double target : {0.1, 0.4}) {
            const Outcome run = run_simplify(mesh, options_for(Target::Kind::Ratio, target));
            const auto n = static_cast<double>(run.lods[0].triangles.size());
            const double most = target * static_cast<double>(mesh.triangles.size());
            EXPECT_LE(n, std::floor(most + 1e-6)) << name;
            EXPECT_GE(n, std::floor(0.99 * most)) << name;
        }
    }
}

TEST(Budget, TenPercentOfAThousandIsAHundred) {
    Mesh mesh = cube_sphere(10, 0.01);
    mesh.triangles.resize(1000);
    const Outcome run = run_simplify(mesh, options_for(Target::Kind::Ratio, 0.1));
    EXPECT_EQ(run.report.lods[0].target_triangles, 100U);
}

TEST(Budget, TheFullMethodMeetsItToo) {
    for (const auto& [name, mesh] : all_meshes()) {
        SimplifyOptions options = options_for(Target::Kind::Triangles, 600);
        options.method = Method::Full;
        const Outcome run = run_simplify(mesh, options);
        EXPECT_LE(run.lods[0].triangles.size(), 600U) << name;
        EXPECT_GE(run.lods[0].triangles.size(), 594U) << name;
    }
}

TEST(Budget, NormalVariationMeetsItToo) {
    for (const auto& [name, mesh] : all_meshes()) {
        SimplifyOptions options = options_for(Target::Kind::Triangles, 600);
        options.priority = SplitPriority::NormalVariation;
        const Outcome run = run_simplify(mesh, options);
        EXPECT_LE(run.lods[0].triangles.size(), 600U) << name;
        EXPECT_GE(run.lods[0].triangles.size(), 594U) << name;
    }
}

TEST(Budget, TheUniformMethodMeetsItToo) {
    for (const auto& [name, mesh] :
         {std::pair{"sphere", cube_sphere(100, 0.005)}, std::pair{"torus", torus(300, 120)},
          std::pair{"plane", plane_grid(200, 0.002)}}) {
        for (const double target : {500.0, 5000.0}) {
            SimplifyOptions options = options_for(Target::Kind::Triangles, target);
            options.method = Method::Uniform;
            const Outcome run = run_simplify(mesh, options);
            const auto n = static_cast<double>(run.lods[0].triangles.size());
            EXPECT_LE(n, target) << name;
            EXPECT_GE(n, 0.99 * target) << name;
            const Counts counts = count(run.lods[0]);
            EXPECT_TRUE(counts.is_clean()) << name << ", " << target;
            EXPECT_EQ(counts.is_closed(), count(mesh).is_closed()) << name << ", " << target;
        }
    }
}

TEST(Budget, ATargetAboveTheInputKeepsTheSurface) {
    const Mesh mesh = cube_sphere(12, 0.02);
    const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, 1e6));
    EXPECT_EQ(run.lods[0].triangles.size(), mesh.triangles.size());
    EXPECT_EQ(run.lods[0].positions.size(), mesh.positions.size());
    EXPECT_NEAR(area(run.lods[0]), area(mesh), 1e-6 * area(mesh));
}

TEST(Surface, ClosedStaysClosedAndClean) {
    for (const auto& [name, mesh] : closed_meshes()) {
        for (const double target : {20.0, 150.0, 1201.0, 3000.0}) {
            const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, target));
            const Counts counts = count(run.lods[0]);
            EXPECT_TRUE(counts.is_closed()) << name << ", " << target;
            EXPECT_TRUE(counts.is_clean()) << name << ", " << target;
            EXPECT_EQ(counts.unlike_edges, 0U) << name << ", " << target;
        }
    }
}

TEST(Surface, OutputIsManifoldEvenWhereTheInputIsNot) {
    std::vector<NamedMesh> meshes = all_meshes();
    meshes.push_back({"random triangles", random_soup(300, 2000, 5)});
    meshes.push_back({"few vertices", random_soup(12, 500, 6)});
    for (const auto& [name, mesh] : meshes) {
        const Outcome run = run_simplify(mesh, options_for(Target::Kind::Ratio, 0.2));
        const Counts counts = count(run.lods[0]);
        EXPECT_TRUE(counts.is_clean())
            << name << ": " << counts.nonmanifold_edges << ' ' << counts.degenerate << ' '
            << counts.duplicates << ' ' << counts.unreferenced << ' ' << counts.split_fans;
        EXPECT_EQ(counts.border_edges, run.report.lods[0].topology.border_edges) << name;
        EXPECT_EQ(counts.euler, run.report.lods[0].topology.euler) << name;
    }
}

TEST(Surface, TheEulerCharacteristicIsKept) {
    EXPECT_EQ(count(run_simplify(torus(200, 80), options_for(Target::Kind::Triangles, 300)).lods[0])
                  .euler,
              0);
    EXPECT_EQ(
        count(
            run_simplify(cube_sphere(40, 0.01), options_for(Target::Kind::Triangles, 300)).lods[0])
            .euler,
        2);
}

TEST(Surface, AFlatOutlineStays) {
    const Outcome run = run_simplify(plane_grid(80), options_for(Target::Kind::Triangles, 300));
    // Border lines are summed in 2^-8 cells.
    const double step = run.report.grid.cell_size / 128;
    const Bounds bounds = bounds_of(run.lods[0]);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(bounds.min[i], 0, step);
        EXPECT_NEAR(bounds.max[i], 1, step);
    }
    // Seen from above; any cut corner would be missing.
    double covered = 0;
    for (const Triangle& t : run.lods[0].triangles) covered += cross_of(run.lods[0], t)[2] / 2;
    EXPECT_NEAR(covered, 1, 4 * step);
}

TEST(Surface, BorderWeightHoldsARoughOutline) {
    const Mesh mesh = plane_grid(80, 0.004);
    std::vector<double> lost;
    for (const double weight : {0.0, 1.0, 100.0}) {
        SimplifyOptions options = options_for(Target::Kind::Triangles, 300);
        options.border_weight = weight;
        const Outcome run = run_simplify(mesh, options);
        double covered = 0;
        for (const Triangle& t : run.lods[0].triangles) covered += cross_of(run.lods[0], t)[2] / 2;
        lost.push_back(std::abs(1 - covered));
    }
    EXPECT_GT(lost[0], lost[1]);
    EXPECT_GT(lost[1], lost[2]);
    EXPECT_LT(lost[1], 0.03);
    EXPECT_LT(lost[2], 0.01);
}

TEST(Surface, SeparateSpheresAreNotJoined) {
    const Outcome run =
        run_simplify(many_spheres(3, 10), options_for(Target::Kind::Triangles, 1000));
    EXPECT_EQ(run.report.lods[0].topology.components, 27U);
    EXPECT_EQ(count(run.lods[0]).euler, 54);
}

TEST(Surface, SheetsNearEachOtherAreNotJoined) {
    const Outcome run =
        run_simplify(two_sheets(60, 0.02), options_for(Target::Kind::Triangles, 500));
    EXPECT_EQ(run.report.lods[0].topology.components, 2U);
    const double step = run.report.grid.cell_size / 256;  // of the border sums
    for (const Vec3& p : run.lods[0].positions) {
        EXPECT_TRUE(std::abs(p[2]) < step || std::abs(p[2] - 0.02) < step) << p[2];
    }
}

}  // namespace hewer::test
