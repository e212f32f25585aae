// SPDX-License-Identifier: MIT
#include "rsimp/cluster_mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

#include "ooc/spool_cache.h"
#include "ooc/vec3.h"
#include "rsimp/blocks_in_flight.h"
#include "rsimp/cluster_summary.h"

namespace hewer::rsimp {

using cluster::CellAttributes;
using cluster::CellBlocks;
using cluster::CellRecord;

namespace {

AttributeKinds kinds_of(const CellBlocks& blocks) {
    return {!blocks.attributes.empty(), !blocks.attribute_quadrics.empty()};
}

/// A block's cells, and the clusters that they come to.
struct BlockClusters {
    // By cell of the block.
    std::vector<CellRecord> cells;
    std::vector<std::uint64_t> codes;
    std::vector<CellAttributes> cell_attributes;
    std::vector<cluster::CellAttributeQuadric> cell_quadrics;
    CellGroups groups;
    std::vector<std::uint32_t> cluster_of_cell;  // places in `vertices`
    // By cluster.
    std::vector<CollapseVertex> vertices;
    std::vector<std::uint32_t> n_cells;
    VertexAttributes attributes;

    static std::uint64_t bytes_for(const LargestBlock& largest, AttributeKinds kinds) {
        const std::uint64_t attributes =
            kinds.bytes() + (kinds.sums ? sizeof(CellAttributes) : 0) +
            (kinds.quadrics ? sizeof(cluster::CellAttributeQuadric) : 0);
        return largest.n_cells *
               (sizeof(CellRecord) + sizeof(std::uint64_t) + 2 * sizeof(LocalCell) +
                2 * sizeof(std::uint32_t) + sizeof(CollapseVertex) + attributes);
    }
};

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

Vec3 position_of(const ClusterSums& sums) {
    return representative(sums, cluster::eigen_decomposition(sums.quadric.a));
}

/// `shift` takes the frame of the sums to the origin of the mesh.
CollapseVertex make_vertex(const ClusterSums& sums, const Vec3& shift) {
    return {position_of(sums) + shift, sums.quadric.relative_to({-shift[0], -shift[1], -shift[2]}),
            box_around(sums.low, sums.high, shift)};
}

void load_cells(const CellBlocks& blocks, std::size_t b, BlockClusters& block) {
    const std::uint64_t first = blocks.blocks[b].first_cell;
    const std::uint64_t n = blocks.blocks[b + 1].first_cell - first;
    block.cells.resize(n);
    blocks.cells.read(first, std::span(block.cells));
    block.codes.resize(n);
    blocks.codes.read(first, std::span(block.codes));
    if (!blocks.attributes.empty()) {
        block.cell_attributes.resize(n);
        blocks.attributes.read(first, std::span(block.cell_attributes));
    }
    if (!blocks.attribute_quadrics.empty()) {
        block.cell_quadrics.resize(n);
        blocks.attribute_quadrics.read(first, std::span(block.cell_quadrics));
    }
}

/// What the attributes of a cluster's cells add to its error, in the frame.
cluster::AttributeQuadric sum_attributes(std::span<const LocalCell> cells, const Vec3& frame,
                                         const BlockClusters& block) {
    cluster::AttributeQuadric sum;
    for (const LocalCell i : cells) {
        const auto& mean = block.cells[i].mean;
        const Vec3 in_cell{static_cast<double>(mean[0]), static_cast<double>(mean[1]),
                           static_cast<double>(mean[2])};
        sum += block.cell_quadrics[i].at(cluster::center_of(block.codes[i]) - frame + in_cell);
    }
    return sum;
}

/// Cluster `k` of the block, from its cells by rising place in the block.
void make_cluster(std::span<const LocalCell> cells, const Vec3& origin, std::size_t k,
                  BlockClusters& block) {
    // The frame is the first cell's: near enough for full precision, and exact for a cluster of
    // one.
    const Vec3 frame = cluster::center_of(block.codes[cells.front()]);
    ClusterSums sums;
    for (const LocalCell i : cells) {
        CellRecord cell = block.cells[i];
        const Vec3 shift = cluster::center_of(block.codes[i]) - frame;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            cell.mean[axis] += static_cast<float>(shift[axis]);
        }
        sums.add(cell);
        block.cluster_of_cell[i] = static_cast<std::uint32_t>(k);
    }
    block.vertices[k] = make_vertex(sums, frame - origin);
    block.n_cells[k] = static_cast<std::uint32_t>(cells.size());
    if (!block.cell_quadrics.empty()) {
        const cluster::AttributeQuadric attributes = sum_attributes(cells, frame, block);
        block.attributes.quadrics[k] = attributes.relative_to(origin - frame);
        sums.quadric += attributes.reduced();
        block.vertices[k].position = position_of(sums) + (frame - origin);
    }
    if (block.cell_attributes.empty()) return;
    block.attributes.sums[k] = {};
    for (const LocalCell i : cells) block.attributes.sums[k] += block.cell_attributes[i];
}

void make_clusters(ooc::Context& context, const Vec3& origin, BlockClusters& block) {
    const std::size_t n_cells = block.cells.size();
    CellGroups& groups = block.groups;
    const std::size_t n = groups.begins.size();
    if (groups.order.empty()) {
        groups.order.resize(n_cells);
        std::iota(groups.order.begin(), groups.order.end(), LocalCell{0});
    }
    block.cluster_of_cell.resize(n_cells);
    block.vertices.resize(n);
    block.n_cells.resize(n);
    block.attributes.resize(n, {!block.cell_attributes.empty(), !block.cell_quadrics.empty()});
    // A model of few blocks leaves threads idle that can help here.
    constexpr std::uint64_t kGrain = 1024;
    context.workers().for_ranges(n, kGrain, [&](std::uint64_t first, std::uint64_t last) {
        for (std::uint64_t k = first; k < last; ++k) {
            const auto begin = groups.order.data() + groups.begins[k];
            const auto end = groups.order.data() + (k + 1 < n ? groups.begins[k + 1] : n_cells);
            std::sort(begin, end);
            make_cluster({begin, end}, origin, k, block);
        }
    });
}

/// First sweep.
void add_vertices(ooc::Context& context, const CellBlocks& blocks, const GroupCells& group_cells,
                  ClusterMesh& mesh) {
    const LargestBlock largest(blocks);
    const BlocksInFlight in_flight(context, "clusters of a block",
                                   BlockClusters::bytes_for(largest, kinds_of(blocks)));
    in_flight.sweep<BlockClusters>(
        blocks.n_blocks(),
        [&](std::uint64_t b, BlockClusters& block) {
            load_cells(blocks, b, block);
            block.groups.order.clear();
            block.groups.begins.clear();
            group_cells(b, block.groups);
            make_clusters(context, mesh.origin, block);
        },
        [&](std::uint64_t b, BlockClusters& block) {
            const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
            for (std::uint32_t& c : block.cluster_of_cell) c += first;
            mesh.cluster_of_cell.append(block.cluster_of_cell);
            mesh.blocks[b] = {blocks.blocks[b].box, first, 0, 0};
            mesh.vertices.append(block.vertices);
            mesh.n_cells.append(block.n_cells);
            mesh.attributes.append(block.attributes);
        });
}

/// What the second sweep holds for a block.
struct BlockFaces {
    std::vector<std::uint32_t> cluster_of_cell;
    std::vector<CellTriple> faces;
    std::vector<ClusterMesh::Link> links;

