// SPDX-License-Identifier: MIT
#include "cluster/vertex_join.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "cluster/vertex_pages.h"
#include "ooc/array.h"
#include "ooc/parallel.h"

namespace hewer::cluster {

namespace {

constexpr std::uint64_t kPiece = 1 << 14;

/// Vertices [first, first + n) into memory, on all threads.
void load_range(ooc::Context& context, MeshSource& source, const ooc::Spool<LatticePoint>& spooled,
                const Lattice& lattice, std::uint64_t first, std::uint64_t n,
                ooc::Array<LatticePoint>& points) {
    context.workers().for_ranges(n, kPiece, [&](std::uint64_t begin, std::uint64_t end) {
        if (!spooled.empty()) {
            spooled.read(first + begin,
                         std::span<LatticePoint>(points.data() + begin, end - begin));
            return;
        }
        VertexBatch batch;
        source.read_vertices(first + begin, end - begin, batch);
        for (std::uint64_t i = begin; i < end; ++i) {
            const Vec3& p = batch.positions[i - begin];
            points[i] = std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])
                            ? lattice.encode(p)
                            : VertexPages::kNotFinite;
        }
        context.check_stop();
    });
}

}  // namespace

PartitionFindings join_vertices(ooc::Context& context, MeshSource& source,
                                const ooc::Spool<LatticePoint>& spooled, const Lattice& lattice,
                                std::uint64_t range_bytes, TrianglePartition& partition) {
    const std::uint64_t n_vertices = source.info().n_vertices;
    const std::uint64_t per_range = std::clamp<std::uint64_t>(range_bytes / sizeof(LatticePoint),
                                                              kPiece, std::uint64_t{1} << 31);
    const std::uint64_t n_ranges = (n_vertices + per_range - 1) / per_range;

    std::vector<ooc::Spool<std::uint32_t>> numbers;
    for (std::uint64_t r = 0; r < n_ranges; ++r) numbers.emplace_back(context, "corners");
    {
        std::vector<std::vector<std::uint32_t>> waiting(n_ranges);
        source.begin_triangles();
        TriangleBatch batch;
        // One thread: what is in a bucket must have the order of the corners.
        while (source.next_triangles(batch)) {
            for (const Triangle& t : batch.corners) {
                for (const std::uint64_t v : t) {
                    const std::uint64_t r = v / per_range;
                    waiting[r].push_back(static_cast<std::uint32_t>(v - r * per_range));
                }
            }
            for (std::uint64_t r = 0; r < n_ranges; ++r) {
                numbers[r].append(waiting[r]);
                waiting[r].clear();
            }
            context.advance(batch.n_faces);
        }
    }
    std::vector<ooc::Spool<LatticePoint>> points;
    for (std::uint64_t r = 0; r < n_ranges; ++r) {
        const std::uint64_t first = r * per_range;
        ooc::Array<LatticePoint> range(context.budget(), "a range of vertices",
                                       std::min(per_range, n_vertices - first));
        load_range(context, source, spooled, lattice, first, range.size(), range);
        points.emplace_back(context, "points of corners");
        const ooc::Spool<std::uint32_t>& bucket = numbers[r];
        context.workers().in_order(
            (bucket.size() + kPiece - 1) / kPiece, 2 * context.n_threads(),
            [&](std::uint64_t p) {
                std::vector<std::uint32_t> of(std::min(kPiece, bucket.size() - p * kPiece));
                bucket.read(p * kPiece, of);
                std::vector<LatticePoint> found;
                found.reserve(of.size());
                for (const std::uint32_t v : of) found.push_back(range[v]);
                context.check_stop();
                return found;
            },
            [&](std::uint64_t, const std::vector<LatticePoint>& found) {
                points[r].append(found);
            });
        numbers[r].release();
    }

    PartitionFindings findings;
    std::vector<ooc::SpoolReader<LatticePoint>> readers;
    for (const auto& bucket : points) readers.emplace_back(bucket);
    source.begin_triangles();
    TriangleBatch batch;
    std::uint64_t n_batches = 0;
    while (source.next_triangles(batch)) {
        for (const Triangle& t : batch.corners) {
            LatticeTriangle triangle;
            bool is_usable = true;
            for (std::size_t c = 0; c < 3; ++c) {
                triangle[c] = *readers[t[c] / per_range].next();
                is_usable &= triangle[c] != VertexPages::kNotFinite;
            }
            if (is_usable) {
                partition.add(triangle);
            } else {
                ++batch.defects.nonfinite_triangles;
            }
        }
        findings.defects.merge(batch.defects);
        context.advance(batch.n_faces);
        constexpr std::uint64_t kBatchesBetween = 256;
        if (++n_batches % kBatchesBetween == 0) {
            for (std::uint64_t r = 0; r < n_ranges; ++r) {
                points[r].discard_before(readers[r].position());
            }
        }
    }
    partition.finish();
    return findings;
}

}  // namespace hewer::cluster
