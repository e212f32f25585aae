// SPDX-License-Identifier: MIT
#include "fidelity/kept_mesh.h"

#include <algorithm>
#include <span>

namespace hewer::fidelity {

/// Beside the mesh it keeps what the sink was told, to tell the next one.
class KeptMesh::Sink final : public MeshSink {
  public:
    explicit Sink(KeptMesh& kept) : kept_(kept), collector_(collect_mesh(kept.mesh_)) {}
    void begin(const SinkHeader& header) override {
        kept_.header_ = header;
        collector_->begin(header);
        // Repairs add up to 3 % and what one round has. Growing would double what is held.
        const auto with_room = [](std::uint64_t n) { return n + n / 25 + 1024; };
        kept_.mesh_.positions.reserve(with_room(header.n_vertices));
        kept_.mesh_.triangles.reserve(with_room(header.n_triangles));
    }
    void add_vertices(const VertexSpan& vertices) override { collector_->add_vertices(vertices); }
    void add_triangles(std::span<const Triangle> triangles) override {
        collector_->add_triangles(triangles);
    }
    void finish() override { collector_->finish(); }
    [[nodiscard]] std::uint64_t bytes_written() const override { return 0; }

  private:
    KeptMesh& kept_;
    std::unique_ptr<MeshSink> collector_;
};

std::unique_ptr<MeshSink> KeptMesh::sink() {
    return std::make_unique<Sink>(*this);
}

PullReport KeptMesh::pull(std::span<const Pull> pulls) {
    PullReport report = pull_to_points(mesh_, pulls);
    header_.n_vertices = mesh_.positions.size();
    header_.n_triangles = mesh_.triangles.size();
    header_.bounds = {};
    for (const Vec3& p : mesh_.positions) header_.bounds.extend(p);
    return report;
}

void KeptMesh::write(MeshSink& sink) const {
    constexpr std::size_t kPiece = 1 << 14;
    sink.begin(header_);
    const std::span all(mesh_.positions);
    const auto piece_of = [](const auto& values, std::size_t first, std::size_t n) {
        return values.empty() ? std::span(values) : std::span(values).subspan(first, n);
    };
    for (std::size_t first = 0; first < all.size(); first += kPiece) {
        const std::size_t n = std::min(kPiece, all.size() - first);
        sink.add_vertices({all.subspan(first, n), piece_of(mesh_.normals, first, n),
                           piece_of(mesh_.colors, first, n)});
    }
    for (std::size_t first = 0; first < mesh_.triangles.size(); first += kPiece) {
        sink.add_triangles(
            piece_of(mesh_.triangles, first, std::min(kPiece, mesh_.triangles.size() - first)));
    }
    sink.finish();
}

}  // namespace hewer::fidelity