    static std::uint64_t bytes_for(const LargestBlock& largest) {
        return largest.n_cells * sizeof(std::uint32_t) +
               largest.n_faces * (sizeof(CellTriple) + sizeof(ClusterMesh::Link)) +
               ooc::SpoolReader<CellTriple>::kBufferBytes + ooc::SpoolCache<std::uint32_t>::kBytes;
    }
};

void map_faces(const CellBlocks& blocks, std::size_t b,
               const ooc::Spool<std::uint32_t>& cluster_of_cell, bool with_links,
               BlockFaces& block) {
    const auto& first = blocks.blocks[b];
    const auto& last = blocks.blocks[b + 1];
    block.cluster_of_cell.resize(last.first_cell - first.first_cell);
    cluster_of_cell.read(first.first_cell, std::span(block.cluster_of_cell));
    std::optional<ooc::SpoolCache<std::uint32_t>> outside;
    const auto cluster_of = [&](std::uint32_t cell) {
        if (cell >= first.first_cell && cell < last.first_cell) {
            return block.cluster_of_cell[cell - first.first_cell];
        }
        if (!outside) outside.emplace(cluster_of_cell);
        return outside->at(cell);
    };
    block.faces.clear();
    block.links.clear();
    ooc::SpoolReader<CellTriple> reader(blocks.faces, first.first_face, last.first_face);
    for (auto piece = reader.next_piece(); !piece.empty(); piece = reader.next_piece()) {
        for (const CellTriple& face : piece) {
            const CellTriple mapped{cluster_of(face[0]), cluster_of(face[1]), cluster_of(face[2])};
            if (mapped[0] != mapped[1] && mapped[1] != mapped[2] && mapped[0] != mapped[2]) {
                block.faces.push_back(mapped);
            } else if (with_links) {
                const auto [low, high] = std::minmax({mapped[0], mapped[1], mapped[2]});
                if (low != high) block.links.push_back({low, high});
            }
        }
    }
    std::sort(block.links.begin(), block.links.end());
    block.links.erase(std::unique(block.links.begin(), block.links.end()), block.links.end());
}

/// Second sweep.
void add_faces(ooc::Context& context, const CellBlocks& blocks, ClusterMesh& mesh) {
    const BlocksInFlight in_flight(context, "faces of a block",
                                   BlockFaces::bytes_for(LargestBlock(blocks)));
    in_flight.sweep<BlockFaces>(
        blocks.n_blocks(),
        [&](std::uint64_t b, BlockFaces& block) {
            map_faces(blocks, b, mesh.cluster_of_cell, mesh.has_links, block);
        },
        [&](std::uint64_t b, const BlockFaces& block) {
            mesh.blocks[b].first_face = mesh.faces.size();
            mesh.faces.append(block.faces);
            mesh.blocks[b].first_link = mesh.links.size();
            mesh.links.append(block.links);
        });
}

}  // namespace

