// SPDX-License-Identifier: MIT
#include "hewer/measure.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "measure/distance_map.h"
#include "measure/lattice.h"
#include "measure/triangle_distance.h"
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

/// A random order of faces and vertices.
Mesh shuffled(const Mesh& mesh, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<std::uint64_t> place(mesh.positions.size());
    std::iota(place.begin(), place.end(), std::uint64_t{0});
    std::shuffle(place.begin(), place.end(), random);
    Mesh result;
    result.positions.resize(place.size());
    for (std::size_t v = 0; v < place.size(); ++v) {
        result.positions[place[v]] = mesh.positions[v];
    }
    for (const Triangle& t : mesh.triangles) {
        result.triangles.push_back({place[t[0]], place[t[1]], place[t[2]]});
    }
    std::shuffle(result.triangles.begin(), result.triangles.end(), random);
    return result;
}

/// The limit that a refusal names, or a little more: it is told in tenths of a MiB.
std::uint64_t least_memory(MeshSource& original, MeshSource& simplified, MeasureOptions options) {
    options.memory_bytes = 20 << 20;
    std::string message;
    try {
        measure(original, simplified, options);
    } catch (const OutOfMemoryBudget& e) {
        message = e.what();
    }
    const char* const marker = "to more than ";
    const std::size_t at = message.find(marker);
    double mib = 0;
    if (at == std::string::npos ||
        std::sscanf(message.c_str() + at + std::strlen(marker), "%lf MiB", &mib) != 1) {
        ADD_FAILURE() << message;
    }
    return static_cast<std::uint64_t>((mib + 0.1) * (1 << 20));
}

TEST(Measure, LimitsAndThreadsDoNotShowWhateverTheOrderOfTheFile) {
    // More vertices than the window of the least limit holds.
    const Mesh a = sphere(400, 1.0);
    const Mesh mixed = shuffled(a, 2);
    const Mesh b = sphere(40, 1.001);
    const auto plain = view_mesh(a);
    const auto scattered = view_mesh(mixed);
    Soup soup(a);
    const auto target = view_mesh(b);
    const MeasureReport expected = measure(*plain, *target, small_options());
    for (const unsigned n_threads : {1U, 3U}) {
        MeasureOptions options = small_options();
        options.n_threads = n_threads;
        options.memory_bytes = least_memory(*plain, *target, options);
        for (MeshSource* source : {plain.get(), scattered.get()}) {
            const MeasureReport report = measure(*source, *target, options);
            expect_equal(expected.forward, report.forward);
            expect_equal(expected.backward, report.backward);
        }
        const MeasureReport of_soup = measure(soup, *target, options);
        EXPECT_EQ(of_soup.forward.rms, expected.forward.rms);
        EXPECT_EQ(of_soup.forward.maximum, expected.forward.maximum);
        EXPECT_EQ(of_soup.forward.n_vertices, 399U * 400U + 2U);
        expect_equal(expected.backward, of_soup.backward);
    }
}

/// Least distance from the lattice point nearest to `p` to any triangle of `mesh`.
double brute_force(const Mesh& mesh, const measuring::Lattice& lattice, const Vec3& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle& t : mesh.triangles) {
        measuring::LatticeTriangle corners;
        for (std::size_t c = 0; c < 3; ++c) {
            corners[c] = lattice.from_model(mesh.positions[t[c]]);
        }
        least = std::min(least, measuring::squared_distance(
                                    measuring::to_double(lattice.from_model(p)), corners));
    }
    return std::sqrt(least) * lattice.step();
}

/// Triangles all over a box, neither closed nor connected, some of them degenerate.
Mesh random_mesh(unsigned seed, std::uint64_t n, double size) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0, 10);
    std::uniform_real_distribution<double> offset(-size, size);
    Mesh mesh;
    for (std::uint64_t i = 0; i < n; ++i) {
        const Vec3 a{place(random), place(random), place(random)};
        for (int c = 0; c < 3; ++c) {
            mesh.positions.push_back(
                {a[0] + offset(random), a[1] + offset(random), a[2] + offset(random)});
        }
        mesh.triangles.push_back({3 * i, 3 * i + 1, i % 7 == 0 ? 3 * i + 1 : 3 * i + 2});
        if (i % 11 == 0) mesh.positions[3 * i + 1] = mesh.positions[3 * i];
    }
    return mesh;
}

TEST(Measure, VertexFiguresAreThoseOfBruteForceOnRandomMeshes) {
    for (unsigned seed = 0; seed < 4; ++seed) {
        const Mesh a = random_mesh(seed, 400, seed % 2 == 0 ? 0.1 : 4);
        const Mesh b = random_mesh(seed + 100, 30 + 300 * seed, seed < 2 ? 3 : 0.01);
        const MeasureReport report = measure_meshes(a, b);
        Bounds both;
        for (const Mesh* mesh : {&a, &b}) {
            for (const Triangle& t : mesh->triangles) {
                for (const std::uint64_t v : t) both.extend(mesh->positions[v]);
            }
        }
        const measuring::Lattice lattice(both);
        for (const auto& [from, to, side] :
             {std::tuple{&a, &b, &report.forward}, {&b, &a, &report.backward}}) {
            double maximum = 0;
            double sum = 0;
            double squares = 0;
            std::uint64_t n = 0;
            std::set<std::uint64_t> used;
            for (const Triangle& t : from->triangles) used.insert(t.begin(), t.end());
            for (const std::uint64_t v : used) {
                const double d = brute_force(*to, lattice, from->positions[v]);
                maximum = std::max(maximum, d);
                sum += d;
                squares += d * d;
                ++n;
            }
            EXPECT_EQ(side->vertex_maximum, maximum);
            EXPECT_EQ(side->n_vertices, n);
            EXPECT_NEAR(side->vertex_mean, sum / static_cast<double>(n), 1e-12);
            EXPECT_NEAR(side->vertex_rms, std::sqrt(squares / static_cast<double>(n)), 1e-12);
        }
    }
}

