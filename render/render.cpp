// SPDX-License-Identifier: MIT
/// render(): bounds of all meshes, then for each its positions and its triangles; each is a pass of
/// the source.
#include "hewer/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "hewer/error.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "ooc/file.h"
#include "ooc/parallel.h"
#include "render/png.h"
#include "render/rasteriser.h"

namespace hewer {

namespace {

constexpr unsigned kMostPixelsASide = 32768;
// Of half the picture: how far the bounding sphere reaches at zoom 1.
constexpr double kFill = 0.98;
constexpr double kDegree = 3.14159265358979323846 / 180;

bool is_finite(const Vec3& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

void check(const RenderOptions& options) {
    if (options.width == 0 || options.height == 0 || options.width > kMostPixelsASide ||
        options.height > kMostPixelsASide) {
        throw InvalidArgument("a picture of " + std::to_string(options.width) + " x " +
                              std::to_string(options.height) + " pixels: each side must be 1 .. " +
                              std::to_string(kMostPixelsASide));
    }
    if (!(options.zoom > 0) || !std::isfinite(options.zoom)) {
        throw InvalidArgument("the zoom must be above 0");
    }
    if (!std::isfinite(options.azimuth_degrees) || !std::isfinite(options.elevation_degrees)) {
        throw InvalidArgument("the camera's angles must be finite");
    }
}

/// Azimuth 0 looks at the front as modelling programs have it: from -y with z up, from +z with y
/// up. Growing azimuth walks to the right of the model.
raster::Camera make_camera(const RenderOptions& options, double diagonal) {
    const double a = options.azimuth_degrees * kDegree;
    const double e = options.elevation_degrees * kDegree;
    const double radius = diagonal > 0 ? 0.5 * diagonal : 1;
    raster::Camera camera;
    camera.right = {std::cos(a), std::sin(a), 0};
    camera.toward = {std::cos(e) * std::sin(a), -std::cos(e) * std::cos(a), std::sin(e)};
    camera.up = {-std::sin(e) * std::sin(a), std::sin(e) * std::cos(a), std::cos(e)};
    if (options.y_up) {
        for (Vec3* v : {&camera.right, &camera.toward, &camera.up})
            *v = {(*v)[0], (*v)[2], -(*v)[1]};
    }
    camera.pixels_per_unit =
        options.zoom * kFill * 0.5 * std::min(options.width, options.height) / radius;
    camera.depth_range = 1.01 * radius;
    return camera;
}

/// One mesh and what is kept of its vertices.
class Picture {
  public:
    Picture(ooc::Context& context, MeshSource& mesh, const RenderOptions& options)
        : mesh_(mesh),
          options_(options),
          has_paint_(options.use_colors && mesh.info().has_colors),
          context_(context) {}

    [[nodiscard]] Bounds find_bounds();
    /// Fills `pixels` with options.width x options.height of them; `bounds` are those of all meshes
    /// that are to be seen alike.
    void draw(const Bounds& bounds, std::span<std::uint8_t> pixels);

  private:
    /// Calls body(batch) for all batches of a pass, on all threads.
    template <typename Batch, typename Body>
    void for_batches(bool (MeshSource::*next)(Batch&), const Body& body) {
        context_.workers().on_each([&](unsigned) {
            Batch batch;
            while ((mesh_.*next)(batch)) body(batch);
        });
    }
    void keep_vertices();
    void draw_triangles(raster::Rasteriser& rasteriser);
    [[nodiscard]] Vec3 position(std::uint64_t vertex) const {
        const float* p = positions_.data() + 3 * vertex;
        return {p[0], p[1], p[2]};
    }

    MeshSource& mesh_;
    const RenderOptions& options_;
    bool has_paint_;
    ooc::Context& context_;
    Vec3 center_{};
    ooc::Array<float> positions_;                    // relative to center_
    ooc::Array<std::array<std::uint8_t, 3>> paint_;  // of vertices
};

Bounds Picture::find_bounds() {
    Bounds bounds;
    std::mutex mutex;
    const auto merge = [&](const Bounds& part) {
        const std::lock_guard lock(mutex);
        bounds.extend(part);
    };
    const SourceInfo& info = mesh_.info();
    context_.begin_stage("bounds", info.is_indexed ? info.n_vertices : info.n_faces,
                         info.is_indexed ? "vertices" : "triangles");
    if (info.is_indexed) {
        mesh_.begin_vertices();
        for_batches(&MeshSource::next_vertices, [&](const VertexBatch& batch) {
            Bounds part;
            for (const Vec3& p : batch.positions) {
                if (is_finite(p)) part.extend(p);
            }
            merge(part);
            context_.advance(batch.positions.size());
        });
    } else {
        mesh_.begin_triangles();
        for_batches(&MeshSource::next_triangles, [&](const TriangleBatch& batch) {
            Bounds part;
            for (const auto& corners : batch.points) {
                for (const Vec3& p : corners) part.extend(p);
            }
            merge(part);
            context_.advance(batch.n_faces);
        });
    }
    context_.end_stage();
    return bounds;
}

void Picture::keep_vertices() {
    const std::uint64_t n = mesh_.info().n_vertices;
    positions_ = ooc::Array<float>(context_.budget(), "vertex positions", 3 * n);
    if (has_paint_) paint_ = {context_.budget(), "vertex colours", n};
    context_.begin_stage("vertices", n, "vertices");
    mesh_.begin_vertices();
    for_batches(&MeshSource::next_vertices, [&](const VertexBatch& batch) {
        for (std::size_t i = 0; i < batch.positions.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                positions_[3 * (batch.first + i) + k] =
                    static_cast<float>(batch.positions[i][k] - center_[k]);
            }
        }
        if (has_paint_) {
            for (std::size_t i = 0; i < batch.colors.size(); ++i) {
                for (std::size_t k = 0; k < 3; ++k) {
                    paint_[batch.first + i][k] =
                        static_cast<std::uint8_t>((batch.colors[i][k] + 128U) / 257);
                }
            }
        }
        context_.advance(batch.positions.size());
    });
    context_.end_stage();
}

void Picture::draw_triangles(raster::Rasteriser& rasteriser) {
    context_.begin_stage("triangles", mesh_.info().n_faces, "faces");
    mesh_.begin_triangles();
    for_batches(&MeshSource::next_triangles, [&](const TriangleBatch& batch) {
        for (const Triangle& t : batch.corners) {
            raster::Rasteriser::Paint paint{};
            if (has_paint_) {
                for (std::size_t c = 0; c < 3; ++c) {
                    for (std::size_t k = 0; k < 3; ++k) {
                        paint[c][k] = static_cast<float>(paint_[t[c]][k]) * (1.0F / 255);
                    }
                }
            }
            rasteriser.draw({position(t[0]), position(t[1]), position(t[2])},
                            has_paint_ ? &paint : nullptr);
        }
        for (const auto& corners : batch.points) {
            std::array<Vec3, 3> local{};
            for (std::size_t c = 0; c < 3; ++c) {
                for (std::size_t k = 0; k < 3; ++k) local[c][k] = corners[c][k] - center_[k];
            }
            rasteriser.draw(local, nullptr);
        }
        context_.advance(batch.n_faces);
    });
    context_.end_stage();
}

void Picture::draw(const Bounds& bounds, std::span<std::uint8_t> pixels) {
    if (!bounds.is_empty()) center_ = bounds.center();
    if (mesh_.info().is_indexed) keep_vertices();
    raster::Style style;
    style.edges = options_.edges;
    raster::Rasteriser rasteriser(context_.budget(), options_.width, options_.height,
                                  make_camera(options_, bounds.diagonal()), style);
    draw_triangles(rasteriser);
    positions_.release();
    paint_.release();
    rasteriser.resolve(pixels);
}

/// Copies rows of `panel` to where they belong in `picture`, `n` panels wide.
void place_panel(std::span<const std::uint8_t> panel, std::size_t row_bytes, std::size_t i,
                 std::size_t n, std::span<std::uint8_t> picture) {
    for (std::size_t row = 0; row * row_bytes < panel.size(); ++row) {
        const auto from = panel.subspan(row * row_bytes, row_bytes);
        std::copy(from.begin(), from.end(),
                  picture.subspan((row * n + i) * row_bytes, row_bytes).begin());
    }
}

}  // namespace

void render(std::span<MeshSource* const> meshes, const std::filesystem::path& png,
            const RenderOptions& options, const Hooks& hooks) {
    check(options);
    if (meshes.empty() || meshes.size() * options.width > kMostPixelsASide) {
        throw InvalidArgument(std::to_string(meshes.size()) + " pictures of " +
                              std::to_string(options.width) +
                              " pixels side by side: their widths must add up to 1 .. " +
                              std::to_string(kMostPixelsASide));
    }
    std::vector<ooc::StageWeight> stages;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        stages.insert(stages.end(), {{"bounds", 1}, {"vertices", 1}, {"triangles", 4}});
    }
    ooc::Context context({.memory_bytes = options.memory_bytes,
                          .n_threads = options.n_threads,
                          .temp_dir = options.temp_dir,
                          .max_temp_bytes = options.max_temp_bytes},
                         hooks, stages);
    std::vector<ooc::HeldInput> held;
    for (const MeshSource* mesh : meshes) held.push_back(context.hold(*mesh));
    ooc::OutputFile file(png, options.overwrite);  // refuses before the work, not after
    Bounds bounds;
    for (MeshSource* mesh : meshes) bounds.extend(Picture(context, *mesh, options).find_bounds());
    const std::size_t row_bytes = std::size_t{3} * options.width;
    ooc::Array<std::uint8_t> picture(context.budget(), "picture",
                                     meshes.size() * row_bytes * options.height);
    {
        ooc::Array<std::uint8_t> panel(context.budget(), "picture", row_bytes * options.height);
        for (std::size_t i = 0; i < meshes.size(); ++i) {
            Picture(context, *meshes[i], options).draw(bounds, panel.span());
            place_panel(panel.span(), row_bytes, i, meshes.size(), picture.span());
        }
    }
    raster::write_png(file, picture.span(), static_cast<unsigned>(meshes.size()) * options.width,
                      options.height, context.budget());
    file.commit();
}

void render(MeshSource& mesh, const std::filesystem::path& png, const RenderOptions& options,
            const Hooks& hooks) {
    MeshSource* const one = &mesh;
    render(std::span(&one, 1), png, options, hooks);
}

}  // namespace hewer
