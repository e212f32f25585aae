// SPDX-License-Identifier: MIT
/// The reader of .om files against files that OpenMesh writes.
#include <gtest/gtest.h>

// The I/O of OpenMesh first: it is what its headers ask for.
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <array>
#include <filesystem>
#include <vector>

#include "hewer/mesh_source.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/read_back.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

struct Doubles : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
    using Color = OpenMesh::Vec4uc;
};

template <typename HalfEdges>
std::filesystem::path write(const Mesh& mesh, const test::TempDir& dir,
                            OpenMesh::IO::Options options) {
    HalfEdges half_edges;
    half_edges.request_vertex_normals();
    half_edges.request_vertex_colors();
    half_edges.request_vertex_status();
    std::vector<typename HalfEdges::VertexHandle> vertices;
    using Scalar = typename HalfEdges::Point::value_type;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3& p = mesh.positions[i];
        vertices.push_back(half_edges.add_vertex(typename HalfEdges::Point(
            static_cast<Scalar>(p[0]), static_cast<Scalar>(p[1]), static_cast<Scalar>(p[2]))));
        const auto& n = mesh.normals[i];
        half_edges.set_normal(vertices[i], typename HalfEdges::Normal(n[0], n[1], n[2]));
        typename HalfEdges::Color color;
        for (std::size_t k = 0; k < color.size(); ++k) {
            color[k] = static_cast<unsigned char>(mesh.colors[i][k] / 257);
        }
        half_edges.set_color(vertices[i], color);
    }
    for (const Triangle& t : mesh.triangles) {
        half_edges.add_face(std::vector<typename HalfEdges::VertexHandle>{
            vertices[t[0]], vertices[t[1]], vertices[t[2]]});
    }
    const std::filesystem::path path = dir.path() / "a.om";
    EXPECT_TRUE(OpenMesh::IO::write_mesh(half_edges, path.string(), options));
    return path;
}

void expect_equal(const Mesh& mesh, const std::filesystem::path& path) {
    const auto source = open_mesh(path);
    const Mesh read = test::read_all(*source).mesh;
    ASSERT_EQ(read.positions.size(), mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(read.positions[i][k], mesh.positions[i][k], 1e-6);
            EXPECT_NEAR(read.normals[i][k], mesh.normals[i][k], 1e-6);
            EXPECT_EQ(read.colors[i][k], mesh.colors[i][k] / 257 * 257);
        }
    }
    EXPECT_EQ(test::triangle_set(read.triangles), test::triangle_set(mesh.triangles));
}

TEST(OmFilesOfOpenMesh, are_read_as_they_were_written) {
    using Options = OpenMesh::IO::Options;
    // More than 128 and more than 32,768 halfedges: handles of all sizes.
    for (const std::uint64_t n : std::array<std::uint64_t, 3>{2, 12, 60}) {
        const Mesh mesh = test::with_colors(test::with_radial_normals(test::cube_sphere(n)));
        const test::TempDir dir;
        const Options all = Options::VertexNormal | Options::VertexColor | Options::Status;
        expect_equal(mesh, write<OpenMesh::TriMesh_ArrayKernelT<>>(mesh, dir, all));
        expect_equal(mesh, write<OpenMesh::TriMesh_ArrayKernelT<Doubles>>(mesh, dir, all));
        expect_equal(mesh, write<OpenMesh::PolyMesh_ArrayKernelT<>>(mesh, dir, all));
    }
}

}  // namespace
}  // namespace hewer
