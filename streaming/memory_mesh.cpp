// SPDX-License-Identifier: MIT
/// Meshes in memory as a source and as a sink.
#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "hewer/error.h"
#include "hewer/mesh_sink.h"
#include "hewer/mesh_source.h"

namespace hewer {

namespace {

/// The element number in "vertex 17 (byte 1234)".
std::uint64_t element_number(const std::string& text) {
    const std::size_t digits = text.find_first_of("0123456789");
    return digits == std::string::npos ? 0 : std::stoull(text.substr(digits));
}

void keep_first(std::string& mine, const std::string& other) {
    if (other.empty()) return;
    if (mine.empty() || element_number(other) < element_number(mine)) mine = other;
}

}  // namespace

void InputDefects::merge(const InputDefects& other) {
    nonfinite_vertices += other.nonfinite_vertices;
    nonfinite_triangles += other.nonfinite_triangles;
    out_of_range_triangles += other.out_of_range_triangles;
    short_faces += other.short_faces;
    polygons += other.polygons;
    degenerate_triangles += other.degenerate_triangles;
    bad_weights += other.bad_weights;
    trailing_bytes += other.trailing_bytes;
    keep_first(first_nonfinite, other.first_nonfinite);
    keep_first(first_out_of_range, other.first_out_of_range);
}

void MeshSource::read_vertices(std::uint64_t, std::uint64_t, VertexBatch&) {
    throw InternalError("this source cannot seek");
}

void MeshSink::add_points(std::span<const std::array<Vec3, 3>> triangles) {
    throw InternalError("a sink that needs indices was given " + std::to_string(triangles.size()) +
                        " triangles as points");
}

namespace {

constexpr std::uint64_t kBatch = 16384;

class MeshView final : public MeshSource {
  public:
    MeshView(const Mesh& mesh, std::string name) : mesh_(mesh) {
        info_.name = std::move(name);
        info_.format = "memory";
        info_.n_vertices = mesh.positions.size();
        info_.n_faces = mesh.triangles.size();
        info_.has_double_positions = true;
        info_.has_normals = !mesh.normals.empty();
        info_.has_colors = !mesh.colors.empty();
        info_.has_alpha = info_.has_colors;
        info_.has_weights = !mesh.weights.empty();
    }

    [[nodiscard]] const SourceInfo& info() const override { return info_; }
    void begin_vertices() override { next_ = 0; }
    void begin_triangles() override { next_ = 0; }
    [[nodiscard]] std::uint64_t bytes_read() const override { return 0; }

    bool next_vertices(VertexBatch& batch) override {
        const auto [first, last] = take(mesh_.positions.size());
        if (first == last) return false;
        batch.first = first;
        batch.defects = {};
        slice(mesh_.positions, first, last, batch.positions);
        slice(mesh_.normals, first, last, batch.normals);
        slice(mesh_.colors, first, last, batch.colors);
        slice(mesh_.weights, first, last, batch.weights);
        for (std::uint64_t i = first; i < last; ++i) {
            const Vec3& p = mesh_.positions[i];
            if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) continue;
            if (batch.defects.nonfinite_vertices++ == 0) {
                batch.defects.first_nonfinite = "vertex " + std::to_string(i);
            }
        }
        return true;
    }

    [[nodiscard]] bool can_seek_vertices() const override { return true; }
    void read_vertices(std::uint64_t first, std::uint64_t n, VertexBatch& batch) override {
        batch.first = first;
        slice(mesh_.positions, first, first + n, batch.positions);
    }

    bool next_triangles(TriangleBatch& batch) override {
        const auto [first, last] = take(mesh_.triangles.size());
        if (first == last) return false;
        batch.first_face = first;
        batch.n_faces = last - first;
        batch.defects = {};
        batch.points.clear();
        batch.corners.clear();
        for (std::uint64_t i = first; i < last; ++i) {
            const Triangle& t = mesh_.triangles[i];
            if (std::max({t[0], t[1], t[2]}) < info_.n_vertices) {
                batch.corners.push_back(t);
            } else if (batch.defects.out_of_range_triangles++ == 0) {
                batch.defects.first_out_of_range = "face " + std::to_string(i);
            }
        }
        return true;
    }

  private:
    std::pair<std::uint64_t, std::uint64_t> take(std::uint64_t size) {
        const std::lock_guard lock(mutex_);
        const std::uint64_t first = std::min<std::uint64_t>(next_, size);
        next_ = std::min(first + kBatch, size);
        return {first, next_};
    }
    template <typename T>
    static void slice(const std::vector<T>& all, std::uint64_t first, std::uint64_t last,
                      std::vector<T>& out) {
        out.clear();
        if (all.empty()) return;
        out.assign(all.begin() + static_cast<std::ptrdiff_t>(first),
                   all.begin() + static_cast<std::ptrdiff_t>(last));
    }

    const Mesh& mesh_;
    SourceInfo info_;
    std::mutex mutex_;
    std::uint64_t next_ = 0;
};

class MeshCollector final : public MeshSink {
  public:
    explicit MeshCollector(Mesh& mesh) : mesh_(mesh) {}
    void begin(const SinkHeader& header) override {
        mesh_ = {};
        mesh_.positions.reserve(header.n_vertices);
        mesh_.triangles.reserve(header.n_triangles);
    }
    void add_vertices(const VertexSpan& v) override {
        mesh_.positions.insert(mesh_.positions.end(), v.positions.begin(), v.positions.end());
        mesh_.normals.insert(mesh_.normals.end(), v.normals.begin(), v.normals.end());
        mesh_.colors.insert(mesh_.colors.end(), v.colors.begin(), v.colors.end());
    }
    void add_triangles(std::span<const Triangle> triangles) override {
        mesh_.triangles.insert(mesh_.triangles.end(), triangles.begin(), triangles.end());
    }
    void finish() override {}
    [[nodiscard]] std::uint64_t bytes_written() const override { return 0; }

  private:
    Mesh& mesh_;
};

}  // namespace

std::unique_ptr<MeshSource> view_mesh(const Mesh& mesh, std::string name) {
    return std::make_unique<MeshView>(mesh, std::move(name));
}

std::unique_ptr<MeshSink> collect_mesh(Mesh& mesh) {
    return std::make_unique<MeshCollector>(mesh);
}

}  // namespace hewer
