// SPDX-License-Identifier: MIT
/// A mesh on its way into Draco data: for .drc files and for compressed glTF.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "hewer/mesh_sink.h"

namespace hewer::streaming {

/// Holds the whole mesh, as the library's encoder wants it. Positions are stored relative to
/// `origin`. Colours go in with 16 bits as they are given. The encoder orders points and faces as
/// it likes, and drops what is degenerate.
/// Memory: DracoEncoder::bytes(), encode() included; measured on closed meshes, rounded up.
class DracoEncoder {
  public:
    static std::uint64_t bytes(const SinkHeader& header) {
        return 200 * header.n_triangles + 100 * header.n_vertices;
    }

    DracoEncoder(const SinkHeader& header, const Vec3& origin);
    ~DracoEncoder();
    DracoEncoder(DracoEncoder&&) noexcept;
    DracoEncoder& operator=(DracoEncoder&&) = delete;

    void add_vertices(const VertexSpan& vertices);
    void add_triangles(std::span<const Triangle> triangles);

    struct Encoded {
        std::vector<char> bytes;
        std::uint64_t n_points = 0;
        std::uint64_t n_faces = 0;
        std::uint32_t position_id = 0;
        std::uint32_t normal_id = 0;
        std::uint32_t color_id = 0;
    };
    /// Positions with so many bits on the longest side of the box; 0: exact floats. Normals keep 10
    /// bits. Once. Throws InternalError if the library refuses.
    Encoded encode(unsigned position_bits);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace hewer::streaming
