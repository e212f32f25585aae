// SPDX-License-Identifier: MIT
#include "hewer/measure.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "hewer/error.h"
#include "measure/lattice.h"
#include "tests/unit/measure/meshes.h"

namespace hewer {
namespace {

using test::plane;
using test::sphere;
using test::translated;

MeasureOptions small_options() {
    MeasureOptions options;
    options.n_samples = 20'000;
    options.memory_bytes = 128 << 20;
    options.n_threads = 2;
    return options;
}

MeasureReport measure_meshes(const Mesh& original, const Mesh& simplified,
                             const MeasureOptions& options = small_options(),
                             const Hooks& hooks = {}) {
    const auto a = view_mesh(original, "original");
    const auto b = view_mesh(simplified, "simplified");
    return measure(*a, *b, options, hooks);
}

/// A triangle soup over a mesh; the library's own soups are files.
class Soup final : public MeshSource {
  public:
    explicit Soup(const Mesh& mesh) : mesh_(mesh) {
        info_.name = "soup";
        info_.is_indexed = false;
        info_.n_faces = mesh.triangles.size();
    }
    [[nodiscard]] const SourceInfo& info() const override { return info_; }
    void begin_vertices() override {}
    bool next_vertices(VertexBatch& /*batch*/) override { return false; }
    void begin_triangles() override { done_ = false; }
    bool next_triangles(TriangleBatch& batch) override {
        if (done_.exchange(true)) return false;
        batch = {};
        batch.n_faces = mesh_.triangles.size();
        for (const Triangle& t : mesh_.triangles) {
            batch.points.push_back(
                {mesh_.positions[t[0]], mesh_.positions[t[1]], mesh_.positions[t[2]]});
        }
        return true;
    }
    [[nodiscard]] std::uint64_t bytes_read() const override { return 0; }

