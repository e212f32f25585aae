// SPDX-License-Identifier: MIT
/// Textures of OBJ, PLY and glTF as colours of the vertices.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <random>
#include <sstream>

#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "tests/support/glb_builder.h"
#include "tests/support/image_files.h"
#include "tests/support/ply_builder.h"
#include "tests/support/read_back.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

using test::jpeg_of;
using test::Picture;
using test::png_of;
using test::Rgb8;

constexpr Rgb8 kRed{255, 0, 0};
constexpr Rgb8 kGreen{0, 255, 0};
constexpr Rgb8 kBlue{0, 0, 255};
constexpr Rgb8 kYellow{255, 255, 0};

/// Red and green above, blue and yellow below.
Picture quarters() {
    return {64, 64, [](std::uint32_t x, std::uint32_t y) {
                return y < 32 ? (x < 32 ? kRed : kGreen) : (x < 32 ? kBlue : kYellow);
            }};
}

/// A square whose corners 1 and 3 have a triangle each: their colours are of one quarter alone.
const std::string kSquare =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl paint\n";
const std::string kFaces = "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";

/// A corner's third of a triangle ends where the next quarter begins, and a sample is as wide as
/// its part of the triangle: some of the other side's colour is right.
void expect_color(const Rgba16& color, const Rgb8& expected, double most = 10) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(color[k] / 257.0, expected[k], most) << k;
}

class Textures : public testing::Test {
  protected:
    Mesh read(const std::filesystem::path& path, const OpenOptions& options = {}) {
        warnings_.clear();
        Hooks hooks;
        hooks.on_warning = [&](const std::string& text) { warnings_.push_back(text); };
        const auto source = open_mesh(path, options, hooks);
        info_ = source->info();
        return test::read_all(*source).mesh;
    }
    Mesh read_obj(const std::string& obj, const std::string& mtl, const OpenOptions& options = {}) {
        (void)dir_.write("m.mtl", mtl);
        return read(dir_.write("m.obj", "mtllib m.mtl\n" + obj), options);
    }
    void expect_ignored(const std::string& part) const {
        EXPECT_TRUE(std::any_of(
            info_.ignored.begin(), info_.ignored.end(),
            [&](const std::string& name) { return name.find(part) != std::string::npos; }))
            << part;
    }

    test::TempDir dir_;
    SourceInfo info_;
    std::vector<std::string> warnings_;
};

