// SPDX-License-Identifier: MIT
/// From every input format to every output format, with a ratio of 100 %: the same triangles, and
/// the same attributes where both formats have them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "hewer/simplify.h"
#include "tests/support/packed.h"
#include "tests/support/ply_builder.h"
#include "tests/support/read_back.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

namespace fs = std::filesystem;

// What a format does to a mesh, at most: positions by the diagonal, normals by a unit, colours by
// 65535.
struct Precision {
    double position = 0;
    double normal = 1e-6;
    double color = 0;
    bool has_normals = true;
    bool has_colors = true;
};

// Sixteen bits of linear light are this many steps of sRGB where it is darkest.
constexpr double kLinear = 7;
constexpr double kByteNormals = 0.012;
constexpr double kDracoNormals = 0.005;
constexpr double kSixteenBits = 1.0 / 65535;

struct Format {
    std::string name;  // as the parameter of a test
    std::string extension;
    Precision precision;
    MeshFileOptions file{};
};

MeshFileOptions compressed(Compression how) {
    MeshFileOptions file;
    file.compression = how;
    return file;
}

MeshFileOptions quantised() {
    MeshFileOptions file;
    file.quantization = {Quantization::Kind::Bits, 16};
    return file;
}

MeshFileOptions text() {
    MeshFileOptions file;
    file.is_ascii = true;
    return file;
}

/// All that hewer writes.
std::vector<Format> outputs() {
    return {
        {"ply", "ply", {0, 0, 0}},
        {"ply_text", "ply", {0, 1e-6, 0}, text()},
        {"obj", "obj", {0, 1e-6, 1}},
        {"off", "off", {0, 1e-6, 0}},
        {"stl", "stl", {0, 0, 0, false, false}},
        {"glb", "glb", {0, 1e-6, kLinear}},
        {"gltf", "gltf", {0, 1e-6, kLinear}},
        {"glb_quantised", "glb", {kSixteenBits, kByteNormals, kLinear}, quantised()},
        {"glb_meshopt", "glb", {0, kByteNormals, kLinear}, compressed(Compression::Meshopt)},
        {"glb_draco", "glb", {1e-7, kDracoNormals, kLinear}, compressed(Compression::Draco)},
        {"drc", "drc", {1e-7, kDracoNormals, 0}},
    };
}

template <typename T>
void put(std::string& to, T value) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    to.append(bytes.data(), bytes.size());
}

/// OpenMesh's format, version 1.2: with lists of faces. `Real`: of the positions.
template <typename Real>
std::string om_file(const Mesh& mesh) {
    std::string out = "OMT\x22";
    put(out, static_cast<std::uint32_t>(mesh.positions.size()));
    put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
    put(out, std::uint32_t{0});
    put(out, static_cast<std::uint16_t>(sizeof(Real) == 8 ? 0x5600 : 0x1600));
    for (const Vec3& p : mesh.positions) {
        for (const double x : p) put(out, static_cast<Real>(x));
    }
    if (!mesh.normals.empty()) put(out, std::uint16_t{0x1620});
    for (const auto& n : mesh.normals) {
        for (const float x : n) put(out, x);
    }
    if (!mesh.colors.empty()) put(out, std::uint16_t{0x1080});
    for (const Rgba16& c : mesh.colors) {
        for (std::size_t k = 0; k < 3; ++k) put(out, static_cast<std::uint8_t>(c[k] / 257));
    }
    put(out, std::uint16_t{0x80e8});
    for (const Triangle& t : mesh.triangles) {
        for (const std::uint64_t v : t) put(out, static_cast<std::uint32_t>(v));
    }
    return out;
}

std::string ascii_stl(const Mesh& mesh) {
    std::ostringstream out;
    out.precision(17);
    out << "solid test\n";
    for (const Triangle& t : mesh.triangles) {
        out << "facet normal 0 0 1\nouter loop\n";
        for (const std::uint64_t v : t) {
            const Vec3& p = mesh.positions[v];
            out << "vertex " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
        }
        out << "endloop\nendfacet\n";
    }
    out << "endsolid test\n";
    return out.str();
}

