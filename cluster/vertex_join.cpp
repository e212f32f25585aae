// SPDX-License-Identifier: MIT
#include "cluster/vertex_join.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "cluster/vertex_pages.h"
#include "streaming/corner_join.h"

namespace hewer::cluster {

PartitionFindings join_vertices(ooc::Context& context, MeshSource& source,
                                const ooc::Spool<LatticePoint>& spooled, const Lattice& lattice,
                                std::uint64_t range_bytes, TrianglePartition& partition) {
    const auto load = [&](std::uint64_t first, std::uint64_t n, LatticePoint* out) {
        if (!spooled.empty()) {
            spooled.read(first, std::span<LatticePoint>(out, n));
            return;
        }
        VertexBatch batch;
        source.read_vertices(first, n, batch);
        for (std::uint64_t i = 0; i < n; ++i) {
            const Vec3& p = batch.positions[i];
            out[i] = std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])
                         ? lattice.encode(p)
                         : VertexPages::kNotFinite;
        }
    };
    streaming::CornerJoin<LatticePoint> join(context, source, load, range_bytes);
    PartitionFindings findings;
    TriangleBatch batch;
    std::vector<LatticeTriangle> triangles;
    while (join.next(batch, triangles)) {
        for (const LatticeTriangle& t : triangles) {
            if (std::find(t.begin(), t.end(), VertexPages::kNotFinite) == t.end()) {
                partition.add(t);
            } else {
                ++batch.defects.nonfinite_triangles;
            }
        }
        findings.defects.merge(batch.defects);
        context.advance(batch.n_faces);
    }
    partition.finish();
    return findings;
}

}  // namespace hewer::cluster
