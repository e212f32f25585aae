// SPDX-License-Identifier: MIT
#include "streaming/dereference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <random>
#include <vector>

namespace hewer::streaming {
namespace {

struct Encoder {
    using Point = Vec3;
    [[nodiscard]] static Vec3 encode(const Vec3& p) { return p; }
    [[nodiscard]] static bool is_absent(const Vec3& p) { return !std::isfinite(p[0]); }
};

/// A strip of triangles; one vertex is not finite.
Mesh strip(std::uint64_t n) {
    Mesh mesh;
    for (std::uint64_t v = 0; v < n + 2; ++v) {
        mesh.positions.push_back({static_cast<double>(v), static_cast<double>(v % 2), 7});
    }
    for (std::uint64_t t = 0; t < n; ++t) mesh.triangles.push_back({t, t + 1, t + 2});
    mesh.positions[n / 2][0] = std::numeric_limits<double>::quiet_NaN();
    return mesh;
}

/// Reads front to back only.
class Unseekable final : public MeshSource {
  public:
    explicit Unseekable(std::unique_ptr<MeshSource> source) : source_(std::move(source)) {}
    [[nodiscard]] const SourceInfo& info() const override { return source_->info(); }
    void begin_vertices() override { source_->begin_vertices(); }
    bool next_vertices(VertexBatch& batch) override { return source_->next_vertices(batch); }
    void begin_triangles() override { source_->begin_triangles(); }
    bool next_triangles(TriangleBatch& batch) override { return source_->next_triangles(batch); }
    [[nodiscard]] std::uint64_t bytes_read() const override { return 0; }

  private:
    std::unique_ptr<MeshSource> source_;
};

/// The triangles that came, sorted; checks that each has the points of its ids.
std::vector<Triangle> collect(ooc::Context& context, MeshSource& source, const Mesh& mesh,
                              std::uint64_t memory_bytes, Coherence& coherence) {
    std::mutex mutex;
    std::vector<Triangle> all;
    Dereference<Encoder> triangles(context, source, {}, memory_bytes);
    triangles.for_batches(
        [&] { all.clear(); },
        [&](unsigned, std::span<const std::array<Vec3, 3>> points, std::span<const Triangle> ids) {
            const std::lock_guard lock(mutex);
            ASSERT_EQ(points.size(), ids.size());
            for (std::size_t i = 0; i < ids.size(); ++i) {
                for (std::size_t c = 0; c < 3; ++c) {
                    ASSERT_EQ(points[i][c], mesh.positions[ids[i][c]]);
                }
            }
            all.insert(all.end(), ids.begin(), ids.end());
        });
    std::sort(all.begin(), all.end());
    coherence = triangles.coherence();
    return all;
}

TEST(Dereference, FindsThePointsOfAllCornersInAnyMemoryAndOrder) {
    constexpr std::uint64_t kTriangles = 300'000;
    const Mesh mesh = strip(kTriangles);
    Mesh mixed = mesh;
    std::mt19937 random(1);
    std::shuffle(mixed.triangles.begin(), mixed.triangles.end(), random);
    std::vector<Triangle> expected = mesh.triangles;
    std::erase_if(expected, [&](const Triangle& t) {
        return std::any_of(t.begin(), t.end(),
                           [&](std::uint64_t v) { return v == kTriangles / 2; });
    });
    for (const bool is_seekable : {true, false}) {
        for (const unsigned n_threads : {1U, 3U}) {
            for (const std::uint64_t memory : {std::uint64_t{1} << 20, std::uint64_t{1} << 30}) {
                for (const Mesh* m : {&mesh, static_cast<const Mesh*>(&mixed)}) {
                    ooc::Context context({.memory_bytes = 256 << 20, .n_threads = n_threads});
                    std::unique_ptr<MeshSource> source = view_mesh(*m);
                    if (!is_seekable) source = std::make_unique<Unseekable>(std::move(source));
                    Coherence coherence{};
                    EXPECT_EQ(collect(context, *source, *m, memory, coherence), expected);
                    const bool is_scattered = m == &mixed && memory == std::uint64_t{1} << 20;
                    EXPECT_EQ(coherence, is_scattered ? Coherence::Scattered : Coherence::Coherent);
                }
            }
        }
    }
}

TEST(Dereference, StaysWithinTheMemoryItWasGiven) {
    const Mesh mesh = strip(300'000);
    const auto source = view_mesh(mesh);
    ooc::Context context({.memory_bytes = 256 << 20, .n_threads = 2});
    const std::uint64_t before = context.budget().used();
    Coherence coherence{};
    collect(context, *source, mesh, 2 << 20, coherence);
    EXPECT_LE(context.budget().peak() - before, 2U << 20);
    EXPECT_EQ(context.budget().used(), before);
}

}  // namespace
}  // namespace hewer::streaming
