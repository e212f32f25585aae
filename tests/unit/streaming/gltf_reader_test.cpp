// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cmath>
#include <limits>
#include <random>

#include "hewer/error.h"
#include "hewer/mesh_sink.h"
#include "hewer/mesh_source.h"
#include "tests/support/glb_builder.h"
#include "tests/support/read_back.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

using Json = nlohmann::json;
using test::GlbBuilder;

const std::vector<float> square_corners{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};

/// A square of two triangles; `mesh` in one node.
struct Square {
    GlbBuilder glb;
    Square() {
        const auto positions = glb.add_array(square_corners, 3, 5126);
        const auto indices = glb.add_array(std::vector<std::uint16_t>{0, 1, 2, 2, 1, 3}, 1, 5123);
        glb.document["meshes"] = {
            {{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}}};
        glb.document["nodes"] = {{{"mesh", 0}}};
        glb.document["scenes"] = {{{"nodes", {0}}}};
        glb.document["scene"] = 0;
    }
    Json& primitive() { return glb.document["meshes"][0]["primitives"][0]; }
};

class GltfReader : public testing::Test {
  protected:
    test::ReadBack read(const std::string& file, unsigned n_threads = 1) {
        source_ = open_mesh(dir_.write("model.glb", file));
        return test::read_all(*source_, n_threads);
    }
    std::string refusal(const std::string& file, const OpenOptions& options = {}) {
        try {
            const auto source = open_mesh(dir_.write("model.glb", file), options);
            (void)test::read_all(*source);
        } catch (const Error& e) {
            return e.what();
        }
        ADD_FAILURE() << "was not refused";
        return {};
    }
    void expect_refused(const std::string& file, const std::string& part) {
        const std::string what = refusal(file);
        EXPECT_NE(what.find(part), std::string::npos) << what;
        EXPECT_NE(what.find("model.glb"), std::string::npos) << what;
    }

    test::TempDir dir_;
    std::unique_ptr<MeshSource> source_;
};

TEST_F(GltfReader, ReadsTrianglesWhereTheyLie) {
    const test::ReadBack back = read(Square().glb.glb());
    EXPECT_EQ(back.mesh.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
    EXPECT_EQ(back.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}}));
    EXPECT_EQ(source_->info().format, "GLB");
    EXPECT_EQ(source_->held_temp_bytes(), 0U);
    EXPECT_FALSE(source_->info().has_double_positions);
}