test::PlyMesh as_ply(const Mesh& mesh) {
    test::PlyMesh ply;
    ply.positions.assign(mesh.positions.begin(), mesh.positions.end());
    for (const auto& n : mesh.normals) ply.normals.push_back({n[0], n[1], n[2]});
    for (const Rgba16& c : mesh.colors) {
        ply.colors.push_back({c[0] / 257.0, c[1] / 257.0, c[2] / 257.0, c[3] / 257.0});
    }
    for (const Triangle& t : mesh.triangles) {
        ply.faces.push_back({static_cast<std::int64_t>(t[0]), static_cast<std::int64_t>(t[1]),
                             static_cast<std::int64_t>(t[2])});
    }
    return ply;
}

std::string content_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
}

/// An input file in `format`; where hewer writes the format, hewer has written it.
struct Input {
    std::string name;
    Precision precision;
};

std::vector<Input> inputs() {
    std::vector<Input> all;
    for (const Format& f : outputs()) all.push_back({f.name, f.precision});
    all.push_back({"ply_big_endian", {0, 1e-6, 0}});
    all.push_back({"ply_double", {0, 1e-6, 0}});
    all.push_back({"stl_text", {0, 0, 0, false, false}});
    all.push_back({"om", {0, 1e-6, 0}});
    all.push_back({"om_double", {0, 1e-6, 0}});
    all.push_back({"ply_gz", {0, 1e-6, 0}});
    all.push_back({"obj_zst", {0, 1e-6, 1}});
    return all;
}

bool is_close(double a, double b, double most) {
    return std::abs(a - b) <= most;
}

/// Writes `mesh` through the writers themselves.
void write_with(const Format& format, const Mesh& mesh, const fs::path& path) {
    const auto sink = create_mesh_file(path, format.file);
    SinkHeader header;
    header.n_vertices = mesh.positions.size();
    header.n_triangles = mesh.triangles.size();
    header.has_normals = !mesh.normals.empty();
    header.has_colors = !mesh.colors.empty();
    header.has_double_positions = true;
    for (const Vec3& p : mesh.positions) header.bounds.extend(p);
    sink->begin(header);
    sink->add_vertices({mesh.positions, mesh.normals, mesh.colors});
    sink->add_triangles(mesh.triangles);
    sink->finish();
}

fs::path write_input(const std::string& name, const Mesh& mesh, const test::TempDir& dir) {
    test::PlyStyle style;
    if (name == "ply_big_endian") {
        style.format = "binary_big_endian";
        return dir.write("in.ply", test::ply_file(as_ply(mesh), style));
    }
    if (name == "ply_double") {
        style.coordinate_type = "double";
        return dir.write("in.ply", test::ply_file(as_ply(mesh), style));
    }
    if (name == "stl_text") return dir.write("in.stl", ascii_stl(mesh));
    if (name == "om") return dir.write("in.om", om_file<float>(mesh));
    if (name == "om_double") return dir.write("in.om", om_file<double>(mesh));
    if (name == "ply_gz") return dir.write("in.ply.gz", test::gzip(test::ply_file(as_ply(mesh))));
    const std::string as = name == "obj_zst" ? "obj" : name;
    const auto formats = outputs();
    const auto format =
        std::find_if(formats.begin(), formats.end(), [&](const Format& f) { return f.name == as; });
    EXPECT_NE(format, formats.end()) << name;
    const fs::path path = dir.path() / ("in." + format->extension);
    write_with(*format, mesh, path);
    return name == "obj_zst" ? dir.write("in.obj.zst", test::zstd(content_of(path))) : path;
}

/// Reads a file back, a soup with a vertex for each corner.
Mesh read_file(const fs::path& path) {
    const auto source = open_mesh(path);
    test::ReadBack read = test::read_all(*source);
    for (const auto& t : read.soup) {
        const std::uint64_t first = read.mesh.positions.size();
        read.mesh.positions.insert(read.mesh.positions.end(), t.begin(), t.end());
        read.mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return std::move(read.mesh);
}

/// For each vertex of `b` the one of `a` that lies there; they lie much farther apart than `most`.
std::vector<std::uint64_t> match(const Mesh& a, const Mesh& b, double most) {
    std::vector<std::uint64_t> found;
    for (const Vec3& p : b.positions) {
        std::uint64_t nearest = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::uint64_t i = 0; i < a.positions.size(); ++i) {
            const Vec3& q = a.positions[i];
            const double d =
                std::max({std::abs(p[0] - q[0]), std::abs(p[1] - q[1]), std::abs(p[2] - q[2])});
            if (d < least) {
                least = d;
                nearest = i;
            }
        }
        EXPECT_LE(least, most) << "a vertex is where none was";
        found.push_back(nearest);
    }
    return found;
}

