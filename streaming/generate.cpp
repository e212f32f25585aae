// SPDX-License-Identifier: MIT
/// generate(): counts, header, vertices, faces, each in one pass over a pure function of the ids.
#include "hewer/generate.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hewer/error.h"
#include "ooc/context.h"
#include "ooc/file.h"
#include "ooc/parallel.h"
#include "streaming/box_grid.h"
#include "streaming/lattice_noise.h"
#include "streaming/permutation.h"
#include "streaming/scan_holes.h"
#include "streaming/scan_surface.h"

namespace hewer {

namespace {

using streaming::BoxGrid;
using streaming::Permutation;
using streaming::ScanHoles;
using streaming::ScanSurface;
using streaming::UsedVertices;

static_assert(std::endian::native == std::endian::little, "values go out as they lie in memory");

/// Elements computed by one task; a multiple of ScanSurface::kBlock.
constexpr std::uint64_t kChunk = 8192;
/// Chunks that are computed, per thread, while as many others are written.
constexpr std::uint64_t kChunksPerThread = 4;

constexpr std::size_t kPositionBytes = 12;
constexpr std::size_t kColorBytes = 3;
constexpr std::size_t kFaceBytes = 13;

/// Computes chunks on all workers and writes them in order: while one wave of chunks is computed,
/// one of the tasks writes the wave before. Memory: two waves, reserved.
class OrderedWriter {
  public:
    /// No item takes more than `item_bytes`.
    OrderedWriter(ooc::Context& context, ooc::OutputFile& file, std::size_t item_bytes)
        : context_(context),
          file_(file),
          n_chunks_(context.n_threads() * kChunksPerThread),
          reservation_(
              context.budget().reserve("generator buffers", 2 * n_chunks_ * kChunk * item_bytes)),
          current_(n_chunks_),
          previous_(n_chunks_) {
        for (auto* wave : {&current_, &previous_}) {
            for (std::vector<char>& chunk : *wave) chunk.reserve(kChunk * item_bytes);
        }
    }

    /// fill(first, last, bytes) appends the items [first, last) to `bytes`; called by many threads.
    template <typename Fill>
    void write(std::uint64_t n_items, const Fill& fill) {
        const std::uint64_t wave_items = n_chunks_ * kChunk;
        for (std::uint64_t first = 0; first < n_items; first += wave_items) {
            const std::uint64_t last = std::min(first + wave_items, n_items);
            const std::uint64_t n = (last - first + kChunk - 1) / kChunk;
            context_.workers().for_ranges(n + 1, 1, [&](std::uint64_t begin, std::uint64_t end) {
                for (std::uint64_t task = begin; task < end; ++task) {
                    if (task == 0) {
                        flush_previous();
                        continue;
                    }
                    const std::uint64_t chunk_first = first + (task - 1) * kChunk;
                    fill(chunk_first, std::min(chunk_first + kChunk, last), current_[task - 1]);
                }
            });
            std::swap(current_, previous_);
            context_.advance(last - first);
        }
        flush_previous();
    }

  private:
    void flush_previous() {
        for (std::vector<char>& chunk : previous_) {
            file_.write(chunk.data(), chunk.size());
            chunk.clear();
        }
    }

    ooc::Context& context_;
    ooc::OutputFile& file_;
    std::uint64_t n_chunks_;
    ooc::Reservation reservation_;
    std::vector<std::vector<char>> current_;
    std::vector<std::vector<char>> previous_;
};

void append(std::vector<char>& bytes, const void* data, std::size_t size) {
    const auto* p = static_cast<const char*>(data);
    bytes.insert(bytes.end(), p, p + size);
}

void append_face(std::vector<char>& bytes, const std::array<std::uint64_t, 3>& corners) {
    std::array<char, kFaceBytes> face{3};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto id = static_cast<std::uint32_t>(corners[k]);
        std::memcpy(face.data() + 1 + 4 * k, &id, 4);
    }
    append(bytes, face.data(), kFaceBytes);
}

/// The vertices of `ids`, at most ScanSurface::kBlock.
void append_vertices(const ScanSurface& surface, std::span<const std::uint64_t> ids, bool color,
                     std::vector<char>& bytes) {
    if (ids.empty()) return;
    ScanSurface::Samples samples;
    surface.evaluate(ids, color, samples);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        std::array<char, kPositionBytes + kColorBytes> record;
        const std::array<float, 3> position{samples.x[i], samples.y[i], samples.z[i]};
        std::memcpy(record.data(), position.data(), kPositionBytes);
        if (color)
            std::memcpy(record.data() + kPositionBytes, samples.color[i].data(), kColorBytes);
        append(bytes, record.data(), color ? record.size() : kPositionBytes);
    }
}