TEST_F(GltfReader, ReadsIndicesOfAllTypesStripsFansAndNone) {
    for (const int component : {5121, 5123, 5125}) {
        Square square;
        const std::vector<std::uint32_t> ids{0, 1, 2, 2, 1, 3};
        const auto indices =
            component == 5121
                ? square.glb.add_array(std::vector<std::uint8_t>(ids.begin(), ids.end()), 1, 5121)
            : component == 5123
                ? square.glb.add_array(std::vector<std::uint16_t>(ids.begin(), ids.end()), 1, 5123)
                : square.glb.add_array(ids, 1, 5125);
        square.primitive()["indices"] = indices;
        EXPECT_EQ(read(square.glb.glb()).mesh.triangles,
                  (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}}));
    }
    Square square;
    square.primitive()["mode"] = 5;
    square.primitive()["indices"] =
        square.glb.add_array(std::vector<std::uint16_t>{0, 1, 2, 3, 3, 0}, 1, 5123);
    EXPECT_EQ(read(square.glb.glb()).mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}}));
    square.primitive()["mode"] = 6;
    square.primitive()["indices"] =
        square.glb.add_array(std::vector<std::uint16_t>{0, 1, 3, 2}, 1, 5123);
    EXPECT_EQ(read(square.glb.glb()).mesh.triangles, (std::vector<Triangle>{{0, 1, 3}, {0, 3, 2}}));
    square.primitive().erase("indices");
    EXPECT_EQ(read(square.glb.glb()).mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
    square.primitive()["mode"] = 4;
    EXPECT_EQ(read(square.glb.glb()).mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST_F(GltfReader, PlacesMeshesAsOftenAndWhereNodesSay) {
    Square square;
    // A turn by 90 degrees about z, a scale and a shift, inherited by a child with a shift.
    const double h = std::sqrt(0.5);
    square.glb.document["nodes"] = {{{"mesh", 0},
                                     {"translation", {10, 0, 0}},
                                     {"rotation", {0, 0, h, h}},
                                     {"scale", {2, 2, 2}},
                                     {"children", {1}}},
                                    {{"mesh", 0}, {"translation", {0, 0, 1}}},
                                    {{"mesh", 0}}};
    const test::ReadBack back = read(square.glb.glb());
    ASSERT_EQ(back.mesh.positions.size(), 8U);
    ASSERT_EQ(back.mesh.triangles.size(), 4U);
    const auto expect_near = [](const Vec3& a, const Vec3& b) {
        for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-6);
    };
    expect_near(back.mesh.positions[1], {10, 2, 0});
    expect_near(back.mesh.positions[2], {8, 0, 0});
    expect_near(back.mesh.positions[5], {10, 2, 2});
    EXPECT_EQ(back.mesh.triangles[2], (Triangle{4, 5, 6}));
}

TEST_F(GltfReader, TurnsMirroredTrianglesAndTheirNormalsRound) {
    Square square;
    square.primitive()["attributes"]["NORMAL"] =
        square.glb.add_array(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 1}, 3, 5126);
    square.glb.document["nodes"][0]["matrix"] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1};
    const test::ReadBack back = read(square.glb.glb());
    EXPECT_EQ(back.mesh.positions[1], (Vec3{-1, 0, 0}));
    EXPECT_EQ(back.mesh.triangles[0], (Triangle{0, 2, 1}));
    EXPECT_FLOAT_EQ(back.mesh.normals[0][2], 1);
    // Normals turn the other way than tangents where axes are scaled unequally.
    EXPECT_NEAR(back.mesh.normals[3][0], -2 / std::sqrt(5), 1e-6);
    EXPECT_NEAR(back.mesh.normals[3][2], 1 / std::sqrt(5), 1e-6);
}

TEST_F(GltfReader, KeepsFarCoordinatesPrecise) {
    Square square;
    square.glb.document["accessors"][0]["min"] = {0, 0, 0};
    square.glb.document["accessors"][0]["max"] = {1, 1, 0};
    square.glb.document["nodes"][0]["translation"] = {5000000.3, 0, 0};
    const test::ReadBack back = read(square.glb.glb());
    EXPECT_TRUE(source_->info().has_double_positions);
    EXPECT_DOUBLE_EQ(back.mesh.positions[1][0], 5000001.3);
}

TEST_F(GltfReader, TurnsLinearColoursOfAllTypesToThoseOfScans) {
    struct Case {
        int component;
        std::size_t n_components;
        std::string bytes;
    };
    const std::vector<Case> cases{
        {5121, 3, GlbBuilder::bytes_of(std::vector<std::uint8_t>{255, 0, 55, 0})},
        {5121, 4, GlbBuilder::bytes_of(std::vector<std::uint8_t>{255, 0, 55, 51})},
        {5123, 4, GlbBuilder::bytes_of(std::vector<std::uint16_t>{65535, 0, 14027, 13107})},
        {5126, 4, GlbBuilder::bytes_of(std::vector<float>{1.5F, -1, 0.2140411F, 0.2F})}};
    for (const Case& c : cases) {
        Square square;
        std::string bytes;
        for (int i = 0; i < 4; ++i) bytes += c.bytes;
        const std::size_t stride = c.bytes.size();
        square.primitive()["attributes"]["COLOR_0"] = square.glb.add_accessor(
            square.glb.add_view(bytes, stride), 4, c.component,
            "VEC" + std::to_string(c.n_components), {{"normalized", c.component != 5126}});
        const test::ReadBack back = read(square.glb.glb());
        ASSERT_EQ(back.mesh.colors.size(), 4U);
        const Rgba16 color = back.mesh.colors[3];
        EXPECT_EQ(color[0], 65535);
        EXPECT_EQ(color[1], 0);
        EXPECT_NEAR(color[2], 32768, c.component == 5121 ? 150 : 3);  // half of sRGB
        EXPECT_NEAR(color[3], c.n_components == 4 ? 13107 : 65535, 1);
        EXPECT_EQ(source_->info().has_alpha, c.n_components == 4);
    }
}

