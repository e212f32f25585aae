// SPDX-License-Identifier: MIT
#include "rsimp/clusters.h"

#include <cmath>
#include <limits>

#include "ooc/parallel.h"
#include "ooc/vec3.h"

namespace hewer::rsimp {

using cluster::CellStore;

namespace {

std::array<float, 6> box_around(const Vec3& low, const Vec3& high, const Vec3& shift) {
    std::array<float, 6> box;
    for (std::size_t i = 0; i < 3; ++i) {
        // Outwards, so that rounding cannot make a box too small.
        box[i] = std::nextafter(static_cast<float>(low[i] + shift[i]),
                                -std::numeric_limits<float>::infinity());
        box[3 + i] = std::nextafter(static_cast<float>(high[i] + shift[i]),
                                    std::numeric_limits<float>::infinity());
    }
    return box;
}

}  // namespace

Clusters make_clusters(ooc::Context& context, const CellStore& store, std::uint64_t n) {
    Clusters clusters;
    clusters.n_clusters = n;
    clusters.cluster_of_cell = {context.budget(), "clusters of cells", store.codes.size()};
    clusters.positions = {context.budget(), "cluster vertices", n};
    clusters.quadrics = {context.budget(), "cluster quadrics", n};
    clusters.boxes = {context.budget(), "cluster boxes", n};
    if (!store.attributes.empty()) {
        clusters.attributes = {context.budget(), "cluster attributes", n};
    }
    // The middle of the grid keeps the coordinates that enter the quadrics small.
    const double half = std::floor(store.grid.resolution() / 2);
    clusters.origin = {half, half, half};
    return clusters;
}

void store_cluster(Clusters& clusters, std::uint64_t k, const ClusterSums& sums,
                   const Vec3& shift) {
    const cluster::Eigen3 eigen = cluster::eigen_decomposition(sums.quadric.a);
    clusters.positions[k] = representative(sums, eigen) + shift;
    clusters.quadrics[k] = sums.quadric.relative_to({-shift[0], -shift[1], -shift[2]});
    clusters.boxes[k] = box_around(sums.low, sums.high, shift);
}

Clusters clusters_from_cells(ooc::Context& context, const CellStore& store) {
    Clusters clusters = make_clusters(context, store, store.codes.size());
    context.workers().for_ranges(
        store.codes.size(), 1 << 12, [&](std::uint64_t begin, std::uint64_t end) {
            for (std::uint64_t k = begin; k < end; ++k) {
                ClusterSums sums;  // in the frame of the cell's own centre
                sums.add(store.cells[k]);
                store_cluster(clusters, k, sums, store.center(k) - clusters.origin);
                clusters.cluster_of_cell[k] = static_cast<std::uint32_t>(k);
                if (!clusters.attributes.empty()) clusters.attributes[k] = store.attributes[k];
            }
        });
    return clusters;
}

}  // namespace hewer::rsimp
