// SPDX-License-Identifier: MIT
/// Triangle strips, as old Stanford scans have them.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <utility>

#include "hewer/mesh_source.h"
#include "streaming/ply_rows.h"
#include "streaming/triangle_fan.h"

namespace hewer::streaming {

/// Turns the ids of a strip into triangles: each new id makes one with the two before it, every
/// second one turned round so that all face the same way.
class StripDecoder {
  public:
    void restart() { n_ids_ = 0; }

    /// True if `id` completes a triangle. Repeated ids only stitch a strip: they make none.
    bool push(std::uint64_t id, Triangle& triangle) {
        const bool is_turned = (n_ids_ & 1U) != 0;
        const bool is_complete = ++n_ids_ > 2 && a_ != b_ && b_ != id && a_ != id;
        if (is_complete) triangle = is_turned ? Triangle{b_, a_, id} : Triangle{a_, b_, id};
        a_ = std::exchange(b_, id);
        return is_complete;
    }

  private:
    std::uint64_t n_ids_ = 0;
    std::uint64_t a_ = 0;
    std::uint64_t b_ = 0;
};

/// Reads the triangles of all strips; -1 inside a list begins a new strip, as does a new row.
/// A strip has no place to begin in but its start, so decoding goes on in sequence, under a lock.
/// Memory: a window of the file, however long the strips are. Thread-safe.
template <typename Stream>
class StripReader {
  public:
    explicit StripReader(ListItems<Stream> ids) : ids_(std::move(ids)) {}

    /// Finds the next triangle, valid or not. False at the end.
    bool next(Triangle& triangle) {
        std::int64_t id = 0;
        while (ids_.next(id)) {
            if (id < 0) {
                strip_.restart();
            } else if (strip_.push(static_cast<std::uint64_t>(id), triangle)) {
                return true;
            }
        }
        return false;
    }

    /// Fills batch.corners; faces are numbered by triangle. `place` is where the first triangle
    /// with an id outside the vertices was met.
    bool next(TriangleBatch& batch, std::uint64_t n_vertices, FaceFindings& findings,
              std::string& place) {
        constexpr std::uint64_t kBatch = 16384;
        const std::lock_guard lock(mutex_);
        batch.first_face = n_triangles_;
        batch.corners.clear();
        Triangle t{};
        for (batch.n_faces = 0; batch.n_faces < kBatch && next(t); ++batch.n_faces) {
            if (std::max({t[0], t[1], t[2]}) < n_vertices) {
                batch.corners.push_back(t);
            } else if (findings.n_out_of_range++ == 0) {
                findings.first_out_of_range_row = batch.n_faces;
                place = ids_.stream().place();
            }
        }
        n_triangles_ += batch.n_faces;
        return batch.n_faces > 0;
    }

  private:
    std::mutex mutex_;
    ListItems<Stream> ids_;
    StripDecoder strip_;
    std::uint64_t n_triangles_ = 0;
};

}  // namespace hewer::streaming