TEST_F(GltfReader, TakesTheColoursOfMaterialsWhereVerticesHaveNone) {
    Square square;
    Json& document = square.glb.document;
    document["materials"] = {
        {{"pbrMetallicRoughness",
          {{"baseColorFactor", {1, 0, 0, 1}}, {"baseColorTexture", {{"index", 0}}}}}},
        {{"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 1, 1}}}}}};
    Json second = square.primitive();
    square.primitive()["material"] = 0;
    second["material"] = 1;
    document["meshes"][0]["primitives"].push_back(second);
    const test::ReadBack back = read(square.glb.glb());
    EXPECT_EQ(back.mesh.colors[2], (Rgba16{65535, 0, 0, 65535}));
    EXPECT_EQ(back.mesh.colors[6], (Rgba16{0, 0, 65535, 65535}));
    EXPECT_EQ(source_->info().ignored,
              std::vector<std::string>{"textures of meshes without TEXCOORD_0"});
    // One paint for all is no property of vertices.
    document["meshes"][0]["primitives"][1]["material"] = 0;
    (void)read(square.glb.glb());
    EXPECT_FALSE(source_->info().has_colors);
}

TEST_F(GltfReader, ReadsQuantisedAndInterleavedAttributes) {
    Square square;
    std::vector<std::int16_t> values;
    for (std::size_t v = 0; v < 4; ++v) {
        for (std::size_t k = 0; k < 3; ++k) {
            values.push_back(static_cast<std::int16_t>(32767.0F * square_corners[3 * v + k]));
        }
        values.push_back(0);  // normal: four bytes, of which three count
        values.push_back(127);
    }
    const auto view = square.glb.add_view(GlbBuilder::bytes_of(values), 10);
    square.primitive()["attributes"]["POSITION"] =
        square.glb.add_accessor(view, 4, 5122, "VEC3", {{"normalized", true}});
    square.primitive()["attributes"]["NORMAL"] =
        square.glb.add_accessor(view, 4, 5120, "VEC3", {{"normalized", true}, {"byteOffset", 6}});
    square.glb.document["extensionsRequired"] = {"KHR_mesh_quantization"};
    square.glb.document["nodes"][0]["scale"] = {4, 4, 4};
    const test::ReadBack back = read(square.glb.glb());
    EXPECT_EQ(back.mesh.positions[3], (Vec3{4, 4, 0}));
    EXPECT_FLOAT_EQ(back.mesh.normals[3][2], 1);
}

TEST_F(GltfReader, PutsSparseAccessorsTogether) {
    for (const bool has_base : {true, false}) {
        Square square;
        Json& accessor = square.glb.document["accessors"][0];
        if (!has_base) accessor.erase("bufferView");
        const auto ids =
            square.glb.add_view(GlbBuilder::bytes_of(std::vector<std::uint16_t>{1, 3}));
        const auto values =
            square.glb.add_view(GlbBuilder::bytes_of(std::vector<float>{5, 6, 7, 8, 9, 10}));
        square.glb.document["accessors"][0]["sparse"] = {
            {"count", 2},
            {"indices", {{"bufferView", ids}, {"componentType", 5123}}},
            {"values", {{"bufferView", values}}}};
        const test::ReadBack back = read(square.glb.glb());
        EXPECT_EQ(back.mesh.positions[1], (Vec3{5, 6, 7}));
        EXPECT_EQ(back.mesh.positions[3], (Vec3{8, 9, 10}));
        EXPECT_EQ(back.mesh.positions[2], (has_base ? Vec3{0, 1, 0} : Vec3{0, 0, 0}));
    }
}

/// The square with its views compressed.
struct PackedSquare : Square {
    explicit PackedSquare(const std::string& extension) {
        std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(4, 12));
        packed.resize(
            meshopt_encodeVertexBuffer(packed.data(), packed.size(), square_corners.data(), 4, 12));
        const std::vector<std::uint32_t> ids{0, 1, 2, 2, 1, 3};
        std::vector<unsigned char> faces(meshopt_encodeIndexBufferBound(6, 4));
        faces.resize(meshopt_encodeIndexBuffer(faces.data(), faces.size(), ids.data(), 6));
        compress(extension, 0, packed, "ATTRIBUTES", 12, 4);
        compress(extension, 1, faces, "TRIANGLES", 2, 6);
        glb.document["extensionsRequired"] = {extension};
    }
    void compress(const std::string& extension, std::size_t view,
                  const std::vector<unsigned char>& bytes, const char* mode, std::uint64_t stride,
                  std::uint64_t count) {
        const auto at = glb.add_view(std::string(bytes.begin(), bytes.end()));
        Json& views = glb.document["bufferViews"];
        views[view]["extensions"][extension] = {{"buffer", 0},
                                                {"byteOffset", views[at]["byteOffset"]},
                                                {"byteLength", bytes.size()},
                                                {"byteStride", stride},
                                                {"count", count},
                                                {"mode", mode}};
        // What is not compressed is not there.
        views[view]["byteOffset"] = 1000000;
    }
};

TEST_F(GltfReader, DecodesMeshoptCompressedViews) {
    for (const std::string extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
        PackedSquare square(extension);
        const test::ReadBack back = read(square.glb.glb());
        EXPECT_EQ(back.mesh.positions[3], (Vec3{1, 1, 0}));
        EXPECT_EQ(back.mesh.triangles.size(), 2U);
        EXPECT_GT(source_->held_temp_bytes(), 0U);

        Json& packed = square.glb.document["bufferViews"][1]["extensions"][extension];
        packed["byteLength"] = 3;
        expect_refused(square.glb.glb(), "compressed buffer view 1 is damaged");
        packed["count"] = 1ULL << 40;
        EXPECT_THROW((void)open_mesh(dir_.write("m", square.glb.glb())), OutOfMemoryBudget);
    }
}

TEST_F(GltfReader, NamesWhatItDoesNotKnowOfMeshoptCompression) {
    const std::string extension = "KHR_meshopt_compression";
    PackedSquare square(extension);
    Json& packed = square.glb.document["bufferViews"][0]["extensions"][extension];
    packed["filter"] = "COLOR";
    expect_refused(square.glb.glb(), "filter COLOR");
    packed.erase("filter");
    // A stream of another version, of which no more is read than its first byte.
    const auto view = square.glb.add_view("\xa1" + std::string(63, '\0'));
    packed["byteOffset"] = square.glb.document["bufferViews"][view]["byteOffset"];
    packed["byteLength"] = 64;
    if (MESHOPTIMIZER_VERSION < 230) expect_refused(square.glb.glb(), "version 1");
}

TEST_F(GltfReader, ReadsAttributesWithNamesOfTheirOwnAsWeights) {
    Square square;
    square.primitive()["attributes"]["_QUALITY"] = square.glb.add_array(
        std::vector<std::uint8_t>{0, 51, 255, 255}, 1, 5121, {{"normalized", true}});
    square.primitive()["attributes"]["_OTHER"] =
        square.glb.add_array(std::vector<float>{1, 2, 3, 4}, 1, 5126);
    const auto path = dir_.write("w.glb", square.glb.glb());
    const auto weights = [&](const std::string& name) {
        source_ = open_mesh(path, {.weight_property = name});
        source_->begin_vertices();
        VertexBatch batch;
        EXPECT_TRUE(source_->next_vertices(batch));
        return batch.weights;
    };
    EXPECT_EQ(weights("_OTHER"), (std::vector<float>{1, 2, 3, 4}));
    EXPECT_EQ(weights("_QUALITY"), (std::vector<float>{0, 0.2F, 1, 1}));
    EXPECT_TRUE(source_->info().has_weights);
    EXPECT_EQ(source_->info().ignored, std::vector<std::string>{"_OTHER"});
    try {
        (void)weights("_CONFIDENCE");
        FAIL();
    } catch (const InvalidArgument& error) {
        const std::string what = error.what();
        EXPECT_NE(what.find("there are _OTHER, _QUALITY"), std::string::npos) << what;
    }
    // Of three numbers, or too few.
    square.primitive()["attributes"]["_QUALITY"] = square.primitive()["attributes"]["POSITION"];
    EXPECT_NE(refusal(square.glb.glb(), {.weight_property = "_QUALITY"}).find("fit together"),
              std::string::npos);
}

TEST_F(GltfReader, NamesWhatStandsBehindItsEnd) {
    const std::string glb = Square().glb.glb();
    EXPECT_EQ(read(glb + glb).mesh.triangles.size(), 2U);
    EXPECT_EQ(
        source_->info().ignored,
        std::vector<std::string>{"the " + std::to_string(glb.size()) + " bytes behind the GLB"});
}

TEST_F(GltfReader, ReadsBuffersBesideTheDocumentAndInsideIt) {
    Square square;
    Json document = square.glb.document;
    const std::string& binary = square.glb.binary();
    (void)dir_.write("my bytes.bin", binary);
    document["buffers"] = {{{"byteLength", binary.size()}, {"uri", "my%20bytes.bin"}}};
    auto source = open_mesh(dir_.write("a.gltf", document.dump(1)));
    EXPECT_EQ(source->info().format, "glTF");
    EXPECT_EQ(test::read_all(*source).mesh.triangles.size(), 2U);

    static constexpr char kDigits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < binary.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            bits = bits << 8 |
                   (i + k < binary.size() ? static_cast<unsigned char>(binary[i + k]) : 0U);
        }
        for (int shift = 18; shift >= 0; shift -= 6) text += kDigits[bits >> shift & 63U];
    }
    document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + text;
    source = open_mesh(dir_.write("b.gltf", document.dump()));
    EXPECT_EQ(test::read_all(*source).mesh.positions[3], (Vec3{1, 1, 0}));
    EXPECT_GE(source->held_temp_bytes(), binary.size());

    document["buffers"][0]["uri"] = "missing.bin";
    EXPECT_THROW((void)open_mesh(dir_.write("c.gltf", document.dump())), IoError);
    document["buffers"][0]["uri"] = "https://example.org/a.bin";
    EXPECT_NE(refusal(document.dump()).find("https://example.org/a.bin"), std::string::npos);
    document["buffers"][0]["uri"] = "data:;base64,****";
    EXPECT_NE(refusal(document.dump()).find("damaged"), std::string::npos);
}

