// SPDX-License-Identifier: MIT
#include "streaming/ply_textures.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "ooc/context.h"
#include "ooc/spool.h"
#include "streaming/mesh_import.h"
#include "streaming/mtl_reader.h"
#include "streaming/ply_layout.h"
#include "streaming/ply_reader.h"
#include "streaming/ply_rows.h"
#include "streaming/temporary_input.h"
#include "streaming/texture_set.h"
#include "streaming/vertex_paint.h"

namespace hewer::streaming {

namespace {

constexpr Rgba16 kWhite{65535, 65535, 65535, 65535};
constexpr Rgba16 kUnpainted{0, 0, 0, 0};  // painted ones are opaque
constexpr std::size_t kPiece = 16384;
constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();

/// A mesh with other colours at its vertices.
class PaintedSource final : public MeshSource {
  public:
    /// `colors`: one a vertex; null if no texture gives any.
    PaintedSource(std::unique_ptr<MeshSource> mesh, SourceInfo info,
                  std::unique_ptr<ooc::InputFile> colors)
        : mesh_(std::move(mesh)), info_(std::move(info)), colors_(std::move(colors)) {}

    [[nodiscard]] const SourceInfo& info() const override { return info_; }
    [[nodiscard]] std::uint64_t bytes_read() const override { return mesh_->bytes_read(); }
    [[nodiscard]] std::uint64_t held_memory_bytes() const override {
        return mesh_->held_memory_bytes();
    }
    [[nodiscard]] std::uint64_t held_temp_bytes() const override {
        return mesh_->held_temp_bytes() + (colors_ ? colors_->held_temp_bytes() : 0);
    }

    void begin_vertices() override { mesh_->begin_vertices(); }
    bool next_vertices(VertexBatch& batch) override {
        if (!mesh_->next_vertices(batch)) return false;
        paint(batch);
        return true;
    }
    [[nodiscard]] bool can_seek_vertices() const override { return mesh_->can_seek_vertices(); }
    void read_vertices(std::uint64_t first, std::uint64_t n, VertexBatch& batch) override {
        mesh_->read_vertices(first, n, batch);
        paint(batch);
    }
    void begin_triangles() override { mesh_->begin_triangles(); }
    bool next_triangles(TriangleBatch& batch) override { return mesh_->next_triangles(batch); }

  private:
    void paint(VertexBatch& batch) const {
        if (!colors_) return;
        std::vector<Rgba16> painted(batch.positions.size());
        colors_->read_at(batch.first * sizeof(Rgba16), painted.data(),
                         painted.size() * sizeof(Rgba16));
        batch.colors.resize(painted.size(), kWhite);
        for (std::size_t i = 0; i < painted.size(); ++i) {
            if (painted[i] != kUnpainted)
                std::copy_n(painted[i].begin(), 3, batch.colors[i].begin());
        }
    }

    std::unique_ptr<MeshSource> mesh_;
    SourceInfo info_;
    std::unique_ptr<ooc::InputFile> colors_;
};

class PlyTextures {
  public:
    PlyTextures(std::shared_ptr<const ooc::InputFile> file, PlyHeader header,
                const PlyLayout& layout, const OpenOptions& options, const Hooks& hooks)
        : file_(std::move(file)),
          header_(std::move(header)),
          layout_(layout),
          options_(options),
          context_({.memory_bytes = options.memory_bytes,
                    .n_threads = options.n_threads,
                    .temp_dir = options.temp_dir,
                    .max_temp_bytes = options.max_temp_bytes},
                   hooks, {{"import", 1}}),
          textures_(context_),
          positions_(context_, "positions"),
          texcoords_(context_, "texture coordinates"),
          triangles_(context_, "triangles"),
          numbers_(context_, "numbers of textures") {}

