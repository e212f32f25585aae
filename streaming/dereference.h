// SPDX-License-Identifier: MIT
/// The triangles of a source as points, whether it is indexed or not, in bounded memory.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "hewer/mesh_source.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "ooc/parallel.h"
#include "ooc/spool.h"
#include "streaming/corner_join.h"
#include "streaming/vertex_cache.h"

namespace hewer::streaming {

/// Whether triangles that are near each other in a file use vertices that are.
enum class Coherence { Unknown, Coherent, Scattered };

/// Streams the triangles of a mesh with the points of their corners.
///
/// Encoder: `Point` is what a vertex becomes, trivially copyable; `encode(Vec3)` makes one, also of
/// what is not finite; `is_absent(Point)` says that it was not. Triangles with an absent corner are
/// left out.
///
/// Where vertices are while triangles pass: all in memory if `memory_bytes` are enough; else each
/// worker has lines of them in a VertexCache, read from the source (from a spool, if the source
/// cannot seek). A file whose triangles use vertices all over it makes the lines come and go: if it
/// is not known to be coherent and far more vertices have been loaded than a coherent file would
/// need, the pass starts over with an external join (CornerJoin).
///
/// Memory: `memory_bytes`, or for each worker kLeastLines lines of its cache if that is more; and a
/// batch for each worker. Throws: as the source does, OutOfMemoryBudget, OutOfDiskBudget,
/// Cancelled.
template <typename Encoder>
class Dereference {
  public:
    using Point = typename Encoder::Point;
    using Corners = std::array<Point, 3>;

    Dereference(ooc::Context& context, MeshSource& source, Encoder encoder,
                std::uint64_t memory_bytes, Coherence coherence = Coherence::Unknown)
        : context_(context),
          source_(source),
          encoder_(std::move(encoder)),
          memory_bytes_(memory_bytes),
          coherence_(coherence) {}

    /// One pass: body(worker, points, ids) for the triangles of each batch, on all threads; `ids`
    /// is empty for a soup. begin() comes first, and again should the pass have to start over.
    template <typename Begin, typename Body>
    void for_batches(const Begin& begin, const Body& body) {
        begin();
        if (!source_.info().is_indexed) {
            stream_soup(body);
            return;
        }
        const std::uint64_t n = source_.info().n_vertices;
        if (n * sizeof(Point) <= memory_bytes_) {
            stream_resident(body);
            return;
        }
        ooc::Spool<Point> spooled;
        if (source_.can_seek_vertices()) {
            source_.begin_vertices();
        } else {
            spooled = spool_vertices();
        }
        const LoadVertices<Point> load = [&](std::uint64_t first, std::uint64_t count, Point* out) {
            if (!spooled.empty()) {
                spooled.read(first, std::span<Point>(out, count));
                return;
            }
            VertexBatch batch;
            source_.read_vertices(first, count, batch);
            for (std::uint64_t i = 0; i < count; ++i) out[i] = encoder_.encode(batch.positions[i]);
        };
        if (coherence_ != Coherence::Scattered) {
            if (stream_cached(load, body)) return;
            coherence_ = Coherence::Scattered;
            begin();
        }
        stream_joined(load, body);
    }

    /// One pass on the calling thread, in the order of the file: what body() has seen stays seen,
    /// so a file that is not known to be coherent is joined where memory does not hold it.
    template <typename Body>
    void for_batches_in_order(const Body& body) {
        is_in_order_ = true;
        if (coherence_ == Coherence::Unknown) coherence_ = Coherence::Scattered;
        for_batches([] {}, body);
    }

    /// What the passes so far have shown: for other passes over the source with no less memory,
    /// none of which will start over, then.
    [[nodiscard]] Coherence coherence() const {
        return coherence_ == Coherence::Scattered ? coherence_ : Coherence::Coherent;
    }

  private:
    /// What of a batch is left after its absent corners.
    struct Batch {
        TriangleBatch read;
        std::vector<Corners> points;
        std::size_t n = 0;

        void keep(const Corners& corners, const Triangle& ids, const Encoder& encoder) {
            for (const Point& p : corners) {
                if (encoder.is_absent(p)) return;
            }
            points[n] = corners;
            read.corners[n++] = ids;  // never ahead of what is read
        }
    };

    template <typename Body>
    void hand_over(unsigned worker, Batch& batch, const Body& body) {
        body(worker, std::span<const Corners>(batch.points).first(batch.n),
             std::span<const Triangle>(batch.read.corners)
                 .first(source_.info().is_indexed ? batch.n : 0));
        context_.advance(batch.read.n_faces);
    }