TEST_F(GltfReader, IsTheSameForAnyNumberOfThreads) {
    GlbBuilder glb;
    std::vector<float> positions;
    std::vector<std::uint32_t> ids;
    positions.reserve(210000);
    ids.reserve(300000);
    std::mt19937 random(3);
    for (int v = 0; v < 70000; ++v) {
        for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(random() % 1000));
    }
    for (int i = 0; i < 300000; ++i) ids.push_back(static_cast<std::uint32_t>(random() % 70000));
    const auto p = glb.add_array(positions, 3, 5126);
    const auto strip = glb.add_array(ids, 1, 5125);
    glb.document["meshes"] = {
        {{"primitives",
          {{{"attributes", {{"POSITION", p}}}, {"indices", strip}},
           {{"attributes", {{"POSITION", p}}}, {"indices", strip}, {"mode", 5}}}}}};
    glb.document["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}}};
    const test::ReadBack one = read(glb.glb(), 1);
    const test::ReadBack four = read(glb.glb(), 4);
    EXPECT_EQ(one.mesh.positions.size(), 280000U);
    EXPECT_EQ(one.mesh.positions, four.mesh.positions);
    EXPECT_EQ(one.mesh.triangles, four.mesh.triangles);
}

TEST_F(GltfReader, CountsDirt) {
    Square square;
    std::vector<float> positions = square_corners;
    positions[4] = std::numeric_limits<float>::quiet_NaN();
    square.primitive()["attributes"]["POSITION"] = square.glb.add_array(positions, 3, 5126);
    square.primitive()["indices"] =
        square.glb.add_array(std::vector<std::uint16_t>{0, 1, 2, 2, 1, 4}, 1, 5123);
    const test::ReadBack back = read(square.glb.glb());
    EXPECT_EQ(back.defects.nonfinite_vertices, 1U);
    EXPECT_EQ(back.defects.out_of_range_triangles, 1U);
    EXPECT_EQ(back.mesh.triangles.size(), 1U);
    EXPECT_NE(refusal(square.glb.glb(), {.strict = true}).find("strict"), std::string::npos);
}

