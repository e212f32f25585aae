// SPDX-License-Identifier: MIT
/// Block meshes put away, to be loaded again one by one or several as one.
#pragma once

#include <cstdint>
#include <vector>

#include "ooc/context.h"
#include "ooc/spool.h"
#include "rsimp/block_mesh.h"

namespace hewer::rsimp {

class PieceStore {
  public:
    PieceStore(ooc::Context& context, AttributeKinds attributes);

    /// Pieces come in the order of their vertex ids.
    void append(const BlockMesh& piece);
    [[nodiscard]] std::size_t size() const { return pieces_.size() - 1; }
    [[nodiscard]] std::uint64_t n_vertices(std::size_t piece) const {
        return pieces_[piece + 1].first_vertex - pieces_[piece].first_vertex;
    }
    [[nodiscard]] std::uint64_t n_faces(std::size_t piece) const {
        return pieces_[piece + 1].first_face - pieces_[piece].first_face;
    }
    [[nodiscard]] std::uint64_t n_faces() const { return pieces_.back().first_face; }
    [[nodiscard]] AttributeKinds attributes() const { return attributes_.kinds(); }
    /// The pieces [first, last) as one mesh. Any thread.
    [[nodiscard]] BlockMesh load(std::size_t first, std::size_t last) const;

  private:
    struct Piece {
        std::uint64_t first_vertex = 0;
        std::uint64_t first_face = 0;
    };
    ooc::Spool<StoredVertex> vertices_;
    AttributeSpools attributes_;
    ooc::Spool<LocalFace> faces_;  // corners count from the piece's first vertex
    std::vector<Piece> pieces_;    // and one more at the end, with the totals
};

}  // namespace hewer::rsimp