    std::unique_ptr<MeshSource> paint(std::unique_ptr<MeshSource> mesh) {
        SourceInfo info = mesh->info();
        std::vector<Paint> paints = read_textures();
        info.textures = textures_.infos();
        for (const std::string& what : textures_.missing()) info.ignored.push_back(what);
        if (info.textures.empty()) {
            info.ignored.emplace_back("texture coordinates");
            return std::make_unique<PaintedSource>(std::move(mesh), std::move(info), nullptr);
        }
        context_.begin_stage("import", file_->size(), "bytes");
        copy_positions(*mesh);
        if (header_.encoding == PlyEncoding::Ascii) {
            walk(TextStream(*file_, n_bytes_read_, header_.n_bytes, header_.n_lines + 1));
        } else {
            const bool is_little = header_.encoding == PlyEncoding::LittleEndian;
            walk(BinaryStream(*file_, n_bytes_read_, header_.n_bytes,
                              is_little != (std::endian::native == std::endian::little)));
        }
        if (!texcoords().is_at_corners) triangles_ = copy_triangles(context_, *mesh);
        std::unique_ptr<ooc::InputFile> colors = make_colors(*mesh, std::move(paints));
        context_.end_stage();
        info.has_colors = true;
        return std::make_unique<PaintedSource>(std::move(mesh), std::move(info), std::move(colors));
    }

  private:
    [[nodiscard]] const PlyTexcoords& texcoords() const { return *layout_.texcoords; }

    /// By the numbers of textures.
    std::vector<Paint> read_textures() {
        std::vector<Paint> paints;
        const std::filesystem::path folder = file_->path().parent_path();
        for (const std::string& name : header_.texture_files) {
            Paint paint;
            paint.texture = textures_.add_file(find_beside(folder, name), options_.strict);
            paint.to_image = {{{1, 0, 0}, {0, -1, 1}}};  // v goes up
            paints.push_back(paint);
        }
        return paints;
    }

    /// Where they cannot be read from the middle of the file.
    void copy_positions(MeshSource& mesh) {
        mesh.begin_vertices();
        if (mesh.can_seek_vertices()) return;
        VertexBatch batch;
        while (mesh.next_vertices(batch)) {
            positions_.append(batch.positions);
            context_.check_stop();
        }
    }

    template <typename Stream>
    void walk(Stream stream) {
        const std::size_t last =
            texcoords().is_at_corners ? layout_.face_element : layout_.vertex_element;
        for (std::size_t i = 0; i < last; ++i) {
            skip_rows(stream, RowShape::of<Stream>(header_.elements[i]));
        }
        const PlyElement& element = header_.elements[last];
        if (texcoords().is_at_corners) {
            read_corners(stream, element);
        } else {
            read_vertices(stream, element);
        }
    }

    /// Once for each row that has been read.
    template <typename Stream>
    void follow(const Stream& stream) {
        if (uvs_.size() < kPiece) return;
        flush();
        context_.advance(stream.offset() - n_bytes_done_);
        n_bytes_done_ = stream.offset();
    }

    void flush() {
        texcoords_.append(uvs_);
        triangles_.append(corners_);
        numbers_.append(textures_of_corners_);
        uvs_.clear();
        corners_.clear();
        textures_of_corners_.clear();
    }

    template <typename Stream>
    void read_vertices(Stream& stream, const PlyElement& element) {
        RowValues<Stream> values(stream, element, {texcoords().uv[0], texcoords().uv[1]});
        while (values.next()) {
            uvs_.push_back(
                {static_cast<float>(values.number(0)), static_cast<float>(values.number(1))});
            follow(stream);
        }
        flush();
    }

    /// Fans, as the reader makes them. What is no triangle is left to the reader to count.
    template <typename Stream>
    void read_corners(Stream& stream, const PlyElement& element) {
        std::vector<std::size_t> wanted{layout_.corner_property, texcoords().list};
        if (texcoords().texture) wanted.push_back(*texcoords().texture);
        RowValues<Stream> values(stream, element, wanted);
        while (values.next()) {
            const std::vector<double>& ids = values.list(0);
            const std::vector<double>& uv = values.list(1);
            const std::uint32_t texture = texcoords().texture ? to_number(values.number(2)) : 0;
            const bool is_textured = uv.size() == 2 * ids.size();
            for (std::size_t i = 2; i < ids.size(); ++i) {
                corners_.emplace_back(Triangle{to_id(ids[0]), to_id(ids[i - 1]), to_id(ids[i])});
                textures_of_corners_.push_back(texture);
                for (const std::size_t corner : {std::size_t{0}, i - 1, i}) {
                    uvs_.push_back(
                        is_textured ? std::array<float, 2>{static_cast<float>(uv[2 * corner]),
                                                           static_cast<float>(uv[2 * corner + 1])}
                                    : std::array<float, 2>{kNowhere, kNowhere});
                }
            }
            follow(stream);
        }
        flush();
    }