TEST_F(GltfReader, RefusesWhatLeadsNowhere) {
    const std::string whole = Square().glb.glb();
    expect_refused(whole.substr(0, whole.size() - 40), "truncated");
    expect_refused(whole.substr(0, 15), "JSON chunk");
    expect_refused(std::string(whole).replace(4, 1, "\x01"), "version 1");
    const auto with = [](const std::function<void(Json&)>& change) {
        Square square;
        change(square.glb.document);
        return square.glb.glb();
    };
    using D = Json&;
    expect_refused(with([](D d) { d["accessors"][0]["count"] = 5; }), "accessor 0 needs 60 bytes");
    expect_refused(with([](D d) { d["accessors"][0]["count"] = ~0ULL; }), "accessor 0");
    expect_refused(with([](D d) { d["accessors"][0]["byteOffset"] = ~0ULL; }), "accessor 0");
    expect_refused(with([](D d) { d["accessors"][0]["count"] = 0; }), "accessor 0");
    expect_refused(with([](D d) { d["accessors"][0]["count"] = -1; }), "accessors[0].count");
    expect_refused(with([](D d) { d["accessors"][0]["type"] = "MAT4"; }), "accessor 0");
    expect_refused(with([](D d) { d["accessors"][0]["componentType"] = 5130; }), "5130");
    expect_refused(with([](D d) { d["accessors"][0]["bufferView"] = 9; }), "buffer view 9");
    expect_refused(with([](D d) { d["bufferViews"][0]["byteOffset"] = ~0ULL; }), "buffer view 0");
    expect_refused(with([](D d) { d["bufferViews"][0]["byteLength"] = 1 << 20; }), "buffer view 0");
    expect_refused(with([](D d) { d["bufferViews"][0]["byteStride"] = 1; }), "accessor 0");
    expect_refused(with([](D d) { d["bufferViews"][0]["buffer"] = 7; }), "no buffer 7");
    expect_refused(with([](D d) { d["meshes"][0]["primitives"][0]["indices"] = 70; }),
                   "accessor 70");
    expect_refused(with([](D d) { d["meshes"][0]["primitives"][0]["indices"] = 0; }),
                   "do not fit together");
    expect_refused(with([](D d) { d["meshes"][0]["primitives"] = 3; }), "meshes[0].primitives");
    expect_refused(with([](D d) { d["nodes"][0]["mesh"] = 3; }), "no mesh 3");
    expect_refused(with([](D d) { d["scenes"][0]["nodes"] = {4}; }), "no node 4");
    expect_refused(with([](D d) { d["scene"] = 4; }), "no scene 4");
    expect_refused(with([](D d) { d["nodes"][0]["children"] = {0}; }), "its own ancestor");
    expect_refused(with([](D d) { d["nodes"][0]["children"] = {0, 0, 0}; }), "its own ancestor");
    expect_refused(with([](D d) { d["extensionsRequired"] = {"EXT_cubes"}; }), "EXT_cubes");
    expect_refused(with([](D d) { d["meshes"][0]["primitives"][0]["mode"] = 0; }), "no faces");
    expect_refused(with([](D d) {
                       d["nodes"][0]["translation"] = {1e308, 0, 0};
                       d["nodes"][0]["scale"] = {1e308, 1, 1};
                       d["nodes"][0]["children"] = {1};
                       d["nodes"].push_back(d["nodes"][0]);
                       d["nodes"][1].erase("children");
                   }),
                   "not finite");
    expect_refused(GlbBuilder::glb_of("{", ""), "JSON is damaged");
    expect_refused(GlbBuilder::glb_of(std::string(100000, '['), ""), "JSON is damaged");
    const std::string deep = std::string(5000, '[') + std::string(5000, ']');
    expect_refused(GlbBuilder::glb_of(R"({"asset":{"version":"2.0"},"x":)" + deep + "}", ""),
                   "too deeply");
    expect_refused(GlbBuilder::glb_of("[]", ""), "object");
}

