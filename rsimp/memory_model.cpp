// SPDX-License-Identifier: MIT
#include "rsimp/memory_model.h"

#include <algorithm>
#include <bit>
#include <string>

#include "cluster/cell_record.h"
#include "cluster/cell_runs.h"
#include "cluster/cell_sums.h"
#include "cluster/triangle_partition.h"
#include "hewer/error.h"
#include "ooc/context.h"
#include "ooc/memory_budget.h"
#include "ooc/page_evictor.h"
#include "ooc/units.h"
#include "rsimp/copy.h"
#include "rsimp/fit_samples.h"
#include "rsimp/grid_choice.h"
#include "rsimp/mesh_store.h"
#include "rsimp/vertex_attributes.h"
#include "streaming/weld.h"

namespace hewer::rsimp {

namespace {

using cluster::CellAttributeQuadric;
using cluster::CellAttributes;
using cluster::CellExtras;
using cluster::CellRecord;
using cluster::CellSums;

// Triangles between cells, and between clusters, of a closed surface; a little more where it is
// rough.
constexpr double kFacesPerCell = 2.1;

// Of a cell while close parts are joined: where it went, the set that it is in, its share of cubes.
constexpr std::uint64_t kJoinBytes = 16;

constexpr std::uint64_t kBuffers = 8 << 20;
constexpr std::uint64_t kIndexBytes = 34;  // of the table of cells, for each
constexpr std::uint64_t kOrderBytes = 16;  // of a cell's place among the others

std::uint64_t faces_of(std::uint64_t n) {
    return static_cast<std::uint64_t>(kFacesPerCell * static_cast<double>(n));
}

CellExtras extras_of(const MemoryCounts& n) {
    return {n.has_attributes, n.has_weights};
}

/// Of a vertex.
std::uint64_t attribute_bytes(const MemoryCounts& n) {
    return AttributeKinds{n.has_attributes, n.has_attribute_quadrics}.bytes();
}

/// Of a cell. The weights are gone before there are quadrics.
std::uint64_t cell_attribute_bytes(const MemoryCounts& n) {
    return (n.has_attributes ? sizeof(CellAttributes) : 0) +
           std::max(n.has_attribute_quadrics ? sizeof(CellAttributeQuadric) : 0,
                    n.has_weights ? sizeof(float) : 0);
}

/// Cells in blocks, on spools.
std::uint64_t blocks_bytes(const MemoryCounts& n) {
    return n.cells * (sizeof(std::uint64_t) + sizeof(CellRecord) + cell_attribute_bytes(n) +
                      (n.has_feedback ? sizeof(float) : 0)) +
           faces_of(n.cells) * sizeof(cluster::CellTriple);
}

/// Clusters, their faces and, where cells are vertices, their links, on spools.
std::uint64_t cluster_bytes(const MemoryCounts& n) {
    const std::uint64_t links = n.method == Method::Full ? 3 * sizeof(ClusterMesh::Link) : 0;
    return n.clusters *
               (sizeof(CollapseVertex) + sizeof(std::uint32_t) + links + attribute_bytes(n)) +
           faces_of(n.clusters) * sizeof(cluster::CellTriple);
}

/// The same as mesh pieces of the finishing collapse.
std::uint64_t piece_bytes(const MemoryCounts& n) {
    return n.clusters * (sizeof(StoredVertex) + attribute_bytes(n)) +
           faces_of(n.clusters) * sizeof(cluster::CellTriple);
}

std::uint64_t lod_bytes(const MemoryCounts& n) {
    return n.lod_vertices * (sizeof(StoredVertex) + attribute_bytes(n) + 2 * sizeof(Face));
}

/// Between cells and clusters: blocks, their cuts, the clusters of the cells.
std::uint64_t refine_bytes(const MemoryCounts& n) {
    return blocks_bytes(n) + n.cells * 6 + n.clusters * 10 + cluster_bytes(n);
}

/// What the fit, and who looks for folded faces, sees of the original.
std::uint64_t sample_bytes(const MemoryCounts& n) {
    const bool is_sparse = has_few_cells(n.method, n.cells, static_cast<double>(n.lod_vertices));
    return (is_sparse ? faces_of(n.cells) : n.cells) * sizeof(FitSample);
}

std::uint64_t finish_bytes(const MemoryCounts& n) {
    // Cells may still be asked for finer clusters while these become pieces; feedback needs them
    // until there is a mesh.
    const std::uint64_t begin = blocks_bytes(n) + cluster_bytes(n) + piece_bytes(n);
    const std::uint64_t run = (n.has_feedback ? blocks_bytes(n) : 0) + sample_bytes(n) +
                              piece_bytes(n) + n.clusters * 20 + lod_bytes(n);
    return std::max(begin, run);
}

/// An LOD, two positions and moves of its vertices, and the vertices where they end. Without a fit
/// they have positions, and end, where folded faces are turned back.
std::uint64_t fit_bytes(const MemoryCounts& n) {
    return sample_bytes(n) + lod_bytes(n) +
           n.lod_vertices * ((n.has_fit ? 4 : 1) * sizeof(Vec3) + sizeof(StoredVertex));
}

std::uint64_t sums_bytes(const MemoryCounts& n) {
    return sizeof(CellSums) + extras_of(n).bytes();
}

bool has_resident_vertices(const MemoryCounts& n, std::uint64_t limit) {
    return 16 * n.vertices <= limit / kResidentShare;
}

/// The vertices while the triangles are read: all, or a window over them.
std::uint64_t vertex_bytes(const MemoryCounts& n, std::uint64_t limit) {
    return has_resident_vertices(n, limit) ? 16 * n.vertices : limit / kWindowShare;
}

/// Method::Copy: the sets of vertices or, of a soup, of corners, and the components that the
/// topology counter keeps.
std::uint64_t least_copy_bytes(const SourceInfo& info, unsigned n_threads) {
    // How many a soup has nobody knows before it is sorted: half as many as faces, if it is closed.
    const std::uint64_t n_vertices =
        info.is_indexed ? info.n_vertices : info.n_faces / 2 + info.n_faces / 8;
    const std::uint64_t sets =
        info.is_indexed ? copy_bytes(n_vertices) : streaming::Weld::bytes(info.n_faces);
    constexpr std::uint64_t kBuffersOfCopy = 24ULL << 20;
    const std::uint64_t topology = n_vertices * (n_vertices >> 32 == 0 ? 4 : 8) + n_vertices / 8;
    return ooc::MemoryBudget::kFixedBytes + kBuffersOfCopy + n_threads * kCopyBatchBytes + sets +
           topology;
}

}  // namespace

std::uint64_t least_memory_bytes(const MemoryCounts& n) {
    // Blocks of cells and of the mesh at work, their results, buffers of merges, tails of spools;
    // the table of pages of the vertices; ranks and components of the vertices of a level of
    // detail.
    const std::uint64_t blocks =
        ((n.has_attributes ? 40ULL : 30ULL) + (n.has_attribute_quadrics ? 40ULL : 0ULL)) << 20;
    const std::uint64_t per_thread = 4ULL << 20;
    return ooc::MemoryBudget::kFixedBytes + blocks + n.n_threads * per_thread + n.vertices / 12 +
           n.lod_vertices * 5 + n.clusters / 4 + (n.joins_parts ? n.cells * kJoinBytes : 0);
}

void count_attributes(const SimplifyOptions& options, const SourceInfo& info,
                      MemoryCounts& counts) {
    counts.method = options.method;
    counts.has_attributes =
        info.has_normals || info.has_colors || options.priority == SplitPriority::NormalVariation;
    counts.has_weights = info.has_weights && info.is_indexed;
    counts.has_attribute_quadrics = (info.has_colors && options.color_weight > 0) ||
                                    (info.has_normals && options.normal_weight > 0);
}

std::uint64_t least_limit(const SimplifyOptions& options, const SourceInfo& info) {
    constexpr std::uint64_t kMiB = 1 << 20;
    if (options.method == Method::Copy) {
        return (least_copy_bytes(info, ooc::thread_count(options.n_threads)) / kMiB + 1) * kMiB;
    }
    MemoryCounts counts;
    counts.vertices = info.is_indexed ? info.n_vertices : 0;
    counts.n_threads = ooc::thread_count(options.n_threads);
    count_attributes(options, info, counts);
    if (!options.targets.empty()) {
        const auto most = static_cast<double>(info.is_indexed ? info.n_vertices : 3 * info.n_faces);
        const double vertices =
            std::min(most, target_vertices(options.targets.front(), info.n_faces));
        counts.lod_vertices = static_cast<std::uint64_t>(vertices);
        counts.clusters =
            static_cast<std::uint64_t>(clusters_per_vertex(options.method) * vertices);
    }
    if (options.aggregate) {
        counts.joins_parts = true;
        const std::uint64_t most = info.is_indexed ? info.n_vertices : info.n_faces;
        counts.cells =
            options.method == Method::Full
                ? most
                : std::min(most, static_cast<std::uint64_t>(wanted_cells(
                                     options.method, static_cast<double>(counts.lod_vertices),
                                     info.n_faces)));
    }
    if (options.topology == Topology::Keep) {
        // Every vertex is a cluster, and the mesh of all of them is counted.
        counts.clusters = info.is_indexed ? info.n_vertices : info.n_faces;
        counts.lod_vertices = counts.clusters;
    }
    return (least_memory_bytes(counts) / kMiB + 1) * kMiB;
}

void require_memory(const SimplifyOptions& options, const SourceInfo& info) {
    const std::uint64_t limit =
        options.memory_bytes != 0 ? options.memory_bytes : ooc::default_memory_limit();
    const std::uint64_t least = least_limit(options, info);
    if (least <= limit) return;
    const std::string number = std::to_string(least >> 20) + " MiB";
    throw OutOfMemoryBudget(info.name + ": needs " + number + " at least, the limit is " +
                            ooc::format_bytes(limit) + "; raise --memory to " + number +
                            " or more");
}

std::uint64_t ample_memory_bytes(const MemoryCounts& n, std::uint64_t limit) {
    const std::uint64_t sums = n.cells * sums_bytes(n);
    const std::uint64_t table = 12 * std::bit_ceil(n.cells * 3 / 2 + 1);
    const std::uint64_t triples = faces_of(n.cells) * sizeof(cluster::CellTriple);
    const std::uint64_t accumulate = vertex_bytes(n, limit) + table + sums + triples;
    // Order, ranks and codes of the cells, and their records, beside the sums.
    const std::uint64_t build = sums + n.cells * (16 + 4 + 4) + blocks_bytes(n) + triples;
    return least_memory_bytes(n) / 2 +
           std::max({accumulate, build, refine_bytes(n), finish_bytes(n), fit_bytes(n)});
}

namespace {

/// The table of cells while the triangles are read.
struct Table {
    bool holds_all_cells;
    std::uint64_t n_held;  ///< cells, at most
    std::uint64_t kept;    ///< of its memory, while its cells go out
};

Table table_of(const MemoryCounts& n, std::uint64_t limit) {
    const std::uint64_t taken = ooc::MemoryBudget::kFixedBytes + slack_bytes(limit) +
                                vertex_bytes(n, limit) + limit / kSpareShare + kSpareBytes;
    const std::uint64_t bytes = limit - std::min(limit, taken);
    const double in_table = cluster::CellRuns::bytes_per_cell(extras_of(n));
    const auto n_held = static_cast<std::uint64_t>(
        std::min(static_cast<double>(n.cells), static_cast<double>(bytes) / in_table));
    return {n_held == n.cells, n_held, n_held * (sums_bytes(n) + kIndexBytes)};
}

}  // namespace

bool sorts_triangles(const MemoryCounts& n, std::uint64_t limit) {
    return n.triangles_out_of_order > 0 &&
           (!has_resident_vertices(n, limit) || !table_of(n, limit).holds_all_cells);
}

std::uint64_t temp_bytes(const MemoryCounts& n, std::uint64_t limit) {
    const auto beyond = [&](std::uint64_t bytes, std::uint64_t working) {
        const std::uint64_t taken = ooc::MemoryBudget::kFixedBytes + slack_bytes(limit) + working;
        return bytes - std::min(bytes, limit - std::min(limit, taken));
    };
    // A table that cannot hold all cells goes out in runs, which stay until the cells are merged.
    const Table table = table_of(n, limit);
    std::uint64_t merge = 0;
    std::uint64_t at_once = kBuffers;
    if (!table.holds_all_cells) {
        const std::uint64_t runs = n.cells * (sizeof(cluster::RunCell) + extras_of(n).bytes()) +
                                   faces_of(n.cells) * sizeof(cluster::CodeTriple);
        const std::uint64_t records = n.cells * (sizeof(CellRecord) + sizeof(std::uint64_t) +
                                                 (n.has_attributes ? sizeof(CellAttributes) : 0));
        // The table keeps its memory while the last run goes out; the vertices are there while
        // the others do.
        const std::uint64_t n_full = n.cells / std::max<std::uint64_t>(1, table.n_held);
        const double full_share =
            static_cast<double>(n_full * table.n_held) / static_cast<double>(n.cells);
        const auto full_runs = static_cast<std::uint64_t>(full_share * static_cast<double>(runs));
        merge = std::max(
            {runs + records, runs + table.kept, full_runs + table.kept + vertex_bytes(n, limit)});
    } else {
        merge = n.cells * (sums_bytes(n) + kOrderBytes) + blocks_bytes(n);
        at_once += limit / ooc::PageEvictor::kLeastShare;
    }
    const std::uint64_t sorted =
        sorts_triangles(n, limit) ? n.triangles_out_of_order * sizeof(cluster::LatticeTriangle) : 0;
    const std::uint64_t blocks = least_memory_bytes(n) / 2;
    return std::max({beyond(sorted, table.kept + kBuffers), beyond(merge, at_once),
                     beyond(refine_bytes(n), blocks), beyond(finish_bytes(n), blocks),
                     beyond(fit_bytes(n), blocks)});
}

}  // namespace hewer::rsimp