  private:
    const Mesh& mesh_;
    SourceInfo info_;
    std::atomic<bool> done_{false};
};

void expect_equal(const DistanceReport& a, const DistanceReport& b) {
    EXPECT_EQ(a.maximum, b.maximum);
    EXPECT_EQ(a.mean, b.mean);
    EXPECT_EQ(a.rms, b.rms);
    EXPECT_EQ(a.vertex_maximum, b.vertex_maximum);
    EXPECT_EQ(a.vertex_mean, b.vertex_mean);
    EXPECT_EQ(a.vertex_rms, b.vertex_rms);
    EXPECT_EQ(a.n_vertices, b.n_vertices);
    EXPECT_EQ(a.n_samples, b.n_samples);
    ASSERT_EQ(a.worst.size(), b.worst.size());
    for (std::size_t i = 0; i < a.worst.size(); ++i) {
        EXPECT_EQ(a.worst[i].point, b.worst[i].point);
        EXPECT_EQ(a.worst[i].distance, b.worst[i].distance);
    }
    ASSERT_EQ(a.quantiles.size(), b.quantiles.size());
    for (std::size_t i = 0; i < a.quantiles.size(); ++i) {
        EXPECT_EQ(a.quantiles[i].distance, b.quantiles[i].distance);
    }
    ASSERT_EQ(a.histogram.size(), b.histogram.size());
    for (std::size_t i = 0; i < a.histogram.size(); ++i) {
        EXPECT_EQ(a.histogram[i].to, b.histogram[i].to);
        EXPECT_EQ(a.histogram[i].n, b.histogram[i].n);
    }
}

TEST(Lattice, KeepsFloatsExactlyWhateverTheOffset) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> coordinate(-3.0F, 5.0F);
    Bounds bounds;
    std::vector<Vec3> points;
    for (int i = 0; i < 1000; ++i) {
        // 24 bits of a number of this size reach down to 2^-21; the offset is UTM-like.
        points.push_back({std::ldexp(std::round(std::ldexp(coordinate(random), 21)), -21),
                          coordinate(random) + 0.0, 5e6});
        points.back()[1] = std::round(points.back()[1] * 1024) / 1024 + 5e6;
        bounds.extend(points.back());
    }
    const measuring::Lattice lattice(bounds);
    EXPECT_LE(lattice.step(), std::ldexp(8.0, -30));
    for (const Vec3& p : points) {
        EXPECT_EQ(lattice.to_model(measuring::to_double(lattice.from_model(p))), p);
    }
}

TEST(Measure, SurfaceIsAtNoDistanceFromItself) {
    const Mesh mesh = sphere(60, 2.5, {1, 2, 3});
    const MeasureReport report = measure_meshes(mesh, mesh);
    EXPECT_EQ(report.forward.vertex_maximum, 0);
    EXPECT_LT(report.forward.maximum, 1e-13);
    EXPECT_LT(report.backward.rms, 1e-13);
    EXPECT_NEAR(static_cast<double>(report.forward.n_samples), 20'000, 600);
    EXPECT_EQ(report.original_triangles, mesh.triangles.size());
}

TEST(Measure, ParallelPlanesAreTheirDistanceApart) {
    const MeasureReport report = measure_meshes(plane(20, 10, 0), plane(7, 10, 0.25));
    for (const DistanceReport& side : {report.forward, report.backward}) {
        EXPECT_DOUBLE_EQ(side.maximum, 0.25);
        EXPECT_DOUBLE_EQ(side.vertex_mean, 0.25);
        EXPECT_NEAR(side.mean, 0.25, 1e-12);
        EXPECT_NEAR(side.rms, 0.25, 1e-12);
        EXPECT_NEAR(side.vertex_rms, 0.25, 1e-12);
    }
    EXPECT_EQ(report.forward.n_vertices, 21U * 21U);
    EXPECT_EQ(report.backward.n_vertices, 8U * 8U);
    EXPECT_EQ(report.original_triangles, 800U);
    EXPECT_EQ(report.simplified_triangles, 98U);
    EXPECT_EQ(report.bounds.max, (Vec3{10, 10, 0}));
}

TEST(Measure, ConcentricSpheresDifferByTheirRadii) {
    const MeasureReport report = measure_meshes(sphere(400, 1.0), sphere(400, 1.125));
    // The middle of a chord of these meshes lies at most 1.3e-4 below the sphere.
    EXPECT_NEAR(report.forward.rms, 0.125, 2e-4);
    EXPECT_NEAR(report.backward.rms, 0.125, 2e-4);
    EXPECT_NEAR(report.forward.maximum, 0.125, 2e-4);
    EXPECT_NEAR(report.backward.vertex_maximum, 0.125, 2e-4);
}

TEST(Measure, TiltedPlaneHasTheMeanAndRmsOfItsSlope) {
    // Distances grow linearly from 0 to d: mean d/2, rms d/sqrt(3). Samples must be by area:
    // the vertices of this surface crowd at one end.
    Mesh tilted = plane(40, 1, 0);
    for (Vec3& p : tilted.positions) p[0] = p[0] * p[0];
    for (Vec3& p : tilted.positions) p[2] = 0.1 * p[0];
    const Mesh base = plane(1, 1, 0);
    const MeasureReport report = measure_meshes(tilted, base);
    EXPECT_NEAR(report.forward.maximum, 0.1, 1e-9);
    EXPECT_NEAR(report.forward.mean, 0.05, 1e-4);
    EXPECT_NEAR(report.forward.rms, 0.1 / std::sqrt(3.0), 1e-4);
    EXPECT_LT(report.forward.vertex_mean, 0.04);
}

TEST(Measure, SpikeIsSeenFromItsOwnSideOnly) {
    Mesh spiked = plane(10, 10, 0);
    spiked.positions[5 * 11 + 5][2] = 4;
    const MeasureReport report = measure_meshes(spiked, plane(10, 10, 0));
    EXPECT_NEAR(report.forward.maximum, 4, 1e-8);
    EXPECT_NEAR(report.forward.worst[0].point[0], 5, 1e-8);
    EXPECT_NEAR(report.forward.worst[0].point[1], 5, 1e-8);
    EXPECT_NEAR(report.forward.worst[0].point[2], 4, 1e-8);
    EXPECT_LT(report.backward.maximum, 1.0);
    EXPECT_GT(report.backward.maximum, 0.5);
}

TEST(Measure, MaximumIsExactAtVerticesThatNoSampleMeets) {
    // A needle of next to no area.
    Mesh original = plane(10, 10, 0);
    original.positions.push_back({5, 5, 3});
    original.positions.push_back({5 + 1e-6, 5, 0});
    original.triangles.push_back({5 * 11 + 5, 121, 122});
    const MeasureReport report = measure_meshes(original, plane(10, 10, 0));
    EXPECT_NEAR(report.forward.maximum, 3, 1e-8);
    EXPECT_LT(report.forward.rms, 1e-3);
}

TEST(Measure, OffsetOfBothSurfacesChangesNothing) {
    const Mesh a = sphere(80, 50.0);
    const Mesh b = sphere(30, 50.0);
    const Vec3 utm{5e6, 4.5e5, 1200};
    const MeasureReport here = measure_meshes(a, b);
    const MeasureReport there = measure_meshes(translated(a, utm), translated(b, utm));
    // Samples are other ones: triangles are rounded otherwise.
    EXPECT_NEAR(here.forward.rms, there.forward.rms, 1e-4);
    EXPECT_NEAR(here.backward.rms, there.backward.rms, 1e-4);
    EXPECT_NEAR(here.forward.maximum, there.forward.maximum, 1e-6);
    EXPECT_NEAR(here.backward.vertex_mean, there.backward.vertex_mean, 1e-6);
    EXPECT_NEAR(there.forward.worst[0].point[0], utm[0], 51);
}

TEST(Measure, ScaleChangesNothingElse) {
    Mesh a = plane(5, 1, 0);
    Mesh b = plane(5, 1, 0.125);
    for (const double scale : {1e-30, 1e30}) {
        Mesh as = a;
        Mesh bs = b;
        for (Mesh* m : {&as, &bs}) {
            for (Vec3& p : m->positions) {
                for (double& x : p) x *= scale;
            }
        }
        EXPECT_NEAR(measure_meshes(as, bs).forward.rms / scale, 0.125, 1e-8);
    }
}

TEST(Measure, ResultIsTheSameForAnyNumberOfThreads) {
    const Mesh a = sphere(200, 1.0);  // several batches
    const Mesh b = sphere(37, 1.01);
    MeasureOptions options = small_options();
    options.n_threads = 1;
    const MeasureReport one = measure_meshes(a, b, options);
    for (const unsigned n : {2U, 8U}) {
        options.n_threads = n;
        const MeasureReport many = measure_meshes(a, b, options);
        expect_equal(one.forward, many.forward);
        expect_equal(one.backward, many.backward);
    }
}

TEST(Measure, VerticesThatNoFaceUsesDoNotCount) {
    const Mesh clean = plane(10, 1, 0);
    const Mesh other = plane(4, 1, 0.5);
    Mesh stray = clean;
    stray.positions.push_back({1e20, -1e20, 7});
    stray.positions.push_back({0.5, 0.5, 90});
    const MeasureReport expected = measure_meshes(clean, other);
    const MeasureReport report = measure_meshes(stray, other);
    expect_equal(expected.forward, report.forward);
    expect_equal(expected.backward, report.backward);
    EXPECT_EQ(report.bounds.max, (Vec3{1, 1, 0}));
}

TEST(Measure, NonFiniteVerticesAreLeftOutWithTheirTriangles) {
    const Mesh clean = plane(10, 1, 0);
    const Mesh other = plane(4, 1, 0.5);
    Mesh dirty = clean;
    dirty.positions.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
    dirty.positions.push_back({0, std::numeric_limits<double>::infinity(), 0});
    dirty.positions.push_back({0.25, 0.25, 3});  // only a triangle that is left out uses it
    dirty.triangles.push_back({0, 1, 121});
    dirty.triangles.push_back({122, 0, 123});
    const MeasureReport expected = measure_meshes(clean, other);
    const MeasureReport report = measure_meshes(dirty, other);
    EXPECT_EQ(report.original_triangles, clean.triangles.size());
    EXPECT_EQ(report.forward.n_vertices, expected.forward.n_vertices);
    EXPECT_NEAR(report.forward.maximum, expected.forward.maximum, 1e-8);
    EXPECT_NEAR(report.backward.rms, expected.backward.rms, 1e-8);
}

TEST(Measure, DegenerateTrianglesAreTheSegmentsThatTheyAre) {
    Mesh segment;
    segment.positions = {{0, 0, 0}, {1, 0, 0}};
    segment.triangles = {{0, 1, 1}};
    const MeasureReport report = measure_meshes(plane(10, 1, 0), segment);
    EXPECT_NEAR(report.forward.maximum, 1, 1e-8);
    EXPECT_NEAR(report.forward.mean, 0.5, 5e-4);  // distance is y
    EXPECT_EQ(report.backward.maximum, 0);
    EXPECT_EQ(report.backward.n_samples, 0U);
    EXPECT_EQ(report.backward.n_vertices, 2U);
    EXPECT_EQ(report.backward.rms, 0);
}

TEST(Measure, SingleTrianglesAndSinglePointsAreSurfacesToo) {
    Mesh a;
    a.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    a.triangles = {{0, 1, 2}};
    const Mesh b = translated(a, {0, 0, -2});
    EXPECT_NEAR(measure_meshes(a, b).forward.rms, 2, 1e-8);
    Mesh point;
    point.positions = {{3, 4, 12}};
    point.triangles = {{0, 0, 0}};
    EXPECT_EQ(measure_meshes(point, point).forward.maximum, 0);
    EXPECT_NEAR(measure_meshes(point, b).forward.maximum, std::sqrt(9 + 9 + 14 * 14.0), 1e-7);
}

TEST(Measure, SoupIsMeasuredAsTheMeshThatItCameFrom) {
    const Mesh mesh = sphere(50, 1.0);
    const Mesh other = sphere(20, 1.0);
    const auto target = view_mesh(other);
    Soup soup(mesh);
    const MeasureReport report = measure(soup, *target, small_options());
    // The seam and the poles of the mesh have several vertices in one place.
    EXPECT_EQ(report.forward.n_vertices, 49U * 50U + 2U);
    const MeasureReport expected = measure_meshes(mesh, other);
    EXPECT_EQ(report.forward.rms, expected.forward.rms);
    EXPECT_EQ(report.forward.maximum, expected.forward.maximum);
    expect_equal(report.backward, expected.backward);
}

TEST(Measure, RefusesAMeshWithoutTriangles) {
    Mesh cloud;
    cloud.positions = {{0, 0, 0}, {1, 1, 1}};
    Mesh nan = plane(1, 1, 0);
    for (Vec3& p : nan.positions) p[0] = std::numeric_limits<double>::quiet_NaN();
    const Mesh good = plane(1, 1, 0);
    EXPECT_THROW(measure_meshes(cloud, good), InvalidArgument);
    EXPECT_THROW(measure_meshes(good, cloud), InvalidArgument);
    EXPECT_THROW(measure_meshes(good, nan), InvalidArgument);
}

TEST(Measure, RefusesATooSmallLimitAndNamesOneThatDoes) {
    const Mesh mesh = plane(300, 1, 0);
    MeasureOptions options = small_options();
    options.memory_bytes = 20 << 20;
    std::string message;
    try {
        measure_meshes(mesh, mesh, options);
    } catch (const OutOfMemoryBudget& e) {
        message = e.what();
    }
    const char* const marker = "to more than ";
    const std::size_t at = message.find(marker);
    ASSERT_NE(at, std::string::npos) << message;
    double mib = 0;
    ASSERT_EQ(std::sscanf(message.c_str() + at + std::strlen(marker), "%lf MiB", &mib), 1);
    options.memory_bytes = static_cast<std::uint64_t>((mib + 0.1) * (1 << 20));
    EXPECT_NO_THROW(measure_meshes(mesh, mesh, options));
}

TEST(Measure, ReportsProgressThatEndsAtOneAndStopsWhenAsked) {
    const Mesh mesh = plane(50, 1, 0);
    std::vector<std::string> stages;
    double last = 0;
    Hooks hooks;
    hooks.on_progress = [&](const Progress& p) {
        if (stages.empty() || stages.back() != p.stage) stages.push_back(p.stage);
        EXPECT_GE(p.fraction, last);
        last = p.fraction;
    };
    measure_meshes(mesh, mesh, small_options(), hooks);
    EXPECT_EQ(stages, (std::vector<std::string>{"scan", "load", "index", "vertices", "triangles"}));
    EXPECT_DOUBLE_EQ(last, 1);

    std::stop_source stop;
    Hooks stopping;
    stopping.stop = stop.get_token();
    stopping.on_progress = [&](const Progress& p) {
        if (p.stage == "vertices") stop.request_stop();
    };
    EXPECT_THROW(measure_meshes(mesh, mesh, small_options(), stopping), Cancelled);
}

}  // namespace
}  // namespace hewer