TEST_F(GltfReader, RefusesADocumentThatIsLargerThanTheLimit) {
    Square square;
    square.glb.document["extras"] = std::string(4 << 20, 'x');
    const auto path = dir_.write("large.glb", square.glb.glb());
    EXPECT_THROW((void)open_mesh(path, {.memory_bytes = 64 << 20}), OutOfMemoryBudget);
    EXPECT_NO_THROW((void)open_mesh(path, {.memory_bytes = 512 << 20}));
}

TEST_F(GltfReader, SurvivesMutatedFiles) {
    std::mt19937 random(11);
    Square square;
    square.glb.document["nodes"][0]["scale"] = {2, 2, 2};
    const std::string whole = square.glb.glb();
    int n_read = 0;
    for (int round = 0; round < 3000; ++round) {
        std::string file = whole;
        for (std::size_t n = 1 + random() % 3; n > 0; --n) {
            file[4 + random() % (file.size() - 4)] = random() % 2 == 0
                                                         ? static_cast<char>(random())
                                                         : static_cast<char>('0' + random() % 10);
        }
        if (random() % 4 == 0) file.resize(random() % file.size());
        try {
            const auto source =
                open_mesh(dir_.write("model.glb", file), {.memory_bytes = 64 << 20});
            (void)test::read_all(*source);
            ++n_read;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()), "");
        }
    }
    EXPECT_GT(n_read, 0);
}

