// SPDX-License-Identifier: MIT
/// The original surface on its way past the simplified one.
#pragma once

#include <cstdint>
#include <mutex>

#include "hewer/mesh_source.h"
#include "measure/area_sampler.h"
#include "measure/census.h"
#include "measure/direction.h"
#include "measure/lattice.h"
#include "measure/triangle_index.h"
#include "measure/waiting_points.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::measuring {

/// Two passes over a source that is not in memory. First its vertices: each is measured to the
/// nearest triangle of `to`, and noted as a limit for the points of that surface that wait for
/// theirs. Then its triangles: their samples are measured, and the waiting points meet them.
class OriginalPass {
  public:
    struct Input {
        MeshSource& source;
        const Census& census;
        const Lattice& lattice;
        const TriangleIndex& to;
        const AreaSampler& sampler;
        std::uint64_t window_bytes;  ///< for vertices (streaming::Dereference), or to sort a soup
    };

    /// `greatest`, if not empty, has the greatest squared distance, in square steps and as floats,
    /// of all points that have each triangle of `to` as their nearest.
    OriginalPass(ooc::Context& context, const Input& input, Direction& forward,
                 WaitingPoints& waiting, ooc::Array<float>& greatest);

    /// One pass over the vertices, then waiting.settle(). A soup: one over the triangles, whose
    /// corners are sorted (on disk, 12 bytes each, if memory is short) and equal ones taken for
    /// one.
    void measure_vertices();
    /// One pass over the triangles.
    void measure_triangles();

    static constexpr std::uint64_t kFarPoints = 1 << 16;
    /// Besides the window.
    static std::uint64_t bytes(unsigned n_threads);

  private:
    /// One worker's measuring of points that follow each other.
    struct Probe {
        TriangleIndex::Walk walk;
        std::uint64_t n_seen = 0;  // vertices
    };
    void measure_vertex(unsigned worker, Probe& probe, const LatticePoint& p);
    double measure(Probe& probe, const Vec3& q);
    void measure_indexed_vertices();
    void measure_soup_corners();

    ooc::Context& context_;
    Input input_;
    Direction& forward_;
    WaitingPoints& waiting_;
    ooc::Array<float>& greatest_;
    std::mutex mutex_;
    ooc::Array<LatticeTriangle> far_;  // every far_stride_th vertex that a worker has seen
    std::uint64_t n_far_ = 0;
    std::uint64_t far_stride_ = 1;
};

}  // namespace hewer::measuring