/// Which diagonal cuts a quad: by chance, so that no direction is preferred.
bool cuts_02(std::uint64_t quad) {
    return (streaming::mix_bits(quad) & 1) != 0;
}

std::string header(const GenerateReport& counts, bool color, bool wide) {
    std::string text =
        "ply\nformat binary_little_endian 1.0\ncomment a synthetic scan made by hewer generate\n"
        "element vertex " +
        std::to_string(counts.vertices) +
        "\nproperty float x\nproperty float y\nproperty float z\n";
    if (color) text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    text += "element face " + std::to_string(counts.triangles) + "\nproperty list uchar " +
            (wide ? "uint" : "int") + " vertex_indices\nend_header\n";
    return text;
}

/// One run: the surface as it was asked for, and how its elements are ordered in the file.
class Generator {
  public:
    Generator(const GenerateOptions& options, const Hooks& hooks)
        : options_(options),
          grid_(BoxGrid::for_triangles(options.n_triangles)),
          surface_(grid_, options.seed),
          context_({.n_threads = options.n_threads}, hooks, stages(options)) {}

    GenerateReport run(const std::filesystem::path& output);

  private:
    static std::vector<ooc::StageWeight> stages(const GenerateOptions& options) {
        std::vector<ooc::StageWeight> all{{"vertices", 3}, {"faces", 1}};
        if (options.holes) all.insert(all.begin(), {"count", 1});
        return all;
    }

    [[nodiscard]] streaming::QuadTriangles triangles_of(std::uint64_t index,
                                                        const BoxGrid::Quad& quad) const {
        std::array<bool, 4> seen{true, true, true, true};
        if (holes_) seen = holes_->are_seen(quad);
        return streaming::cut_quad(seen, cuts_02(index));
    }
    void count_with_holes();
    void write_vertices(ooc::OutputFile& file);
    void write_faces(ooc::OutputFile& file);
    void write_shuffled_faces(ooc::OutputFile& file);

    GenerateOptions options_;
    BoxGrid grid_;
    ScanSurface surface_;
    ooc::Context context_;
    std::optional<ScanHoles> holes_;
    std::optional<UsedVertices> used_;
    std::optional<Permutation> vertex_order_;
    GenerateReport report_;
};

void Generator::count_with_holes() {
    holes_.emplace(surface_, options_.seed);
    context_.begin_stage("count", grid_.n_quads(), "quads");
    used_.emplace(grid_, *holes_, context_);
    std::atomic<std::uint64_t> triangles{0};
    context_.workers().for_ranges(grid_.n_quads(), kChunk,
                                  [&](std::uint64_t first, std::uint64_t last) {
                                      std::uint64_t n = 0;
                                      for (std::uint64_t q = first; q < last; ++q)
                                          n += triangles_of(q, grid_.quad(q)).count;
                                      triangles += n;
                                      context_.advance(last - first);
                                  });
    context_.end_stage();
    report_.vertices = used_->count();
    report_.triangles = triangles;
}

