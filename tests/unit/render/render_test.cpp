// SPDX-License-Identifier: MIT
#include "hewer/render.h"

#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"

namespace hewer {
namespace {

namespace fs = std::filesystem;

struct Image {
    unsigned width = 0;
    unsigned height = 0;
    std::vector<std::uint8_t> pixels;

    [[nodiscard]] std::array<int, 3> at(unsigned x, unsigned y) const {
        const std::uint8_t* p = pixels.data() + 3 * (y * width + x);
        return {p[0], p[1], p[2]};
    }
    template <typename Test>
    [[nodiscard]] double share(const Test& test) const {
        double n = 0;
        for (unsigned y = 0; y < height; ++y) {
            for (unsigned x = 0; x < width; ++x) n += test(at(x, y)) ? 1 : 0;
        }
        return n / (width * height);
    }
};

Image read_png(const fs::path& path) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    EXPECT_NE(png_image_begin_read_from_file(&png, path.c_str()), 0) << png.message;
    png.format = PNG_FORMAT_RGB;
    Image image{png.width, png.height, std::vector<std::uint8_t>(PNG_IMAGE_SIZE(png))};
    EXPECT_NE(png_image_finish_read(&png, nullptr, image.pixels.data(), 0, nullptr), 0);
    return image;
}

// The background is faintly blue, the default stone faintly yellow, the inside red.
bool is_background(const std::array<int, 3>& c) {
    return c[2] > c[0] && c[0] > 200;
}
bool is_warning(const std::array<int, 3>& c) {
    return c[0] > 2 * c[1] && c[0] > 2 * c[2];
}

/// Corners at +-1, two triangles a side, outwards.
Mesh cube() {
    Mesh mesh;
    for (const double z : {-1, 1}) {
        for (const double y : {-1, 1}) {
            for (const double x : {-1, 1}) mesh.positions.push_back({x, y, z});
        }
    }
    constexpr std::array<std::array<std::uint64_t, 4>, 6> sides{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& s : sides) {
        mesh.triangles.push_back({s[0], s[1], s[2]});
        mesh.triangles.push_back({s[0], s[2], s[3]});
    }
    return mesh;
}

/// The triangles of a mesh without its indices.
class Soup final : public MeshSource {
  public:
    explicit Soup(const Mesh& mesh) {
        info_.name = "soup";
        info_.is_indexed = false;
        info_.n_faces = mesh.triangles.size();
        for (const Triangle& t : mesh.triangles) {
            points_.push_back({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
        }
    }
    [[nodiscard]] const SourceInfo& info() const override { return info_; }
    void begin_vertices() override {}
    bool next_vertices(VertexBatch& /*batch*/) override { return false; }
    void begin_triangles() override { is_done_ = false; }
    bool next_triangles(TriangleBatch& batch) override {
        const std::lock_guard lock(mutex_);
        if (std::exchange(is_done_, true)) return false;
        batch.corners.clear();
        batch.points = points_;
        batch.n_faces = points_.size();
        return true;
    }
    [[nodiscard]] std::uint64_t bytes_read() const override { return 0; }

  private:
    SourceInfo info_;
    std::vector<std::array<Vec3, 3>> points_;
    std::mutex mutex_;
    bool is_done_ = false;
};

class Render : public testing::Test {
  protected:
    Render() { fs::create_directories(folder_); }
    ~Render() override { fs::remove_all(folder_); }
    Render(const Render&) = delete;
    Render& operator=(const Render&) = delete;

    Image draw(MeshSource& source, RenderOptions options = {}) {
        options.overwrite = true;
        render(source, folder_ / "picture.png", options);
        return read_png(folder_ / "picture.png");
    }
    Image draw(const Mesh& mesh, const RenderOptions& options = {}) {
        const auto source = view_mesh(mesh);
        return draw(*source, options);
    }
    /// Straight at one side.
    static RenderOptions front() {
        return {.width = 200, .height = 120, .azimuth_degrees = 0, .elevation_degrees = 0};
    }

    fs::path folder_ = fs::temp_directory_path() / ("hewer-render-" + std::to_string(::getpid()));
};

TEST_F(Render, ACubeSeenFromTheFrontCoversItsSquare) {
    const Image image = draw(cube(), front());
    ASSERT_EQ(image.width, 200U);
    ASSERT_EQ(image.height, 120U);
    // The bounding sphere, radius sqrt(3), reaches 98 % of half the height.
    const double side = 2 * 0.98 * 60 / std::sqrt(3.0);
    const double covered = 1 - image.share(is_background);
    EXPECT_NEAR(covered, side * side / (200 * 120), 0.01);
    EXPECT_EQ(image.share(is_warning), 0);
    EXPECT_TRUE(is_background(image.at(10, 60)));
    EXPECT_FALSE(is_background(image.at(100, 60)));
}

TEST_F(Render, ZoomEnlarges) {
    RenderOptions options = front();
    const double small = 1 - draw(cube(), options).share(is_background);
    options.zoom = 0.5;
    EXPECT_NEAR(1 - draw(cube(), options).share(is_background), small / 4, 0.01);
}

TEST_F(Render, BackFacesShowInTheWarningColor) {
    Mesh inside_out = cube();
    for (Triangle& t : inside_out.triangles) std::swap(t[0], t[1]);
    const Image image = draw(inside_out);
    EXPECT_GT(image.share(is_warning), 0.2);
    EXPECT_EQ(image.share([](const auto& c) { return !is_warning(c) && c[0] < 100; }), 0);

    // Without its front side (y = -1, triangles 4 and 5) one looks into the cube.
    Mesh open = cube();
    open.triangles.erase(open.triangles.begin() + 4, open.triangles.begin() + 6);
    EXPECT_TRUE(is_warning(draw(open, front()).at(100, 60)));
}

TEST_F(Render, TheNearestTriangleWinsInAnyOrder) {
    Mesh mesh;
    // A small red square before a large green one, seen from -y.
    for (const auto& [half, y, color] : {std::tuple{0.5, -0.5, Rgba16{65535, 0, 0, 65535}},
                                         std::tuple{1.0, 0.5, Rgba16{0, 65535, 0, 65535}}}) {
        const std::uint64_t v = mesh.positions.size();
        mesh.positions.insert(
            mesh.positions.end(),
            {{-half, y, -half}, {half, y, -half}, {half, y, half}, {-half, y, half}});
        mesh.colors.insert(mesh.colors.end(), 4, color);
        mesh.triangles.insert(mesh.triangles.end(), {{v, v + 1, v + 2}, {v, v + 2, v + 3}});
    }
    for (int round = 0; round < 2; ++round) {
        const Image image = draw(mesh, front());
        EXPECT_EQ(image.at(100, 60)[1], 0);
        EXPECT_GT(image.at(100, 60)[0], 100);
        EXPECT_GT(image.at(100 + 24, 60)[1], 100);
        EXPECT_EQ(image.at(100 + 24, 60)[0], 0);
        std::swap(mesh.triangles[0], mesh.triangles[2]);
        std::swap(mesh.triangles[1], mesh.triangles[3]);
    }
    RenderOptions plain = front();
    plain.use_colors = false;
    EXPECT_GT(draw(mesh, plain).at(100, 60)[1], 100);
}

TEST_F(Render, AxesPointWhereTheOptionsSay) {
    // A cube with a long arm along +x; azimuth 90 looks from +x with either axis up.
    Mesh mesh = cube();
    for (Vec3& p : mesh.positions) {
        if (p[0] > 0) p[0] = 9;
    }
    for (const bool y_up : {false, true}) {
        RenderOptions options = front();
        options.y_up = y_up;
        const double along = 1 - draw(mesh, options).share(is_background);
        options.azimuth_degrees = 90;
        const double end_on = 1 - draw(mesh, options).share(is_background);
        EXPECT_NEAR(along / end_on, 5, 0.5);
        EXPECT_EQ(draw(mesh, options).share(is_warning), 0);
    }
}

TEST_F(Render, EdgesDarkenThePicture) {
    RenderOptions options = front();
    options.edges = true;
    const auto is_dark = [](const std::array<int, 3>& c) { return c[0] < 150; };
    EXPECT_EQ(draw(cube(), front()).share(is_dark), 0);
    const double dark = draw(cube(), options).share(is_dark);
    EXPECT_GT(dark, 0.005);
    EXPECT_LT(dark, 0.05);
}

TEST_F(Render, SoupsAndIndexedMeshesLookAlikeForAnyThreads) {
    RenderOptions options{.width = 150, .height = 150, .n_threads = 1};
    const Image indexed = draw(cube(), options);
    const Mesh mesh = cube();
    Soup soup(mesh);
    EXPECT_EQ(draw(soup, options).pixels, indexed.pixels);
    options.n_threads = 4;
    EXPECT_EQ(draw(mesh, options).pixels, indexed.pixels);
}

TEST_F(Render, FarFromTheOriginLooksTheSame) {
    Mesh far = cube();
    for (Vec3& p : far.positions) p = {p[0] + 500'000, p[1] + 5'400'000, p[2]};
    EXPECT_EQ(draw(far).pixels, draw(cube()).pixels);
}

TEST_F(Render, NonFiniteVerticesDoNotSpoilThePicture) {
    Mesh mesh = cube();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    mesh.positions.push_back({nan, 0, 0});
    mesh.triangles.push_back({0, 1, 8});
    EXPECT_EQ(draw(mesh).pixels, draw(cube()).pixels);
}

TEST_F(Render, AnEmptyMeshGivesTheBackground) {
    EXPECT_EQ(draw(Mesh{}).share(is_background), 1);
}

TEST_F(Render, SeveralMeshesStandSideBySideBeforeTheSameCamera) {
    const Mesh large = cube();
    Mesh small = cube();
    for (Vec3& p : small.positions) p = {0.5 * p[0] + 0.5, 0.5 * p[1], 0.5 * p[2]};
    small.colors.assign(small.positions.size(), {0, 65535, 0, 65535});
    const auto a = view_mesh(large);
    const auto b = view_mesh(small);
    const std::array<MeshSource*, 3> meshes{a.get(), b.get(), a.get()};
    RenderOptions options = front();
    options.overwrite = true;
    render(meshes, folder_ / "picture.png", options);
    const Image image = read_png(folder_ / "picture.png");
    ASSERT_EQ(image.width, 600U);
    ASSERT_EQ(image.height, 120U);
    const Image alone = draw(large, front());
    for (const unsigned x : {10U, 70U, 100U, 133U, 190U}) {
        for (const unsigned y : {5U, 30U, 60U, 100U}) {
            EXPECT_EQ(image.at(x, y), alone.at(x, y));
            EXPECT_EQ(image.at(400 + x, y), alone.at(x, y));
        }
    }
    // The small one fills the right middle of the square that the large one does.
    EXPECT_EQ(image.at(200 + 117, 60)[0], 0);
    EXPECT_TRUE(is_background(image.at(200 + 90, 60)));
    EXPECT_TRUE(is_background(image.at(200 + 117, 40)));
    EXPECT_FALSE(is_background(image.at(90, 40)));
    EXPECT_THROW(render(std::span<MeshSource* const>(), folder_ / "none.png", options),
                 InvalidArgument);
    options.width = 20'000;
    EXPECT_THROW(render(meshes, folder_ / "none.png", options), InvalidArgument);
}

TEST_F(Render, RefusesBadOptionsAndExistingFiles) {
    const Mesh mesh = cube();
    const auto source = view_mesh(mesh);
    const fs::path out = folder_ / "kept.png";
    EXPECT_THROW(render(*source, out, {.width = 0}), InvalidArgument);
    EXPECT_THROW(render(*source, out, {.height = 100'000}), InvalidArgument);
    EXPECT_THROW(render(*source, out, {.zoom = 0}), InvalidArgument);
    EXPECT_TRUE(fs::is_empty(folder_));
    EXPECT_THROW(render(*source, out, {.memory_bytes = 20 << 20}), OutOfMemoryBudget);
    EXPECT_TRUE(fs::is_empty(folder_));
    std::ofstream(out) << "precious";
    EXPECT_THROW(render(*source, out, {}), IoError);
    EXPECT_EQ(fs::file_size(out), 8U);
}

}  // namespace
}  // namespace hewer
