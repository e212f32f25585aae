// SPDX-License-Identifier: MIT
/// A level of detail that waits in memory for the verdict on it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "fidelity/pull_to_points.h"
#include "hewer/mesh_sink.h"
#include "hewer/mesh_source.h"

namespace hewer::fidelity {

/// Takes a mesh as a sink does, shows it as a source, and gives it away. Not moved while sink() or
/// source() are alive.
class KeptMesh {
  public:
    /// Of memory, with the vertices of a closed surface, their normals and colours, and room for
    /// repairs.
    static constexpr std::uint64_t kBytesPerTriangle = 48;

    [[nodiscard]] std::unique_ptr<MeshSink> sink();
    [[nodiscard]] std::unique_ptr<MeshSource> source(const std::string& name) const {
        return view_mesh(mesh_, name);
    }
    void write(MeshSink& sink) const;
    /// The mesh may have other vertices and triangles afterwards. No source() is alive.
    PullReport pull(std::span<const Pull> pulls);
    [[nodiscard]] const Mesh& mesh() const { return mesh_; }
    [[nodiscard]] const Bounds& bounds() const { return header_.bounds; }

  private:
    class Sink;
    SinkHeader header_;
    Mesh mesh_;
};

}  // namespace hewer::fidelity