void Generator::write_vertices(ooc::OutputFile& file) {
    const std::size_t item_bytes = kPositionBytes + (options_.color ? kColorBytes : 0);
    context_.begin_stage("vertices", grid_.n_vertices(), "vertices");
    OrderedWriter writer(context_, file, item_bytes);
    writer.write(grid_.n_vertices(),
                 [&](std::uint64_t first, std::uint64_t last, std::vector<char>& bytes) {
                     std::array<std::uint64_t, ScanSurface::kBlock> ids;
                     std::size_t n = 0;
                     for (std::uint64_t i = first; i < last; ++i) {
                         if (holes_ && !holes_->is_used(grid_, grid_.point(i))) continue;
                         ids[n++] = vertex_order_ ? (*vertex_order_)(i) : i;
                         if (n < ids.size()) continue;
                         append_vertices(surface_, ids, options_.color, bytes);
                         n = 0;
                     }
                     append_vertices(surface_, {ids.data(), n}, options_.color, bytes);
                 });
    context_.end_stage();
}

void Generator::write_faces(ooc::OutputFile& file) {
    context_.begin_stage("faces", grid_.n_quads(), "quads");
    OrderedWriter writer(context_, file, 2 * kFaceBytes);
    writer.write(grid_.n_quads(),
                 [&](std::uint64_t first, std::uint64_t last, std::vector<char>& bytes) {
                     std::optional<UsedVertices::Lookup> lookup;
                     if (used_) lookup.emplace(*used_);
                     for (std::uint64_t q = first; q < last; ++q) {
                         const BoxGrid::Quad quad = grid_.quad(q);
                         const streaming::QuadTriangles triangles = triangles_of(q, quad);
                         for (std::size_t t = 0; t < triangles.count; ++t) {
                             std::array<std::uint64_t, 3> ids{};
                             for (std::size_t k = 0; k < 3; ++k) {
                                 ids[k] = grid_.vertex(quad[triangles.corners[t][k]]);
                                 if (lookup) ids[k] = (*lookup)(ids[k]);
                             }
                             append_face(bytes, ids);
                         }
                     }
                 });
    context_.end_stage();
}

void Generator::write_shuffled_faces(ooc::OutputFile& file) {
    const std::uint64_t n = 2 * grid_.n_quads();
    const Permutation order(n, options_.seed + 1);
    context_.begin_stage("faces", n, "triangles");
    OrderedWriter writer(context_, file, kFaceBytes);
    writer.write(n, [&](std::uint64_t first, std::uint64_t last, std::vector<char>& bytes) {
        for (std::uint64_t i = first; i < last; ++i) {
            const std::uint64_t triangle = order(i);
            const BoxGrid::Quad quad = grid_.quad(triangle / 2);
            const auto corners = triangles_of(triangle / 2, quad).corners[triangle % 2];
            std::array<std::uint64_t, 3> ids{};
            for (std::size_t k = 0; k < 3; ++k) {
                ids[k] = vertex_order_->inverse(grid_.vertex(quad[corners[k]]));
            }
            append_face(bytes, ids);
        }
    });
    context_.end_stage();
}

GenerateReport Generator::run(const std::filesystem::path& output) {
    ooc::OutputFile file(output, options_.overwrite);
    report_.vertices = grid_.n_vertices();
    report_.triangles = 2 * grid_.n_quads();
    if (options_.holes) count_with_holes();
    if (options_.shuffle) vertex_order_.emplace(grid_.n_vertices(), options_.seed);
    // Signed indices reach as far as 2^31 vertices.
    file.write(header(report_, options_.color, report_.vertices > (std::uint64_t{1} << 31)));
    write_vertices(file);
    if (options_.shuffle) {
        write_shuffled_faces(file);
    } else {
        write_faces(file);
    }
    report_.bytes = file.bytes_written();
    file.commit();
    report_.seconds = context_.elapsed_seconds();
    return report_;
}

}  // namespace

GenerateReport generate(const std::filesystem::path& output, const GenerateOptions& options,
                        const Hooks& hooks) {
    if (options.shuffle && options.holes) {
        // A shuffled face needs the new number of any vertex of the grid, at random: with holes
        // that is a count over the whole grid, or a table.
        throw InvalidArgument("--shuffle and --holes cannot be combined: give one of them");
    }
    return Generator(options, hooks).run(output);
}

}  // namespace hewer
