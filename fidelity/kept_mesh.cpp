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
