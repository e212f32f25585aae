// SPDX-License-Identifier: MIT
#include "rsimp/mesh_merge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "tests/support/clustered_mesh.h"
#include "tests/support/shapes.h"

namespace hewer::rsimp {

namespace {

StoredVertex vertex_with(VertexId id) {
    StoredVertex vertex{};
    vertex.id = id;
    return vertex;
}

cluster::CellAttributes attributes_of(VertexId id) {
    cluster::CellAttributes attributes{};
    attributes.n_colors = static_cast<float>(id);
    return attributes;
}

/// A face for each vertex.
Face face_of(VertexId id) {
    return {id, id + 1, id + 2};
}

template <typename T>
std::vector<T> all_of(const ooc::Spool<T>& spool) {
    std::vector<T> records(spool.size());
    spool.read(0, records);
    return records;
}

/// Shares `n` vertices out among `n_parts`, in runs of up to `most_run`, and merges them.
void expect_merges(std::uint64_t n, std::size_t n_parts, std::uint64_t most_run,
                   std::uint64_t seed) {
    const auto context = test::make_context();
    test::Random random(seed);
    std::vector<MeshStore> parts;
    for (std::size_t p = 0; p < n_parts; ++p) {
        parts.push_back(make_mesh_store(*context, {}, {true, false}));
    }
    for (VertexId id = 0; id < n;) {
        MeshStore& part = parts[random.below(n_parts)];
        const VertexId end = std::min(n, id + 1 + random.below(most_run));
        for (; id < end; ++id) {
            part.vertices.push(vertex_with(id));
            part.attributes.sums.push(attributes_of(id));
            part.faces.push(face_of(id));
        }
    }
    const MeshStore whole = merge_parts(*context, std::move(parts));
    const std::vector<StoredVertex> vertices = all_of(whole.vertices);
    const std::vector<cluster::CellAttributes> sums = all_of(whole.attributes.sums);
    const std::vector<Face> faces = all_of(whole.faces);
    ASSERT_EQ(vertices.size(), n);
    ASSERT_EQ(sums.size(), n);
    ASSERT_EQ(faces.size(), n);
    for (VertexId id = 0; id < n; ++id) {
        ASSERT_EQ(vertices[id].id, id);
        ASSERT_EQ(sums[id].n_colors, attributes_of(id).n_colors) << id;
        ASSERT_EQ(faces[id], face_of(id)) << id;
    }
}

TEST(MeshMerge, PutsTheRecordsOfAllPartsInOrder) {
    // More than a reader's buffer holds, in runs from single records to more than a buffer; with
    // parts that stay empty.
    expect_merges(0, 3, 1, 1);
    expect_merges(1, 3, 1, 2);
    expect_merges(5000, 1, 10, 3);
    expect_merges(5000, 2, 1, 4);
    expect_merges(20000, 3, 50, 5);
    expect_merges(20000, 5, 4000, 6);
}

TEST(MeshMerge, SortsTheFacesOfACoreAndLeavesLockedVerticesOut) {
    BlockMesh core;
    for (const VertexId id : {10U, 11U, 12U, 13U}) core.vertices.push_back(vertex_with(id));
    core.vertices[1].flags = VertexFlags::kLocked;
    core.attributes.resize(4, {true, false});
    for (std::size_t v = 0; v < 4; ++v)
        core.attributes.sums[v] = attributes_of(core.vertices[v].id);
    core.faces = {{3, 1, 2}, {2, 0, 1}};
    const SortedCore sorted = sort_core(core);
    EXPECT_EQ(sorted.faces, (std::vector<Face>{{10, 11, 12}, {11, 12, 13}}));
    ASSERT_EQ(sorted.vertices.size(), 3U);
    ASSERT_EQ(sorted.attributes.sums.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        const VertexId id = std::array<VertexId, 3>{10, 12, 13}[i];
        EXPECT_EQ(sorted.vertices[i].id, id);
        EXPECT_EQ(sorted.attributes.sums[i].n_colors, attributes_of(id).n_colors);
    }
}

}  // namespace
}  // namespace hewer::rsimp
