// SPDX-License-Identifier: MIT
/// What decoding found, as counters of a batch or, in strict mode, as the error that it is there.
/// Each batch names the first place of its own; InputDefects::merge() keeps the lowest of all. In
/// strict mode the place is the first of some batch: on several threads not always the same one.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "hewer/mesh_source.h"
#include "streaming/triangle_fan.h"

namespace hewer::streaming {

class FindingsReporter {
  public:
    /// Where something is: "byte 1234" or "line 17".
    using Place = std::function<std::string()>;

    FindingsReporter(std::string path, bool is_strict)
        : path_(std::move(path)), is_strict_(is_strict) {}

    /// batch.defects counts non-finite vertices, the first of which is `vertex`.
    /// Throws FormatError if strict.
    void report_nonfinite(VertexBatch& batch, std::uint64_t vertex, const Place& place) const;

    /// Moves the findings into batch.defects. `place(row)` is asked for the rows that matter.
    /// Throws FormatError if strict and a face is short or out of range.
    void report_faces(const FaceFindings& findings, TriangleBatch& batch, std::uint64_t n_vertices,
                      const std::function<std::string(std::uint64_t)>& place) const;

    /// Soups: counts a dropped triangle. Throws FormatError if strict.
    void report_nonfinite(TriangleBatch& batch, std::uint64_t triangle, const Place& place) const;

  private:
    [[noreturn]] void refuse(const std::string& element, const std::string& what) const;

    std::string path_;
    bool is_strict_;
};

}  // namespace hewer::streaming