    static std::uint64_t to_id(double value) {
        constexpr auto kNone = PackedTriangle::kMostVertices - 1;
        return value >= 0 && value < static_cast<double>(kNone) ? static_cast<std::uint64_t>(value)
                                                                : kNone;
    }
    static std::uint32_t to_number(double value) {
        return value >= 0 && value < static_cast<double>(PaintedTriangle::kNoPaint)
                   ? static_cast<std::uint32_t>(value)
                   : PaintedTriangle::kNoPaint;
    }

    std::unique_ptr<ooc::InputFile> make_colors(MeshSource& mesh, std::vector<Paint> paints) {
        PaintedMesh painted;
        painted.n_vertices = mesh.info().n_vertices;
        painted.load_positions = [&](std::uint64_t first, std::uint64_t n, Vec3* out) {
            if (!positions_.empty()) return positions_.read(first, {out, n});
            VertexBatch batch;
            mesh.read_vertices(first, n, batch);
            std::copy(batch.positions.begin(), batch.positions.end(), out);
        };
        painted.n_texcoords = texcoords_.size();
        painted.load_texcoords = [&](std::uint64_t first, std::uint64_t n,
                                     std::array<float, 2>* out) {
            texcoords_.read(first, {out, n});
        };
        painted.n_triangles = triangles_.size();
        painted.read_triangles = [&](std::uint64_t first, std::span<PaintedTriangle> out) {
            read_triangles(first, out);
        };
        painted.paints = std::move(paints);

        TemporaryInput colors(beside(options_, context_.spill().used()));
        std::vector<Rgba16> piece;
        paint_vertices(context_, painted, textures_, [&](std::span<const VertexColor> found) {
            piece.assign(found.size(), kUnpainted);
            for (std::size_t i = 0; i < found.size(); ++i) {
                if (found[i]) piece[i] = to_rgba(*found[i]);
            }
            colors.append(piece.data(), piece.size() * sizeof(Rgba16));
        });
        return colors.finish(file_->path());
    }

    void read_triangles(std::uint64_t first, std::span<PaintedTriangle> out) const {
        std::vector<PackedTriangle> corners(out.size());
        triangles_.read(first, corners);
        std::vector<std::uint32_t> numbers(out.size());
        if (!numbers_.empty()) numbers_.read(first, numbers);
        for (std::size_t i = 0; i < out.size(); ++i) {
            const Triangle t = corners[i].unpack();
            const std::uint64_t at = 3 * (first + i);
            out[i] = {t, texcoords().is_at_corners ? Triangle{at, at + 1, at + 2} : t, numbers[i]};
        }
    }

    std::shared_ptr<const ooc::InputFile> file_;
    PlyHeader header_;
    PlyLayout layout_;
    OpenOptions options_;
    ooc::Context context_;
    TextureSet textures_;
    ooc::Spool<Vec3> positions_;
    ooc::Spool<std::array<float, 2>> texcoords_;
    ooc::Spool<PackedTriangle> triangles_;
    ooc::Spool<std::uint32_t> numbers_;  // of textures, by triangle; none: all have the first
    std::atomic<std::uint64_t> n_bytes_read_{0};
    std::uint64_t n_bytes_done_ = 0;

    // Of the piece at hand.
    std::vector<std::array<float, 2>> uvs_;
    std::vector<PackedTriangle> corners_;
    std::vector<std::uint32_t> textures_of_corners_;
};

}  // namespace

std::unique_ptr<MeshSource> open_textured_ply(std::unique_ptr<ooc::InputFile> file,
                                              const OpenOptions& options, const Hooks& hooks) {
    const std::shared_ptr<const ooc::InputFile> shared = std::move(file);
    PlyHeader header = read_ply_header(*shared);
    std::unique_ptr<MeshSource> mesh = open_ply(shared, header, options);
    SourceInfo info;
    const PlyLayout layout = plan_ply(header, shared->path(), info, options.weight_property);
    if (!layout.texcoords) return mesh;
    return PlyTextures(shared, std::move(header), layout, options, hooks).paint(std::move(mesh));
}

}  // namespace hewer::streaming
