// SPDX-License-Identifier: MIT
#include "rsimp/face_exchange.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "hewer/error.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/shapes.h"

namespace hewer::rsimp {

namespace {

Face rotated(Face face, std::uint64_t by) {
    std::rotate(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(by % 3), face.end());
    return face;
}

std::vector<Face> random_faces(std::uint64_t n, std::uint64_t seed) {
    test::Random random(seed);
    std::vector<Face> faces;
    for (std::uint64_t i = 0; i < n; ++i) {
        const std::uint64_t first = random.below(n);
        faces.push_back({first, first + 1 + random.below(n), first + 1 + random.below(n)});
    }
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    return faces;
}

MeshStore store_of(ooc::Context& context, const std::vector<Face>& faces) {
    MeshStore mesh;
    mesh.faces = {context, "faces"};
    mesh.faces.append(faces);
    mesh.faces.seal();
    return mesh;
}

std::vector<Face> faces_of(const MeshStore& mesh) {
    std::vector<Face> faces(mesh.faces.size());
    mesh.faces.read(0, faces);
    return faces;
}

TEST(FaceExchange, PutsNewFacesInTheirPlaces) {
    const auto context = test::make_context();
    for (const std::uint64_t n : {1U, 50U, 20000U}) {
        std::vector<Face> faces = random_faces(n, n);
        MeshStore mesh = store_of(*context, faces);
        FaceExchange exchange(*context);
        test::Random random(4);
        const std::vector<Face> others = random_faces(n, n + 1);
        std::vector<Face> expected = faces;
        for (std::size_t i = 0; i < std::min(faces.size(), others.size()); ++i) {
            if (random.below(3) != 0) continue;
            exchange.add(rotated(faces[i], random.below(3)), rotated(others[i], random.below(3)));
            expected[i] = others[i];
        }
        std::sort(expected.begin(), expected.end());
        (void)exchange.carry_out(mesh);
        EXPECT_EQ(faces_of(mesh), expected) << n;
    }
}

TEST(FaceExchange, FacesMayTakeEachOthersPlaces) {
    const auto context = test::make_context();
    const std::vector<Face> faces{{1, 2, 3}, {1, 3, 4}, {2, 5, 3}};
    MeshStore mesh = store_of(*context, faces);
    FaceExchange exchange(*context);
    exchange.add(faces[0], faces[2]);
    exchange.add(faces[2], faces[0]);
    EXPECT_TRUE(exchange.carry_out(mesh));
    EXPECT_EQ(faces_of(mesh), faces);
}

TEST(FaceExchange, NothingToDoIsSaid) {
    const auto context = test::make_context();
    MeshStore mesh = store_of(*context, {{1, 2, 3}});
    FaceExchange exchange(*context);
    EXPECT_FALSE(exchange.carry_out(mesh));
}

TEST(FaceExchange, RefusesAFaceThatIsNotThere) {
    const auto context = test::make_context();
    MeshStore mesh = store_of(*context, {{1, 2, 3}});
    FaceExchange exchange(*context);
    exchange.add({1, 2, 4}, {1, 2, 5});
    EXPECT_THROW(exchange.carry_out(mesh), InternalError);
}

}  // namespace

}  // namespace hewer::rsimp
