// SPDX-License-Identifier: MIT
/// Triangles whose vertices are all over a file that memory does not hold: an external join.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

#include "hewer/mesh_source.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "ooc/parallel.h"
#include "ooc/spool.h"

namespace hewer::streaming {

/// load(first, n, out): the vertices first .. first + n - 1 as `Point`s; n at most 2^14. Called by
/// many threads at once.
template <typename Point>
using LoadVertices = std::function<void(std::uint64_t, std::uint64_t, Point*)>;

/// Every corner is a number; numbers are put into buckets by range of vertices, in the order of the
/// corners. Range by range, with its vertices in memory, a bucket's numbers become points in the
/// same order. A second pass over the triangles takes the points of its corners from the buckets,
/// each of which is read front to back: so nothing is sorted and no place is stored.
///
/// Two passes over the triangles (the second by next()) and one over the vertices. Disk: 4 bytes a
/// corner, then sizeof(Point); memory: sizeof(Point) a vertex of a range, `range_bytes` in all, and
/// a page for each range. Throws: as the source does, OutOfMemoryBudget, OutOfDiskBudget,
/// Cancelled.
template <typename Point>
class CornerJoin {
  public:
    CornerJoin(ooc::Context& context, MeshSource& source, const LoadVertices<Point>& load,
               std::uint64_t range_bytes)
        : source_(source),
          per_range_(std::clamp<std::uint64_t>(range_bytes / sizeof(Point), kPiece,
                                               std::uint64_t{1} << 31)) {
        std::vector<ooc::Spool<std::uint32_t>> numbers = sort_numbers(context);
        for (std::uint64_t r = 0; r < numbers.size(); ++r) {
            points_.push_back(find_points(context, load, r, numbers[r]));
            numbers[r].release();
        }
        for (const auto& bucket : points_) readers_.emplace_back(bucket);
        source.begin_triangles();
    }

    /// The next triangles in file order, and the points of their corners. Any thread.
    bool next(TriangleBatch& batch, std::vector<std::array<Point, 3>>& points) {
        const std::lock_guard lock(mutex_);
        if (!source_.next_triangles(batch)) return false;
        points.resize(batch.corners.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                points[i][c] = *readers_[batch.corners[i][c] / per_range_].next();
            }
        }
        constexpr std::uint64_t kBatchesBetween = 256;
        if (++n_batches_ % kBatchesBetween == 0) {
            for (std::size_t r = 0; r < points_.size(); ++r) {
                points_[r].discard_before(readers_[r].position());
            }
        }
        return true;
    }

  private:
    static constexpr std::uint64_t kPiece = 1 << 14;

    std::vector<ooc::Spool<std::uint32_t>> sort_numbers(ooc::Context& context) {
        const std::uint64_t n_ranges = (source_.info().n_vertices + per_range_ - 1) / per_range_;
        std::vector<ooc::Spool<std::uint32_t>> numbers;
        for (std::uint64_t r = 0; r < n_ranges; ++r) numbers.emplace_back(context, "corners");
        std::vector<std::vector<std::uint32_t>> waiting(n_ranges);
        source_.begin_triangles();
        TriangleBatch batch;
        // One thread: what is in a bucket must have the order of the corners.
        while (source_.next_triangles(batch)) {
            for (const Triangle& t : batch.corners) {
                for (const std::uint64_t v : t) {
                    const std::uint64_t r = v / per_range_;
                    waiting[r].push_back(static_cast<std::uint32_t>(v - r * per_range_));
                }
            }
            for (std::uint64_t r = 0; r < n_ranges; ++r) {
                numbers[r].append(waiting[r]);
                waiting[r].clear();
            }
            context.advance(batch.n_faces);
        }
        return numbers;
    }

    ooc::Spool<Point> find_points(ooc::Context& context, const LoadVertices<Point>& load,
                                  std::uint64_t r, const ooc::Spool<std::uint32_t>& numbers) {
        const std::uint64_t first = r * per_range_;
        ooc::Array<Point> range(context.budget(), "a range of vertices",
                                std::min(per_range_, source_.info().n_vertices - first));
        context.workers().for_ranges(range.size(), kPiece,
                                     [&](std::uint64_t begin, std::uint64_t end) {
                                         load(first + begin, end - begin, range.data() + begin);
                                         context.check_stop();
                                     });
        ooc::Spool<Point> points(context, "points of corners");
        context.workers().in_order(
            (numbers.size() + kPiece - 1) / kPiece, 2 * context.n_threads(),
            [&](std::uint64_t p) {
                std::vector<std::uint32_t> of(std::min(kPiece, numbers.size() - p * kPiece));
                numbers.read(p * kPiece, of);
                std::vector<Point> found;
                found.reserve(of.size());
                for (const std::uint32_t v : of) found.push_back(range[v]);
                context.check_stop();
                return found;
            },
            [&](std::uint64_t, const std::vector<Point>& found) { points.append(found); });
        return points;
    }

    MeshSource& source_;
    std::uint64_t per_range_;
    std::vector<ooc::Spool<Point>> points_;
    std::vector<ooc::SpoolReader<Point>> readers_;
    std::mutex mutex_;
    std::uint64_t n_batches_ = 0;
};

}  // namespace hewer::streaming
