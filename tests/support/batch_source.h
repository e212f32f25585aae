// SPDX-License-Identifier: MIT
/// A mesh in memory that is handed out in any way a source may choose.
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "hewer/mesh_source.h"

namespace hewer::test {

/// How the elements are cut into batches, and which batch comes first.
struct BatchPlan {
    std::uint64_t seed = 0;      ///< 0: batches in file order, else in random order
    std::uint64_t smallest = 1;  ///< elements in a batch: random within the two
    std::uint64_t largest = 1000;
    bool is_soup = false;  ///< points instead of corners
};

/// Keeps a reference to `mesh`. Colours, normals and weights are passed on for indexed plans.
class BatchSource final : public MeshSource {
  public:
    BatchSource(const Mesh& mesh, const BatchPlan& plan);
    [[nodiscard]] const SourceInfo& info() const override { return info_; }
    void begin_vertices() override { next_ = 0; }
    bool next_vertices(VertexBatch& batch) override;
    void begin_triangles() override { next_ = 0; }
    bool next_triangles(TriangleBatch& batch) override;
    [[nodiscard]] std::uint64_t bytes_read() const override { return 0; }

  private:
    struct Range {
        std::uint64_t first;
        std::uint64_t last;
    };
    static std::vector<Range> cut(std::uint64_t n, const BatchPlan& plan);
    bool take(const std::vector<Range>& ranges, Range& range);

    const Mesh& mesh_;
    SourceInfo info_;
    std::vector<Range> vertex_ranges_;
    std::vector<Range> triangle_ranges_;
    std::mutex mutex_;
    std::size_t next_ = 0;
};

}  // namespace hewer::test
