// SPDX-License-Identifier: MIT
#include "rsimp/piece_store.h"

#include <span>

namespace hewer::rsimp {

PieceStore::PieceStore(ooc::Context& context, AttributeKinds attributes)
    : vertices_(context, "mesh vertices"),
      attributes_(context, attributes),
      faces_(context, "mesh faces"),
      pieces_(1) {}

void PieceStore::append(const BlockMesh& piece) {
    vertices_.append(piece.vertices);
    attributes_.append(piece.attributes);
    faces_.append(piece.faces);
    pieces_.push_back({vertices_.size(), faces_.size()});
}

BlockMesh PieceStore::load(std::size_t first, std::size_t last) const {
    BlockMesh mesh;
    const Piece& begin = pieces_[first];
    const Piece& end = pieces_[last];
    mesh.vertices.resize(end.first_vertex - begin.first_vertex);
    vertices_.read(begin.first_vertex, mesh.vertices);
    attributes_.read(begin.first_vertex, mesh.vertices.size(), mesh.attributes);
    mesh.faces.resize(end.first_face - begin.first_face);
    faces_.read(begin.first_face, mesh.faces);
    for (std::size_t p = first + 1; p < last; ++p) {
        const auto shift = static_cast<std::uint32_t>(pieces_[p].first_vertex - begin.first_vertex);
        const auto at = pieces_[p].first_face - begin.first_face;
        for (LocalFace& face : std::span(mesh.faces).subspan(at, n_faces(p))) {
            for (std::uint32_t& v : face) v += shift;
        }
    }
    return mesh;
}

}  // namespace hewer::rsimp