TEST_F(GltfReader, ReadsBackWhatTheWriterWrites) {
    Mesh mesh;
    std::mt19937 random(5);
    const Vec3 origin{4'500'000, 300'000, 100};
    for (int v = 0; v < 500; ++v) {
        mesh.positions.push_back({origin[0] + static_cast<double>(random() % 1000) / 64,
                                  origin[1] + static_cast<double>(random() % 1000) / 64,
                                  origin[2] + static_cast<double>(random() % 1000) / 64});
        mesh.normals.push_back({0, 1, 0});
        const auto eight_bits = [&] { return static_cast<std::uint16_t>(random() % 256 * 257); };
        mesh.colors.push_back({eight_bits(), eight_bits(), eight_bits(), eight_bits()});
    }
    for (std::uint64_t v = 2; v < 500; ++v) mesh.triangles.push_back({v - 2, v - 1, v});
    SinkHeader header{.n_vertices = 500,
                      .n_triangles = 498,
                      .has_normals = true,
                      .has_colors = true,
                      .has_alpha = true,
                      .bounds = {},
                      .has_double_positions = true};
    for (const Vec3& p : mesh.positions) header.bounds.extend(p);
    const auto path = dir_.path() / "written.glb";
    const auto sink = create_mesh_file(path);
    sink->begin(header);
    sink->add_vertices({mesh.positions, mesh.normals, mesh.colors});
    sink->add_triangles(mesh.triangles);
    sink->finish();
    const auto source = open_mesh(path);
    EXPECT_TRUE(source->info().has_double_positions);
    const test::ReadBack back = test::read_all(*source, 2);
    EXPECT_EQ(back.mesh.triangles, mesh.triangles);
    for (std::size_t v = 0; v < 500; ++v) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(back.mesh.positions[v][k], mesh.positions[v][k], 1e-6);
            // The same of 256 steps.
            EXPECT_EQ((back.mesh.colors[v][k] * 255 + 32767) / 65535, mesh.colors[v][k] / 257);
        }
        EXPECT_EQ(back.mesh.colors[v][3], mesh.colors[v][3]);
        EXPECT_FLOAT_EQ(back.mesh.normals[v][1], 1);
    }
}

}  // namespace
}  // namespace hewer