double diagonal_of(const Mesh& mesh) {
    Bounds bounds;
    for (const Vec3& p : mesh.positions) bounds.extend(p);
    return bounds.diagonal();
}

void expect_same(const Mesh& before, const Mesh& after, const Precision& in, const Precision& out) {
    // Half a step of a float beside what the formats themselves round.
    const double most = (in.position + out.position + 1e-7) * diagonal_of(before);
    const std::vector<std::uint64_t> at = match(before, after, most);
    std::vector<Triangle> triangles;
    const auto canonical = [](Triangle t) {
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        return t;
    };
    for (const Triangle& t : after.triangles) {
        triangles.push_back(canonical({at[t[0]], at[t[1]], at[t[2]]}));
    }
    std::vector<Triangle> expected;
    for (const Triangle& t : before.triangles) expected.push_back(canonical(t));
    std::sort(triangles.begin(), triangles.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(triangles, expected);

    EXPECT_EQ(!after.normals.empty(), in.has_normals && out.has_normals && !before.normals.empty());
    const double most_normal = in.normal + out.normal;
    for (std::size_t i = 0; i < after.normals.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_NEAR(after.normals[i][k], before.normals[at[i]][k], most_normal) << i;
        }
    }
    EXPECT_EQ(!after.colors.empty(), in.has_colors && out.has_colors && !before.colors.empty());
    const double most_color = in.color + out.color;
    for (std::size_t i = 0; i < after.colors.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_TRUE(is_close(after.colors[i][k], before.colors[at[i]][k], most_color))
                << "vertex " << i << ": " << after.colors[i][k] << " for "
                << before.colors[at[i]][k];
        }
    }
}

Mesh in_floats(Mesh mesh) {
    for (Vec3& p : mesh.positions) {
        for (double& x : p) x = static_cast<double>(static_cast<float>(x));
    }
    return mesh;
}

/// Colours that eight bits hold.
Mesh painted(Mesh mesh) {
    test::Random random(7);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const auto channel = [&] { return static_cast<std::uint16_t>(257 * random.below(256)); };
        mesh.colors.push_back({channel(), channel(), channel(), 65535});
    }
    return mesh;
}

/// Closed; with a border; of several parts without attributes.
std::vector<Mesh> meshes() {
    return {in_floats(painted(test::with_radial_normals(test::torus(12, 8)))),
            in_floats(painted(test::with_radial_normals(test::translated(
                test::scaled(test::plane_grid(9, 0.03), {50, 40, 30}), {10, -20, 5})))),
            in_floats(test::translated(test::many_spheres(2, 2), {0.5, 0.25, 0.125}))};
}

SimplifyOptions whole(const Format& format) {
    SimplifyOptions options;
    options.targets = {{Target::Kind::Ratio, 1}};
    options.file = format.file;
    options.n_threads = 2;
    return options;
}

class RoundTrip : public ::testing::TestWithParam<std::string> {};

TEST_P(RoundTrip, keeps_every_triangle_in_every_output_format) {
    const auto all = inputs();
    const Input& input =
        *std::find_if(all.begin(), all.end(), [&](const Input& i) { return i.name == GetParam(); });
    for (const Mesh& mesh : meshes()) {
        const test::TempDir dir;
        const fs::path in = write_input(input.name, mesh, dir);
        for (const Format& format : outputs()) {
            SCOPED_TRACE(input.name + " to " + format.name);
            const fs::path out = dir.path() / ("out." + format.extension);
            const SimplifyReport report = simplify_file(in, out, whole(format), {}, true);
            EXPECT_EQ(report.options.method, Method::Copy);
            EXPECT_EQ(report.lods[0].triangles, mesh.triangles.size());
            expect_same(mesh, read_file(out), input.precision, format.precision);
        }
    }
}

std::vector<std::string> input_names() {
    std::vector<std::string> names;
    for (const Input& i : inputs()) names.push_back(i.name);
    return names;
}