TEST_F(Textures, OfObjColourTheVerticesWithVUpwards) {
    (void)dir_.write("t.png", png_of(quarters()));
    const Mesh mesh = read_obj(kSquare + kFaces, "newmtl paint\nKd 0 0 0\nmap_Kd t.png\n");
    ASSERT_EQ(mesh.colors.size(), 4U);
    expect_color(mesh.colors[1], kYellow);
    expect_color(mesh.colors[3], kRed);
    EXPECT_TRUE(info_.ignored.empty());
    EXPECT_FALSE(info_.has_alpha);
    ASSERT_EQ(info_.textures.size(), 1U);
    EXPECT_EQ(info_.textures[0].name, (dir_.path() / "t.png").string());
    EXPECT_EQ(info_.textures[0].format, "PNG");
    EXPECT_EQ(info_.textures[0].width, 64U);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(Textures, AreAveragedOverTheSurfaceAndNotReadAtTheVertices) {
    // One texel white, one black: whatever single texels are read, they are one or the other.
    for (const std::uint32_t side : {64U, 256U}) {
        const Picture checker(side, side, [](std::uint32_t x, std::uint32_t y) {
            return (x + y) % 2 == 0 ? Rgb8{255, 255, 255} : Rgb8{0, 0, 0};
        });
        (void)dir_.write("t.png", png_of(checker));
        const Mesh mesh = read_obj(kSquare + kFaces, "newmtl paint\nmap_Kd t.png\n");
        for (const Rgba16& c : mesh.colors) expect_color(c, {128, 128, 128}, 8);
    }
}

TEST_F(Textures, CountByTheAreaOfTheirTriangles) {
    // Vertex 1 has a red triangle and a blue one of three times its area.
    (void)dir_.write("t.png", png_of(quarters()));
    const Mesh mesh = read_obj(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -3 0 0\nvt .2 .8\nvt .2 .2\nusemtl paint\n"
        "f 1/1 2/1 3/1\nf 1/2 3/2 4/2\n",
        "newmtl paint\nmap_Kd t.png\n");
    expect_color(mesh.colors[0], {64, 0, 191});
    expect_color(mesh.colors[1], kRed);
    expect_color(mesh.colors[3], kBlue);
}

TEST_F(Textures, RepeatOrEndAtTheirEdges) {
    (void)dir_.write("t.png", png_of(quarters()));
    const std::string beyond =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 3.9 -2.1\nvt 3.8 -2.1\nvt 3.8 -2.2\nusemtl paint\n"
        "f 1/1 2/2 3/3\n";
    expect_color(read_obj(beyond, "newmtl paint\nmap_Kd t.png\n").colors[0], kGreen);
    expect_color(read_obj(beyond, "newmtl paint\nmap_Kd -clamp on t.png\n").colors[0], kYellow);
    // Scaled to the middle of a quarter, and moved to another.
    const std::string one = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 1 1\nusemtl paint\nf 1/1 2/1 3/1\n";
    expect_color(read_obj(one, "newmtl paint\nmap_Kd -s .25 .25 t.png\n").colors[0], kBlue);
    expect_color(read_obj(one, "newmtl paint\nmap_Kd -s .25 .25 1 -o 0 .5 0 t.png\n").colors[0],
                 kRed);
}

TEST_F(Textures, OfSeveralMaterialsStandBesideTheirColours) {
    (void)dir_.write("my texture.png", png_of({4, 4, [](auto, auto) { return kGreen; }}));
    std::filesystem::create_directory(dir_.path() / "sub");
    (void)dir_.write("sub/blue.jpg", jpeg_of({16, 16, [](auto, auto) { return kBlue; }}));
    (void)dir_.write("first lib.mtl", "newmtl a\nmap_Kd -blendu on my texture.png\n");
    (void)dir_.write("second.mtl",
                     "newmtl b\nKd 1 1 0\nnewmtl c\nmap_Kd sub\\blue.jpg\nmap_bump x\n");
    std::string obj = "mtllib first lib.mtl second.mtl\nvt 0 0\n";
    for (int i = 0; i < 4; ++i) {
        const std::string x = std::to_string(i);
        obj += "v " + x + " 0 0 1 0 0\nv " + x + " 1 0 1 0 0\nv " + x + " 0 1 1 0 0\n";
    }
    obj +=
        "f 1/1 2/1 3/1\nusemtl a\nf 4/-1 5/1 6/1\nusemtl b\nf 7 8 9\nusemtl c\nf 10/1 11/1 12/1\n";
    const Mesh mesh = read(dir_.write("m.obj", obj));
    ASSERT_EQ(mesh.colors.size(), 12U);
    expect_color(mesh.colors[0], kRed);  // what stands at the vertex, where there is no material
    expect_color(mesh.colors[3], kGreen);
    expect_color(mesh.colors[6], kYellow);
    expect_color(mesh.colors[9], kBlue, 2);
    EXPECT_EQ(info_.textures.size(), 2U);
    expect_ignored("map_bump");
}

TEST_F(Textures, ThatAreMissingAreNamedAndLeftOut) {
    (void)dir_.write("cut.png", png_of(quarters()).substr(0, 100));
    for (const std::string name : {"none.png", "cut.png"}) {
        const std::string mtl = "newmtl paint\nmap_Kd " + name + "\n";
        const Mesh mesh = read_obj(kSquare + kFaces, mtl);
        EXPECT_EQ(mesh.triangles.size(), 2U);
        EXPECT_TRUE(mesh.colors.empty());
        ASSERT_EQ(warnings_.size(), 1U);
        EXPECT_NE(warnings_[0].find(name), std::string::npos) << warnings_[0];
        expect_ignored(name);
        expect_ignored("texture coordinates");
        EXPECT_THROW(read_obj(kSquare + kFaces, mtl, {.strict = true}), FormatError);
    }
    const Mesh mesh = read(dir_.write("m.obj", "mtllib gone.mtl\n" + kSquare + kFaces));
    EXPECT_EQ(mesh.triangles.size(), 2U);
    ASSERT_EQ(warnings_.size(), 1U);
    EXPECT_NE(warnings_[0].find("gone.mtl"), std::string::npos);
}

TEST_F(Textures, NeedNoCoordinatesThatMakeSense) {
    (void)dir_.write("t.png", png_of(quarters()));
    const std::string mtl = "newmtl paint\nmap_Kd t.png\n";
    for (const char* face :
         {"f 1/1 2/9 3/3\n", "f 1 2 3\n", "f 1/1 2/2 3\n", "f 1/5 2/6 3/7\n", "f 1/0 2/0 3/0\n"}) {
        const Mesh mesh = read_obj("vt nan 0\n" + kSquare + "vt 1e30 0\nvt 0 -inf\n" + face, mtl);
        EXPECT_EQ(mesh.triangles.size(), 1U) << face;
        for (const Rgba16& c : mesh.colors) EXPECT_EQ(c, (Rgba16{65535, 65535, 65535, 65535}));
    }
    // Coordinates may stand behind their faces.
    const Mesh mesh = read_obj("usemtl paint\nf 1/1 2/2 3/3\n" + kSquare, mtl);
    expect_color(mesh.colors[1], kYellow);
}

TEST_F(Textures, OfPolygonsStayAtTheirCorners) {
    // An arrowhead: its fan from the first corner would turn over.
    (void)dir_.write("t.png", png_of(quarters()));
    const Mesh mesh = read_obj(
        "v 2 0 0\nv 0 1 0\nv 1 0 0\nv 0 -1 0\nvt .1 .9\nvt .9 .9\nvt .9 .1\nvt .1 .1\n"
        "usemtl paint\nf 2/2 3/1 4/4 1/3\n",
        "newmtl paint\nmap_Kd t.png\n");
    ASSERT_EQ(mesh.triangles.size(), 2U);
    expect_color(mesh.colors[1], kGreen);
    expect_color(mesh.colors[3], kBlue);
}

TEST_F(Textures, ComeOutTheSameForAnyMemoryAndThreads) {
    std::mt19937 random(5);
    const Picture noise(700, 500, [&](std::uint32_t, std::uint32_t) {
        return Rgb8{static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
                    static_cast<std::uint8_t>(random())};
    });
    (void)dir_.write("t.png", png_of(noise));
    (void)dir_.write("u.jpg", jpeg_of(noise, {true, false, false}));
    constexpr unsigned kSide = 120;
    std::ostringstream obj;
    for (unsigned i = 0; i < kSide * kSide; ++i) {
        obj << "v " << i % kSide << ' ' << i / kSide << ' ' << random() % 3 << "\nvt "
            << (i % kSide) / 50.0 << ' ' << (i / kSide) / 70.0 << '\n';
    }
    for (unsigned i = 0; i + kSide < kSide * kSide; ++i) {
        if (i % kSide == kSide - 1) continue;
        if (i % 1000 == 0) obj << "usemtl " << (i % 3000 == 0 ? "a" : "b") << '\n';
        const unsigned a = i + 1;
        const auto corner = [&](unsigned v) { obj << ' ' << v << '/' << v; };
        obj << 'f';
        for (const unsigned v : {a, a + 1, a + kSide + 1, a + kSide}) corner(v);
        obj << '\n';
    }
    const std::string mtl = "newmtl a\nmap_Kd t.png\nnewmtl b\nmap_Kd u.jpg\n";
    const Mesh expected = read_obj(obj.str(), mtl, {.n_threads = 1});
    ASSERT_EQ(expected.colors.size(), std::size_t{kSide} * kSide);
    for (const unsigned n_threads : {1U, 3U}) {
        for (const std::uint64_t mib : {32U, 48U}) {
            const Mesh mesh =
                read_obj(obj.str(), mtl, {.memory_bytes = mib << 20, .n_threads = n_threads});
            EXPECT_EQ(mesh.colors, expected.colors) << mib << " MiB, " << n_threads << " threads";
        }
    }
}

/// A square of two triangles and a quad beside it, in PLY.
class PlyTextures : public Textures, public testing::WithParamInterface<const char*> {
  protected:
    void SetUp() override { (void)dir_.write("t 1.png", png_of(quarters())); }

    [[nodiscard]] std::string number(const std::string& type, double value) const {
        return test::ply_value(GetParam(), type, value) + (is_text() ? " " : "");
    }
    [[nodiscard]] bool is_text() const { return std::string(GetParam()) == "ascii"; }
    [[nodiscard]] std::string end() const { return is_text() ? "\n" : ""; }

    /// `columns` of the vertices behind x, y and z; `lists` of the faces behind their corners.
    [[nodiscard]] std::string header(const std::string& columns, const std::string& lists) const {
        return std::string("ply\nformat ") + GetParam() +
               " 1.0\ncomment TextureFile t 1.png\ncomment TextureFile u.jpg\n"
               "element vertex 6\nproperty float x\nproperty double y\nproperty float z\n" +
               columns + "element face 3\nproperty list uchar int vertex_indices\n" + lists +
               "end_header\n";
    }
    template <typename More>
    [[nodiscard]] std::string vertices(const More& more) const {
        std::string text;
        for (const auto& [x, y] :
             {std::pair{0., 0.}, {1., 0.}, {1., 1.}, {0., 1.}, {2., 0.}, {2., 1.}}) {
            text +=
                number("float", x) + number("double", y) + number("float", 0) + more(x, y) + end();
        }
        return text;
    }
    template <typename More>
    [[nodiscard]] std::string faces(const More& more) const {
        std::string text;
        for (const auto& face : std::vector<std::vector<int>>{{0, 1, 2}, {0, 2, 3}, {1, 4, 5, 2}}) {
            text += number("uchar", static_cast<double>(face.size()));
            for (const int v : face) text += number("int", v);
            text += more(face) + end();
        }
        return text;
    }
    [[nodiscard]] std::string coordinates(const std::vector<double>& uv) const {
        std::string text = number("uchar", static_cast<double>(uv.size()));
        for (const double x : uv) text += number("float", x);
        return text;
    }
    Mesh read_ply(const std::string& ply, const OpenOptions& options = {}) {
        return read(dir_.write("m.ply", ply), options);
    }
};
INSTANTIATE_TEST_SUITE_P(Encodings, PlyTextures,
                         testing::Values("ascii", "binary_little_endian", "binary_big_endian"));

constexpr const char* kCornerLists = "property list uchar float texcoord\nproperty int texnumber\n";

TEST_P(PlyTextures, AtCornersColourTheVerticesWithVUpwards) {
    (void)dir_.write("u.jpg", jpeg_of({16, 16, [](auto, auto) { return kBlue; }}));
    const Mesh mesh =
        read_ply(header("", kCornerLists) + vertices([](auto, auto) { return ""; }) +
                 faces([&](const std::vector<int>& face) {
                     if (face.size() == 4) {
                         return coordinates({.5, .5, .5, .5, .5, .5, .5, .5}) + number("int", 1);
                     }
                     const bool is_first = face[1] == 1;
                     return coordinates(is_first ? std::vector<double>{0, 0, 1, 0, 1, 1}
                                                 : std::vector<double>{0, 0, 1, 1, 0, 1}) +
                            number("int", 0);
                 }));
    ASSERT_EQ(mesh.colors.size(), 6U);
    expect_color(mesh.colors[3], kRed);
    expect_color(mesh.colors[4], kBlue);
    expect_color(mesh.colors[5], kBlue);
    // Half a triangle of yellow, half of the quad's two blue ones.
    EXPECT_GT(mesh.colors[1][2], 20000U);
    EXPECT_GT(mesh.colors[1][0], 20000U);
    EXPECT_TRUE(info_.ignored.empty());
    ASSERT_EQ(info_.textures.size(), 2U);
    EXPECT_EQ(info_.textures[0].name, (dir_.path() / "t 1.png").string());
    EXPECT_EQ(info_.textures[1].format, "JPEG");
}

TEST_P(PlyTextures, AtVerticesColourThem) {
    for (const std::string u_name : {"s", "texture_u"}) {
        const std::string v_name = u_name == "s" ? "t" : "texture_v";
        const Mesh mesh = read_ply(
            header("property float " + u_name + "\nproperty float " + v_name + "\n", "") +
            vertices([&](double x, double y) {
                return number("float", x < 1.5 ? .1 + .8 * x : .9) + number("float", .1 + .8 * y);
            }) +
            faces([](const auto&) { return ""; }));
        ASSERT_EQ(mesh.colors.size(), 6U);
        expect_color(mesh.colors[3], kRed);
        expect_color(mesh.colors[4], kYellow, 40);
        ASSERT_EQ(info_.textures.size(), 1U);
        ASSERT_EQ(warnings_.size(), 1U);
        EXPECT_NE(warnings_[0].find("u.jpg"), std::string::npos);
        expect_ignored("u.jpg");
    }
}

TEST_P(PlyTextures, LeaveTheColoursOfVerticesWhereTheyGiveNone) {
    const std::string colors =
        "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
    const auto green = [&](auto, auto) {
        return number("uchar", 0) + number("uchar", 255) + number("uchar", 0) +
               number("uchar", 128);
    };
    // A face without coordinates, one with a texture that is not there, one with two numbers less.
    const Mesh mesh = read_ply(
        header(colors, kCornerLists) + vertices(green) + faces([&](const std::vector<int>& face) {
            if (face.size() == 4) return coordinates({0, 0, 1, 0}) + number("int", 0);
            return face[1] == 1 ? coordinates({}) + number("int", -1)
                                : coordinates({.1, .9, .1, .9, .1, .9}) + number("int", 0);
        }));
    ASSERT_EQ(mesh.colors.size(), 6U);
    expect_color(mesh.colors[1], kGreen);
    expect_color(mesh.colors[5], kGreen);
    expect_color(mesh.colors[3], kRed);
    for (const Rgba16& c : mesh.colors) EXPECT_EQ(c[3], 128 * 257);
    EXPECT_TRUE(info_.has_alpha);
}

TEST_P(PlyTextures, ThatAreMissingAreNamedAndLeftOut) {
    std::filesystem::remove(dir_.path() / "t 1.png");
    const std::string ply =
        header("", kCornerLists) + vertices([](auto, auto) { return ""; }) +
        faces([&](const auto& face) {
            return coordinates(std::vector<double>(2 * face.size(), .5)) + number("int", 0);
        });
    const Mesh mesh = read_ply(ply);
    EXPECT_EQ(mesh.triangles.size(), 4U);
    EXPECT_TRUE(mesh.colors.empty());
    EXPECT_FALSE(info_.has_colors);
    EXPECT_EQ(warnings_.size(), 2U);
    expect_ignored("t 1.png");
    expect_ignored("texture coordinates");
    EXPECT_THROW(read_ply(ply, {.strict = true}), FormatError);
    // Names of textures alone.
    (void)read_ply(header("", "") + vertices([](auto, auto) { return ""; }) +
                   faces([](const auto&) { return ""; }));
    EXPECT_TRUE(warnings_.empty());
    expect_ignored("textures, without coordinates");
}

TEST_P(PlyTextures, OfACutFileAreRefused) {
    const std::string ply =
        header("", kCornerLists) + vertices([](auto, auto) { return ""; }) +
        faces([&](const auto& face) {
            return coordinates(std::vector<double>(2 * face.size(), .5)) + number("int", 0);
        });
    for (std::size_t cut = 5; cut < 200; cut += 13) {
        EXPECT_THROW(read_ply(ply.substr(0, ply.size() - cut)), FormatError) << cut;
    }
}

/// A square in a GLB, with texture coordinates like its corners and one material.
struct TexturedGlb {
    test::GlbBuilder glb;
    using Json = test::GlbBuilder::Json;

    explicit TexturedGlb(const std::string& image) {
        const auto positions =
            glb.add_array(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3, 5126);
        const auto texcoords = glb.add_array(std::vector<float>{0, 0, 1, 0, 1, 1, 0, 1}, 2, 5126);
        const auto indices = glb.add_array(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, 1, 5123);
        glb.document["images"] = {{{"bufferView", glb.add_view(image)}, {"mimeType", "image/png"}}};
        glb.document["textures"] = {{{"source", 0}, {"sampler", 0}}};
        glb.document["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33071}}};
        glb.document["materials"] = {
            {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
        Json primitive = {{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", texcoords}}},
                          {"indices", indices},
                          {"material", 0}};
        glb.document["meshes"] = {{{"primitives", {primitive}}}};
        glb.document["nodes"] = {{{"mesh", 0}}};
        glb.document["scenes"] = {{{"nodes", {0}}}};
    }
    Json& primitive() { return glb.document["meshes"][0]["primitives"][0]; }
    Json& pbr() { return glb.document["materials"][0]["pbrMetallicRoughness"]; }
    Json& texture() { return pbr()["baseColorTexture"]; }
};

class GltfTextures : public Textures {
  protected:
    Mesh read_glb(const TexturedGlb& glb) { return read(dir_.write("m.glb", glb.glb.glb())); }
};

TEST_F(GltfTextures, ColourTheVerticesWithVDownwards) {
    const Mesh mesh = read_glb(TexturedGlb(png_of(quarters())));
    ASSERT_EQ(mesh.colors.size(), 4U);
    expect_color(mesh.colors[1], kGreen);
    expect_color(mesh.colors[3], kBlue);
    EXPECT_TRUE(info_.ignored.empty());
    EXPECT_FALSE(info_.has_alpha);
    ASSERT_EQ(info_.textures.size(), 1U);
    EXPECT_NE(info_.textures[0].name.find("image 0"), std::string::npos);
}

TEST_F(GltfTextures, AreMultipliedAsLight) {
    TexturedGlb glb(png_of({8, 8, [](auto, auto) { return Rgb8{188, 188, 255}; }}));
    glb.pbr()["baseColorFactor"] = {0.5, 1, 1, 1};
    glb.primitive()["attributes"]["COLOR_0"] =
        glb.glb.add_array(std::vector<float>{1, .5, 1, 1, .5, 1, 1, .5, 1, 1, .5, 1}, 3, 5126);
    // 188 is half of the light; a quarter is 137.
    for (const Rgba16& c : read_glb(glb).colors) expect_color(c, {137, 137, 255});
}

TEST_F(GltfTextures, AreFoundInFilesAndInTheDocument) {
    const std::string jpeg = jpeg_of({16, 16, [](auto, auto) { return kBlue; }});
    TexturedGlb in_file("");
    in_file.glb.document["images"] = {{{"uri", "a%20b.jpg"}}};
    (void)dir_.write("a b.jpg", jpeg);
    expect_color(read_glb(in_file).colors[0], kBlue, 2);
    EXPECT_EQ(info_.textures.at(0).format, "JPEG");

    // One white texel.
    TexturedGlb in_document("");
    const std::string uri =
        "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mP8/x8AAwMC"
        "AO+ip1sAAAAASUVORK5CYII=";
    in_document.glb.document["images"] = {{{"uri", uri}}};
    EXPECT_EQ(read_glb(in_document).colors.size(), 4U);
    EXPECT_EQ(info_.textures.at(0).width, 1U);
}

TEST_F(GltfTextures, FollowSamplersTransformsAndOtherCoordinates) {
    TexturedGlb glb(png_of(quarters()));
    // A small triangle around (u, v) for all corners.
    const auto place_at = [&](float u, float v) {
        const float e = 1e-3F;
        glb.primitive()["attributes"]["TEXCOORD_1"] =
            glb.glb.add_array(std::vector<float>{u, v, u + e, v, u + e, v + e, u, v + e}, 2, 5126);
    };
    glb.texture()["texCoord"] = 1;
    const auto color = [&] { return read_glb(glb).colors.at(0); };
    const auto set_wrap = [&](int mode) {
        glb.glb.document["samplers"] = {{{"wrapS", mode}, {"wrapT", mode}}};
    };
    place_at(1.25F, -0.25F);
    set_wrap(33071);
    expect_color(color(), kGreen);
    expect_ignored("TEXCOORD_0");
    set_wrap(10497);
    expect_color(color(), kBlue);
    set_wrap(33648);
    expect_color(color(), kGreen);

    // The example of the extension's text: the lower left quarter, turned.
    glb.texture()["texCoord"] = 0;
    glb.texture()["extensions"] = {{"KHR_texture_transform",
                                    {{"offset", {0, 1}},
                                     {"rotation", 1.57079632679},
                                     {"scale", {0.5, 0.5}},
                                     {"texCoord", 1}}}};
    glb.glb.document["extensionsRequired"] = {"KHR_texture_transform"};
    for (const auto& [u, v] : {std::pair{.2F, .2F}, {.8F, .3F}, {.5F, .9F}}) {
        place_at(u, v);
        expect_color(color(), kBlue);
    }
}

TEST_F(GltfTextures, ThatCannotBeUsedAreNamedAndLeftOut) {
    TexturedGlb missing("");
    missing.glb.document["images"] = {{{"uri", "none.png"}}};
    EXPECT_TRUE(read_glb(missing).colors.empty());
    EXPECT_EQ(warnings_.size(), 1U);
    expect_ignored("none.png");

    TexturedGlb webp("RIFF....WEBPVP8 ");
    EXPECT_EQ(read_glb(webp).triangles.size(), 2U);
    expect_ignored("WebP");

    TexturedGlb basis("");
    basis.glb.document["textures"] = {{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}};
    EXPECT_EQ(read_glb(basis).triangles.size(), 2U);
    expect_ignored("KHR_texture_basisu");

    for (const char* where : {"images", "textures"}) {
        TexturedGlb none(png_of(quarters()));
        none.glb.document.erase(where);
        EXPECT_EQ(read_glb(none).triangles.size(), 2U);
        EXPECT_EQ(warnings_.size(), 1U);
    }

    TexturedGlb without(png_of(quarters()));
    without.primitive()["attributes"].erase("TEXCOORD_0");
    EXPECT_EQ(read_glb(without).triangles.size(), 2U);
    expect_ignored("without TEXCOORD_0");
}

}  // namespace
}  // namespace hewer
