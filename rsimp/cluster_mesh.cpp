// SPDX-License-Identifier: MIT
#include "rsimp/cluster_mesh.h"

#include <cmath>
#include <limits>

#include "ooc/parallel.h"
#include "ooc/spool_cache.h"
#include "ooc/vec3.h"
#include "rsimp/cluster_summary.h"

namespace hewer::rsimp {

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

/// The faces of block `b` between clusters.
std::vector<CellTriple> map_faces(const cluster::CellBlocks& cells, std::size_t b,
                                  const ooc::Spool<std::uint32_t>& cluster_of_cell) {
    const cluster::CellBlocks::Block& first = cells.blocks[b];
    const cluster::CellBlocks::Block& last = cells.blocks[b + 1];
    std::vector<std::uint32_t> own(last.first_cell - first.first_cell);
    cluster_of_cell.read(first.first_cell, own);
    // A few per cent of the corners are in other blocks, near by.
    ooc::SpoolCache<std::uint32_t> others(cluster_of_cell);
    std::vector<CellTriple> mapped;
    ooc::SpoolReader<CellTriple> faces(cells.faces, first.first_face, last.first_face);
    while (const CellTriple* face = faces.next()) {
        CellTriple m;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t id = (*face)[i];
            m[i] = id >= first.first_cell && id < last.first_cell ? own[id - first.first_cell]
                                                                  : others.at(id);
        }
        if (m[0] != m[1] && m[1] != m[2] && m[0] != m[2]) mapped.push_back(m);
    }
    return mapped;
}

}  // namespace

void BlockClusters::add(const ClusterSums& sums, const Vec3& shift, std::uint32_t n) {
    const cluster::Eigen3 eigen = cluster::eigen_decomposition(sums.quadric.a);
    vertices.push_back({representative(sums, eigen) + shift,
                        sums.quadric.relative_to({-shift[0], -shift[1], -shift[2]}),
                        box_around(sums.low, sums.high, shift)});
    n_cells.push_back(n);
}

Vec3 cluster_origin(const cluster::CellBlocks& cells) {
    // The middle of the grid keeps the coordinates that enter the quadrics small.
    const double half = std::floor(cells.grid.resolution() / 2);
    return {half, half, half};
}

ClusterMesh build_cluster_mesh(ooc::Context& context, const cluster::CellBlocks& cells,
                               std::size_t most_alive,
                               const std::function<BlockClusters(std::size_t)>& make) {
    ClusterMesh mesh;
    mesh.origin = cluster_origin(cells);
    mesh.is_closed = cells.n_border_cells == 0;
    mesh.vertices = {context, "clusters"};
    mesh.n_cells = {context, "cells of clusters"};
    if (!cells.attributes.empty()) mesh.attributes = {context, "cluster attributes"};
    ooc::Spool<std::uint32_t> cluster_of_cell(context, "clusters of cells");
    context.workers().in_order(cells.n_blocks(), most_alive, make,
                               [&](std::uint64_t b, BlockClusters& clusters) {
                                   const auto first = mesh.vertices.size();
                                   mesh.blocks.push_back({cells.blocks[b].box, first, 0});
                                   for (std::uint32_t& c : clusters.cluster_of_cell) {
                                       c += static_cast<std::uint32_t>(first);
                                   }
                                   cluster_of_cell.append(clusters.cluster_of_cell);
                                   mesh.vertices.append(clusters.vertices);
                                   mesh.n_cells.append(clusters.n_cells);
                                   if (!cells.attributes.empty()) {
                                       mesh.attributes.append(clusters.attributes);
                                   }
                                   context.check_stop();
                               });
    mesh.blocks.push_back({{}, mesh.vertices.size(), 0});

    mesh.faces = {context, "faces of clusters"};
    context.workers().in_order(
        cells.n_blocks(), most_alive,
        [&](std::uint64_t b) { return map_faces(cells, b, cluster_of_cell); },
        [&](std::uint64_t b, const std::vector<CellTriple>& faces) {
            mesh.blocks[b].first_face = mesh.faces.size();
            mesh.faces.append(faces);
            context.check_stop();
        });
    mesh.blocks.back().first_face = mesh.faces.size();
    return mesh;
}

}  // namespace hewer::rsimp