/// A map written in a folder of its own, read back; and the report.
class MeasureMap : public testing::Test {
  protected:
    MeasureMap() { std::filesystem::create_directories(folder_); }
    ~MeasureMap() override { std::filesystem::remove_all(folder_); }
    MeasureMap(const MeasureMap&) = delete;
    MeasureMap& operator=(const MeasureMap&) = delete;

    struct Map {
        MeasureReport report;
        std::vector<Vec3> positions;
        std::vector<Rgba16> colors;
        std::vector<Triangle> triangles;
    };
    Map draw(MeshSource& original, MeshSource& simplified, MeasureOptions options) {
        options.map = folder_ / "map.ply";
        options.overwrite = true;
        Map map{measure(original, simplified, options), {}, {}, {}};
        const auto source = open_mesh(options.map);
        VertexBatch vertices;
        source->begin_vertices();
        while (source->next_vertices(vertices)) {
            map.positions.insert(map.positions.end(), vertices.positions.begin(),
                                 vertices.positions.end());
            map.colors.insert(map.colors.end(), vertices.colors.begin(), vertices.colors.end());
        }
        TriangleBatch triangles;
        source->begin_triangles();
        while (source->next_triangles(triangles)) {
            map.triangles.insert(map.triangles.end(), triangles.corners.begin(),
                                 triangles.corners.end());
        }
        return map;
    }
    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("hewer-map-" + std::to_string(::getpid()));
};

TEST_F(MeasureMap, OfTheOriginalShowsEachVertexItsDistance) {
    // A slope over a plane: distance grows with x; the map's range is reached halfway.
    Mesh slope = plane(8, 1, 0);
    for (Vec3& p : slope.positions) p[2] = 0.5 * p[0];
    slope.positions.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
    slope.triangles.push_back({0, 1, 81});
    const auto original = view_mesh(slope);
    const Mesh flat = plane(1, 1, 0);
    const auto simplified = view_mesh(flat);
    MeasureOptions options = small_options();
    options.map_of = MapOf::Original;
    options.map_range = 0.25;
    const Map map = draw(*original, *simplified, options);
    EXPECT_EQ(map.report.map_range, 0.25);
    ASSERT_EQ(map.positions.size(), 82U);
    EXPECT_EQ(map.triangles.size(), 128U);
    for (std::size_t i = 0; i < 81; ++i) {
        const Rgba16 expected = measuring::ramp_color(map.positions[i][2] / 0.25);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(map.colors[i][k], expected[k], 257);
    }
    EXPECT_EQ(map.colors[81], (Rgba16{0x8080, 0x8080, 0x8080, 0xffff}));
}

TEST_F(MeasureMap, OfTheSimplifiedShowsWhatItHasLost) {
    // The bump has no counterpart; from below, the plane is no farther than its foot.
    Mesh bump = plane(20, 20, 0);
    bump.positions[5 * 21 + 5][2] = 3;
    const auto original = view_mesh(bump);
    const Mesh flat = plane(4, 20, 0);  // vertices 5 apart: one right below
    const auto simplified = view_mesh(flat);
    MeasureOptions options = small_options();
    options.map_range = 3;
    const Map map = draw(*original, *simplified, options);
    ASSERT_EQ(map.positions.size(), 25U);
    for (std::size_t i = 0; i < 25; ++i) {
        if (map.positions[i] == Vec3{5, 5, 0}) {
            EXPECT_EQ(map.colors[i], measuring::ramp_color(1));
        } else if (map.positions[i][0] > 14) {
            EXPECT_EQ(map.colors[i], measuring::ramp_color(0));
        }
    }
    Soup soup(flat);
    const Map of_soup = draw(*original, soup, options);
    EXPECT_EQ(of_soup.positions.size(), 96U);
    EXPECT_EQ(of_soup.triangles.size(), 32U);
    EXPECT_NE(std::find(of_soup.colors.begin(), of_soup.colors.end(), measuring::ramp_color(1)),
              of_soup.colors.end());
}

TEST_F(MeasureMap, OfEqualSurfacesIsAllOfTheFirstColor) {
    const Mesh mesh = plane(3, 1, 0);
    const auto a = view_mesh(mesh);
    const auto b = view_mesh(mesh);
    for (const Rgba16& color : draw(*a, *b, small_options()).colors) {
        EXPECT_EQ(color, measuring::ramp_color(0));
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
    const auto original = view_mesh(mesh);
    const auto simplified = view_mesh(mesh);
    MeasureOptions options = small_options();
    options.memory_bytes = least_memory(*original, *simplified, options);
    EXPECT_NO_THROW(measure(*original, *simplified, options));
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