INSTANTIATE_TEST_SUITE_P(From, RoundTrip, ::testing::ValuesIn(input_names()),
                         [](const auto& test) { return test.param; });

struct Place {
    const char* name;
    Vec3 origin;
};

/// A hundred metres of model where maps and globes have it, and the largest move of a vertex that
/// is allowed there.
class FarOut : public ::testing::TestWithParam<Place> {
  protected:
    static Mesh model() {
        Mesh mesh =
            test::translated(test::scaled(test::cube_sphere(4), {40, 50, 30}), GetParam().origin);
        // Tenths of a millimetre.
        for (Vec3& p : mesh.positions) {
            for (double& x : p) x = std::round(x * 1e4) / 1e4;
        }
        return mesh;
    }
    /// Half a step of a float there, for formats that have nothing else.
    static double float_step() {
        const Vec3& o = GetParam().origin;
        const double farthest = std::max({std::abs(o[0]), std::abs(o[1]), std::abs(o[2])}) + 60;
        return std::ldexp(farthest, -23);
    }
    /// What inputs of the format hold.
    static double most_of(const std::string& name) {
        static const std::map<std::string, bool> holds{
            {"ply_double", true},   {"obj", true},         {"off", true},       {"glb", true},
            {"gltf", true},         {"glb_meshopt", true}, {"om_double", true}, {"obj_zst", true},
            {"ply", true},          {"ply_text", true},    {"glb_draco", true}, {"stl_text", true},
            {"glb_quantised", true}};
        // Sixteen bits of a box of 100 m are steps of 1.5 mm.
        if (name == "glb_quantised") return 1e-3;
        return holds.count(name) > 0 ? 1e-4 : float_step();
    }
    static void expect_moved_at_most(const Mesh& before, const Mesh& after, double most) {
        ASSERT_EQ(after.triangles.size(), before.triangles.size());
        for (const Vec3& p : after.positions) {
            double least = std::numeric_limits<double>::infinity();
            for (const Vec3& q : before.positions) {
                least = std::min(least, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
            }
            EXPECT_LE(least, 1.8 * most);  // in each of three coordinates
        }
    }
};

TEST_P(FarOut, inputs_are_as_precise_as_their_format) {
    const Mesh mesh = model();
    for (const Input& input : inputs()) {
        SCOPED_TRACE(input.name);
        const test::TempDir dir;
        const fs::path in = write_input(input.name, mesh, dir);
        const fs::path out = dir.path() / "out.ply";
        simplify_file(in, out, whole({}));
        expect_moved_at_most(mesh, read_file(out), most_of(input.name));
    }
}

TEST_P(FarOut, outputs_are_as_precise_as_their_format) {
    const Mesh mesh = model();
    const test::TempDir dir;
    const fs::path in = write_input("ply_double", mesh, dir);
    for (const Format& format : outputs()) {
        SCOPED_TRACE(format.name);
        const fs::path out = dir.path() / ("out." + format.extension);
        simplify_file(in, out, whole(format), {}, true);
        expect_moved_at_most(mesh, read_file(out), most_of(format.name));
    }
}

TEST_P(FarOut, simplification_works_relative_to_an_origin) {
    const Mesh mesh = model();
    const Vec3& o = GetParam().origin;
    SimplifyOptions options;
    options.targets = {{Target::Kind::Ratio, 0.5}};
    const Mesh far = simplify_mesh(mesh, options);
    const Mesh near = simplify_mesh(test::translated(mesh, {-o[0], -o[1], -o[2]}), options);
    ASSERT_EQ(far.triangles.size(), near.triangles.size());
    Bounds far_box;
    Bounds near_box;
    for (const Vec3& p : far.positions) far_box.extend(p);
    for (const Vec3& p : near.positions) near_box.extend(p);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(far_box.min[k] - o[k], near_box.min[k], 1e-4);
        EXPECT_NEAR(far_box.max[k] - o[k], near_box.max[k], 1e-4);
    }
}

INSTANTIATE_TEST_SUITE_P(At, FarOut,
                         ::testing::Values(Place{"utm", {500000, 4649776, 120}},
                                           Place{"geocentric", {4.2e6, 1.7e5, 4.78e6}}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace hewer
