// SPDX-License-Identifier: MIT
/// Distances that are promised are those that somebody else measures.
#include "hewer/certify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "hewer/error.h"
#include "hewer/measure.h"
#include "hewer/mesh_sink.h"
#include "hewer/within.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/read_back.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_dir.h"

namespace hewer {

namespace {

class Certify : public testing::Test {
  protected:
    [[nodiscard]] std::filesystem::path file(const char* name) const {
        return folder_.path() / name;
    }
    std::filesystem::path write(const Mesh& mesh) const {
        std::filesystem::path path = file("in.ply");
        const auto sink = create_mesh_file(path);
        SinkHeader header;
        header.n_vertices = mesh.positions.size();
        header.n_triangles = mesh.triangles.size();
        header.bounds = Bounds{{-2, -2, -2}, {2, 2, 2}};
        sink->begin(header);
        sink->add_vertices({mesh.positions, {}, {}});
        sink->add_triangles(mesh.triangles);
        sink->finish();
        return path;
    }
    static SimplifyOptions within(double distance) {
        SimplifyOptions options;
        options.targets = {{Target::Kind::RelativeError, distance}};
        options.n_threads = 2;
        options.memory_bytes = 1ULL << 30;
        return options;
    }
    static double larger(const MeasureReport& r) {
        return std::max(r.forward.maximum, r.backward.maximum);
    }
    static double measured(const std::filesystem::path& a, const std::filesystem::path& b) {
        const MeasureReport r = measure_files(a, b);
        return std::max(r.forward.maximum, r.backward.maximum);
    }

    test::TempDir folder_;
};

}  // namespace

TEST_F(Certify, DistanceThatIsAskedForIsKeptAndTighterOnesTakeMore) {
    const auto input = write(test::cube_sphere(30, 0.02, 3));
    std::uint64_t coarser = 0;
    for (const double distance : {0.03, 0.006}) {
        const auto output = file("out.ply");
        const SimplifyReport report =
            simplify_to_distance(input, output, within(distance), {}, true);
        const double bound = distance * measure_files(input, output).bounds.diagonal();
        EXPECT_LE(measured(input, output), bound);
        ASSERT_EQ(report.lods.size(), 1U);
        const LodReport& lod = report.lods[0];
        ASSERT_TRUE(lod.measured);
        EXPECT_LE(lod.measured->forward.maximum, bound);
        EXPECT_LE(lod.measured->backward.maximum, bound);
        EXPECT_NEAR(lod.proven_within, bound, 1e-9 * bound);
        const auto original = open_mesh(input);
        EXPECT_EQ(prove_within(*original, *open_mesh(output), bound).verdict,
                  WithinReport::Verdict::Proven);
        EXPECT_GT(lod.triangles, coarser);
        coarser = lod.triangles;
        // One of the tries with fewer triangles was too far: nothing was given away.
        EXPECT_TRUE(std::any_of(report.search.begin(), report.search.end(), [&](const auto& t) {
            return t.triangles < lod.triangles && t.distance > 0.99 * bound;
        }));
        EXPECT_EQ(open_mesh(output)->info().n_faces, lod.triangles);
    }
}

TEST_F(Certify, AFewPlacesDoNotDecideTheBudget) {
    // A smooth body with some sharp pits.
    Mesh mesh = test::cube_sphere(40);
    for (std::size_t i = 0; i < mesh.positions.size(); i += 1500) {
        for (double& x : mesh.positions[i]) x *= 0.93;
    }
    const auto input = write(mesh);
    const SimplifyReport report = simplify_to_distance(input, file("out.ply"), within(0.004));
    EXPECT_LE(measured(input, file("out.ply")),
              0.004 * measure_files(input, input).bounds.diagonal());
    // A budget that failed was tried again, with more of it for these places.
    bool is_repeated = false;
    for (std::size_t i = 1; i < report.search.size(); ++i) {
        const auto before = static_cast<double>(report.search[i - 1].triangles);
        const auto now = static_cast<double>(report.search[i].triangles);
        is_repeated |= std::abs(now - before) <= 0.01 * before;
    }
    EXPECT_TRUE(is_repeated);
}

TEST_F(Certify, ReportIsOfTheRepairedFile) {
    // Pits at which a first run fails, in a surface with a border.
    Mesh mesh = test::plane_grid(60);
    for (std::size_t i = 700; i < mesh.positions.size(); i += 900) mesh.positions[i][2] = -0.03;
    const auto input = write(mesh);
    const auto output = file("out.ply");
    const SimplifyReport report = simplify_to_distance(input, output, within(0.004));
    const LodReport& lod = report.lods.at(0);
    // Rounds of repairs change the mesh by a few triangles.
    bool is_repaired = false;
    for (std::size_t i = 1; i < report.search.size(); ++i) {
        const std::uint64_t before = report.search[i - 1].triangles;
        const std::uint64_t now = report.search[i].triangles;
        is_repaired |= now >= before && now < before + before / 10 && lod.triangles >= now;
    }
    EXPECT_TRUE(is_repaired);
    const test::ReadBack back = test::read_all(*open_mesh(output));
    EXPECT_EQ(lod.triangles, back.mesh.triangles.size());
    EXPECT_EQ(lod.vertices, back.mesh.positions.size());
    const test::Counts counts = test::count(back.mesh);
    EXPECT_EQ(lod.topology.border_edges, counts.border_edges);
    EXPECT_TRUE(counts.is_clean());
    const Bounds bounds = test::bounds_of(back.mesh);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(lod.bounds.min[k], bounds.min[k], 1e-6);
        EXPECT_NEAR(lod.bounds.max[k], bounds.max[k], 1e-6);
    }
}