    /// stream(worker) on all threads, or on this one.
    template <typename Stream>
    void on_workers(const Stream& stream) {
        if (is_in_order_) {
            stream(0U);
        } else {
            context_.workers().on_each(stream);
        }
    }

    template <typename Body>
    void stream_soup(const Body& body) {
        source_.begin_triangles();
        on_workers([&](unsigned worker) {
            Batch batch;
            while (source_.next_triangles(batch.read)) {
                batch.n = batch.read.points.size();
                batch.points.resize(batch.n);
                for (std::size_t i = 0; i < batch.n; ++i) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        batch.points[i][c] = encoder_.encode(batch.read.points[i][c]);
                    }
                }
                hand_over(worker, batch, body);
            }
        });
    }

    /// `corners(t, out)` finds the points of a triangle; next(batch) the next batch.
    template <typename Next, typename Find, typename Body>
    void stream_batches(unsigned worker, const Next& next, const Find& find, const Body& body) {
        Batch batch;
        while (next(batch)) {
            batch.n = 0;
            batch.points.resize(batch.read.corners.size());
            for (std::size_t i = 0; i < batch.points.size(); ++i) {
                batch.keep(find(batch, i), batch.read.corners[i], encoder_);
            }
            hand_over(worker, batch, body);
        }
    }

    template <typename Body>
    void stream_resident(const Body& body) {
        ooc::Array<Point> points(context_.budget(), "vertices", source_.info().n_vertices);
        source_.begin_vertices();
        context_.workers().on_each([&](unsigned) {
            VertexBatch batch;
            while (source_.next_vertices(batch)) {
                for (std::size_t i = 0; i < batch.positions.size(); ++i) {
                    points[batch.first + i] = encoder_.encode(batch.positions[i]);
                }
                context_.check_stop();
            }
        });
        source_.begin_triangles();
        on_workers([&](unsigned worker) {
            stream_batches(
                worker, [&](Batch& batch) { return source_.next_triangles(batch.read); },
                [&](const Batch& batch, std::size_t i) {
                    const Triangle& t = batch.read.corners[i];
                    return Corners{points[t[0]], points[t[1]], points[t[2]]};
                },
                body);
        });
    }

    /// False if the file is incoherent.
    template <typename Body>
    bool stream_cached(const LoadVertices<Point>& load, const Body& body) {
        std::atomic<bool> is_thrashing{false};
        source_.begin_triangles();
        on_workers([&](unsigned worker) {
            VertexCache<Point> cache(context_, source_.info().n_vertices, load,
                                     memory_bytes_ / context_.n_threads());
            std::uint64_t n_seen = 0;
            stream_batches(
                worker,
                [&](Batch& batch) {
                    // Half a vertex each would do; the edges of a batch and several workers make it
                    // more.
                    constexpr std::uint64_t kMostPerTriangle = 12;
                    if (coherence_ == Coherence::Unknown &&
                        cache.n_loads() > kMostPerTriangle * n_seen + 8 * cache.capacity()) {
                        is_thrashing = true;
                    }
                    if (is_thrashing || !source_.next_triangles(batch.read)) return false;
                    n_seen += batch.read.corners.size();
                    return true;
                },
                [&](const Batch& batch, std::size_t i) {
                    const Triangle& t = batch.read.corners[i];
                    Corners corners;
                    for (std::size_t c = 0; c < 3; ++c) corners[c] = cache.at(t[c]);
                    return corners;
                },
                body);
        });
        return !is_thrashing;
    }

    template <typename Body>
    void stream_joined(const LoadVertices<Point>& load, const Body& body) {
        CornerJoin<Point> join(context_, source_, load, memory_bytes_);
        on_workers([&](unsigned worker) {
            stream_batches(
                worker, [&](Batch& batch) { return join.next(batch.read, batch.points); },
                [](const Batch& batch, std::size_t i) { return batch.points[i]; }, body);
        });
    }

    ooc::Spool<Point> spool_vertices() {
        ooc::Spool<Point> spool(context_, "vertices");
        source_.begin_vertices();
        VertexBatch batch;
        std::vector<Point> points;
        // One thread: batches have to come in order. Sources that cannot seek are slow to parse
        // anyway.
        while (source_.next_vertices(batch)) {
            points.clear();
            for (const Vec3& p : batch.positions) points.push_back(encoder_.encode(p));
            spool.append(points);
            context_.check_stop();
        }
        return spool;
    }

    ooc::Context& context_;
    MeshSource& source_;
    Encoder encoder_;
    std::uint64_t memory_bytes_;
    Coherence coherence_;
    bool is_in_order_ = false;
};

}  // namespace hewer::streaming