ClusterMesh build_cluster_mesh(ooc::Context& context, const CellBlocks& blocks,
                               const GroupCells& group_cells) {
    ClusterMesh mesh;
    // The middle of the grid keeps the coordinates that enter the quadrics small.
    const double half = std::floor(blocks.grid.resolution() / 2);
    mesh.origin = {half, half, half};
    mesh.is_closed = blocks.n_border_cells == 0;
    mesh.vertices = {context, "cluster vertices"};
    mesh.n_cells = {context, "cells of clusters"};
    mesh.attributes = {context, kinds_of(blocks)};
    mesh.faces = {context, "cluster faces"};
    mesh.links = {context, "cluster links"};
    mesh.blocks.resize(blocks.n_blocks() + 1);
    mesh.cluster_of_cell = {context, "clusters of cells"};
    add_vertices(context, blocks, group_cells, mesh);
    mesh.has_links =
        mesh.is_closed && blocks.has_vertex_cells && mesh.n_clusters() < blocks.n_cells();
    add_faces(context, blocks, mesh);
    mesh.blocks.back() = {{}, mesh.vertices.size(), mesh.faces.size(), mesh.links.size()};
    return mesh;
}

ClusterMesh cells_as_clusters(ooc::Context& context, const CellBlocks& blocks) {
    return build_cluster_mesh(context, blocks, [&](std::size_t b, CellGroups& groups) {
        groups.begins.resize(blocks.blocks[b + 1].first_cell - blocks.blocks[b].first_cell);
        std::iota(groups.begins.begin(), groups.begins.end(), LocalCell{0});
    });
}

}  // namespace hewer::rsimp