TEST_F(Certify, ModelUnitsMeanTheSame) {
    const auto input = write(test::torus(60, 30));
    const auto output = file("out.ply");
    SimplifyOptions options = within(0);
    options.targets = {{Target::Kind::Error, 0.02}};
    simplify_to_distance(input, output, options);
    EXPECT_LE(measured(input, output), 0.02);
}

TEST_F(Certify, SameBytesForAnyNumberOfThreads) {
    const auto input = write(test::cube_sphere(16, 0.02, 5));
    SimplifyOptions options = within(0.01);
    std::string hash;
    for (const unsigned n_threads : {1U, 8U}) {
        options.n_threads = n_threads;
        const SimplifyReport report =
            simplify_to_distance(input, file("out.ply"), options, {}, true);
        if (hash.empty()) hash = report.result_hash;
        EXPECT_EQ(report.result_hash, hash);
    }
}

TEST_F(Certify, SaysOnceWhatThereIsToWarnOf) {
    const Mesh mesh = test::cube_sphere(12);
    const auto input = file("in.ply");
    std::ofstream out(input);
    out << "ply\nformat ascii 1.0\nelement vertex " << mesh.positions.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nproperty float confidence\n"
        << "element face " << mesh.triangles.size()
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Vec3& p : mesh.positions) {
        out << p[0] << ' ' << p[1] << ' ' << p[2] << " 1\n";
    }
    for (const Triangle& t : mesh.triangles) {
        out << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
    }
    out.close();
    std::vector<std::string> warnings;
    Hooks hooks;
    hooks.on_warning = [&](const std::string& text) { warnings.push_back(text); };
    const SimplifyReport report = simplify_to_distance(input, file("out.ply"), within(0.03), hooks);
    EXPECT_GT(report.search.size(), 1U);
    EXPECT_EQ(warnings.size(), 1U);
}

TEST_F(Certify, LevelsComeWithWhatMeasureSaysOfThem) {
    const auto input = write(test::cube_sphere(20, 0.02));
    SimplifyOptions options = within(0);
    options.targets = {{Target::Kind::Triangles, 2000}, {Target::Kind::Triangles, 300}};
    const SimplifyReport report = simplify_and_measure(input, file("out.ply"), options);
    ASSERT_EQ(report.lods.size(), 2U);
    for (const LodReport& lod : report.lods) {
        ASSERT_TRUE(lod.measured);
        const MeasureReport again = measure_files(input, lod.path);
        EXPECT_EQ(lod.measured->forward.rms, again.forward.rms);
        EXPECT_EQ(lod.measured->backward.maximum, again.backward.maximum);
    }
}

TEST_F(Certify, RefusesBeforeAnyWork) {
    const auto input = write(test::cube_sphere(10));
    SimplifyOptions options = within(0.01);
    options.targets.push_back(options.targets[0]);
    EXPECT_THROW(simplify_to_distance(input, file("out.ply"), options), InvalidArgument);
    options.targets = {{Target::Kind::Triangles, 100}};
    EXPECT_THROW(simplify_to_distance(input, file("out.ply"), options), InvalidArgument);
    options = within(0.01);
    options.file.quantization = {Quantization::Kind::Auto, 0};
    EXPECT_THROW(simplify_to_distance(input, file("out.glb"), options), InvalidArgument);
    EXPECT_THROW(simplify_to_distance(input, file("absent") / "out.ply", within(0.01)), IoError);
    EXPECT_FALSE(std::filesystem::exists(file("out.ply")));
    EXPECT_FALSE(std::filesystem::exists(file("out.glb")));
}

TEST_F(Certify, MeasuresWhatTheFileHolds) {
    const auto input = write(test::cube_sphere(20));
    SimplifyOptions options = within(0.01);
    options.targets = {{Target::Kind::Triangles, 600}};
    const double exact =
        larger(*simplify_and_measure(input, file("a.glb"), options).lods[0].measured);
    options.file.quantization = {Quantization::Kind::Bits, 5};
    const SimplifyReport coarse = simplify_and_measure(input, file("b.drc"), options);
    EXPECT_GT(larger(*coarse.lods[0].measured), 1.2 * exact);
    EXPECT_GT(coarse.lods[0].quantization, 0);
    EXPECT_LE(larger(*coarse.lods[0].measured), exact + coarse.lods[0].quantization);
}

}  // namespace hewer
