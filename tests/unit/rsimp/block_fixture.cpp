// SPDX-License-Identifier: MIT
#include "block_fixture.h"

#include <algorithm>
#include <span>

namespace hewer::rsimp {

namespace {

template <typename T>
void add_bytes(std::vector<char>& bytes, const T& value) {
    const auto* first = reinterpret_cast<const char*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof(T));
}

template <typename T>
void add_spool(std::vector<char>& bytes, const ooc::Spool<T>& spool) {
    add_bytes(bytes, spool.size());
    if (spool.empty()) return;
    for (const T& record : contents(spool)) add_bytes(bytes, record);
}

}  // namespace

void BlockFixture::sort_faces() {
    std::vector<CellTriple> faces = contents(blocks.faces);
    for (std::size_t b = 0; b + 1 < blocks.blocks.size(); ++b) {
        std::sort(faces.begin() + static_cast<std::ptrdiff_t>(blocks.blocks[b].first_face),
                  faces.begin() + static_cast<std::ptrdiff_t>(blocks.blocks[b + 1].first_face));
    }
    blocks.faces = {*context, "faces"};
    blocks.faces.append(faces);
}

void BlockFixture::add_attributes() {
    test::Random random(7);
    blocks.attributes = {*context, "attributes"};
    for (std::uint64_t i = 0; i < blocks.n_cells(); ++i) {
        cluster::CellAttributes a{};
        const auto any = [&] { return static_cast<float>(random.between(-1, 1)); };
        for (float& x : a.normal) x = any();
        for (float& x : a.face_normal) x = any();
        for (float& x : a.color) x = any();
        a.n_colors = 1;
        blocks.attributes.push(a);
    }
}

std::vector<char> snapshot(const ClusterMesh& mesh) {
    std::vector<char> bytes;
    add_bytes(bytes, mesh.origin);
    add_bytes(bytes, mesh.is_closed);
    for (const ClusterMesh::Block& block : mesh.blocks) {
        add_bytes(bytes, block.box.code);
        add_bytes(bytes, block.box.shift);
        add_bytes(bytes, block.first_cluster);
        add_bytes(bytes, block.first_face);
    }
    add_spool(bytes, mesh.vertices);
    add_spool(bytes, mesh.n_cells);
    add_spool(bytes, mesh.attributes.sums);
    add_spool(bytes, mesh.faces);
    return bytes;
}

std::vector<CellTriple> sorted_faces(const ClusterMesh& mesh, std::size_t block) {
    const std::uint64_t first = mesh.blocks[block].first_face;
    std::vector<CellTriple> faces(mesh.blocks[block + 1].first_face - first);
    mesh.faces.read(first, std::span(faces));
    std::sort(faces.begin(), faces.end());
    return faces;
}

}  // namespace hewer::rsimp
