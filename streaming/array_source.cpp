// SPDX-License-Identifier: MIT
#include "streaming/array_source.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "hewer/error.h"
#include "streaming/block_pool.h"
#include "streaming/byte_buffer.h"
#include "streaming/findings.h"
#include "streaming/triangle_fan.h"

namespace hewer::streaming {

namespace {

constexpr std::uint64_t kBatch = 16384;
constexpr bool kSwap = std::endian::native == std::endian::big;
constexpr double kFullScale = 65535;

/// sRGB for every 16-bit value of linear light (IEC 61966-2-1): what the GLB writer undoes.
const std::vector<std::uint16_t>& srgb_table() {
    static const std::vector<std::uint16_t> table = [] {
        std::vector<std::uint16_t> t(65536);
        for (std::size_t i = 0; i < t.size(); ++i) {
            const double l = static_cast<double>(i) / kFullScale;
            const double c = l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
            t[i] = static_cast<std::uint16_t>(std::lround(c * kFullScale));
        }
        return t;
    }();
    return table;
}

/// What one step of a component means.
template <typename T>
constexpr double scale_of(bool is_normalized) {
    if constexpr (std::is_floating_point_v<T>) {
        return 1;
    } else {
        return is_normalized ? 1.0 / static_cast<double>(std::numeric_limits<T>::max()) : 1;
    }
}

constexpr auto kRelaxed = std::memory_order_relaxed;

std::size_t n_bytes_of(const StridedArray& array, std::uint64_t n) {
    return (n - 1) * array.stride + array.element_bytes();
}

/// The bytes of elements first .. first + n - 1, or null if they are zeros. `name` for messages.
const unsigned char* read_bytes(const std::string& name, const StridedArray& array,
                                std::uint64_t first, std::uint64_t n, ByteBuffer& buffer) {
    if (!array.file || n == 0) return nullptr;
    const std::uint64_t offset = array.offset + first * array.stride;
    const std::size_t bytes = n_bytes_of(array, n);
    const std::size_t got = array.file->read_at(offset, buffer.room_for(bytes), bytes);
    if (got < bytes) {
        throw FormatError(name + ": truncated: " + array.file->path().string() + " ends at byte " +
                          std::to_string(offset + got));
    }
    return buffer.data();
}

/// take(i, values) with the first N components of each of `n` elements that lie at `bytes`; zeros
/// if that is null.
template <std::size_t N, typename Take>
void take_components(const StridedArray& array, std::uint64_t n, const unsigned char* bytes,
                     const Take& take) {
    std::array<double, N> values{};
    if (bytes == nullptr) {
        for (std::size_t i = 0; i < n; ++i) take(i, values);
        return;
    }
    with_scalar_type(array.type, [&](auto tag) {
        using T = typename decltype(tag)::Type;
        const double scale = scale_of<T>(array.is_normalized);
        const double least = array.is_normalized ? -1 : std::numeric_limits<double>::lowest();
        for (std::size_t i = 0; i < n; ++i) {
            const unsigned char* p = bytes + i * array.stride;
            for (std::size_t k = 0; k < N; ++k, p += sizeof(T)) {
                values[k] = static_cast<double>(load<T, kSwap>(p));
                if constexpr (!std::is_floating_point_v<T>) {
                    values[k] = std::max(least, values[k] * scale);
                }
            }
            take(i, values);
        }
    });
}

/// The inverse transpose up to a factor, which normals do not have; and the sign of the
/// determinant, which says whether the map turns a surface inside out.
struct NormalMap {
    std::array<Vec3, 3> rows;
    bool flips;

    explicit NormalMap(const Affine& m) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto& a = m[(i + 1) % 3];
            const auto& b = m[(i + 2) % 3];
            rows[i] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                       a[0] * b[1] - a[1] * b[0]};
        }
        flips = m[0][0] * rows[0][0] + m[0][1] * rows[0][1] + m[0][2] * rows[0][2] < 0;
    }

    [[nodiscard]] std::array<float, 3> apply(const Vec3& n) const {
        Vec3 mapped{};
        for (std::size_t i = 0; i < 3; ++i) {
            mapped[i] = rows[i][0] * n[0] + rows[i][1] * n[1] + rows[i][2] * n[2];
        }
        const double length = std::hypot(mapped[0], mapped[1], mapped[2]);
        // The cofactors carry the sign of the determinant.
        const double scale = length > 0 ? (flips ? -1 : 1) / length : 0;
        return {static_cast<float>(scale * mapped[0]), static_cast<float>(scale * mapped[1]),
                static_cast<float>(scale * mapped[2])};
    }
};

class ArraySource final : public MeshSource {
  public:
    ArraySource(ArrayMesh mesh, bool is_strict)
        : mesh_(std::move(mesh)),
          normal_map_(mesh_.transform),
          is_moved_(mesh_.transform != kIdentity),
          reporter_(mesh_.name, is_strict) {
        info_.name = mesh_.name;
        info_.format = mesh_.format;
        info_.n_bytes = mesh_.n_bytes;
        info_.textures = mesh_.textures;
        info_.ignored = mesh_.ignored;
        info_.n_vertices = mesh_.positions.count;
        info_.n_faces = mesh_.n_faces();
        info_.has_double_positions = mesh_.has_double_positions;
        info_.has_normals = mesh_.normals.count > 0;
        info_.has_colors = mesh_.has_any_color();
        info_.has_weights = mesh_.weights.count > 0;
        info_.has_alpha =
            info_.has_colors && (mesh_.colors.n_components == 4 || mesh_.color_factor[3] != 1);
    }

    [[nodiscard]] const SourceInfo& info() const override { return info_; }
    [[nodiscard]] std::uint64_t bytes_read() const override { return n_bytes_read_.load(); }
    [[nodiscard]] std::uint64_t held_temp_bytes() const override { return mesh_.held_temp_bytes; }

    void begin_vertices() override { next_ = 0; }
    bool next_vertices(VertexBatch& batch) override {
        const std::uint64_t first = next_.fetch_add(kBatch);
        if (first >= info_.n_vertices) {
            batch = {};
            return false;
        }
        read_vertices(first, std::min(kBatch, info_.n_vertices - first), batch);
        for (std::size_t i = 0; i < batch.positions.size(); ++i) {
            const Vec3& p = batch.positions[i];
            if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) continue;
            if (batch.defects.nonfinite_vertices++ > 0) continue;
            reporter_.report_nonfinite(batch, first + i, [&] {
                return "byte " + std::to_string(mesh_.positions.offset +
                                                (first + i) * mesh_.positions.stride);
            });
        }
        return true;
    }

    [[nodiscard]] bool can_seek_vertices() const override { return true; }
    void read_vertices(std::uint64_t first, std::uint64_t n, VertexBatch& batch) override {
        batch.first = first;
        batch.defects = {};
        const auto buffer = buffers_.lease();
        batch.positions.resize(n);
        read_components<3>(mesh_.positions, first, n, *buffer,
                           [&](std::size_t i, const Vec3& p) { batch.positions[i] = p; });
        if (is_moved_) {
            for (Vec3& p : batch.positions) p = transformed(mesh_.transform, p);
            if (!info_.has_double_positions) round_to_float(batch.positions);
        }
        batch.normals.resize(info_.has_normals ? n : 0);
        if (info_.has_normals) {
            read_components<3>(mesh_.normals, first, n, *buffer, [&](std::size_t i, const Vec3& p) {
                batch.normals[i] = normal_map_.apply(p);
            });
        }
        batch.weights.resize(info_.has_weights ? n : 0);
        if (info_.has_weights) {
            read_components<1>(mesh_.weights, first, n, *buffer, [&](std::size_t i, const auto& w) {
                batch.weights[i] = static_cast<float>(w[0]);
            });
        }
        batch.colors.resize(info_.has_colors ? n : 0);
        if (info_.has_colors) read_colors(first, n, *buffer, batch.colors);
    }

    void begin_triangles() override { next_ = 0; }
    bool next_triangles(TriangleBatch& batch) override {
        batch.corners.clear();
        batch.points.clear();
        batch.defects = {};
        const std::uint64_t first = next_.fetch_add(kBatch);
        if (first >= info_.n_faces) return false;
        const std::uint64_t n = std::min(kBatch, info_.n_faces - first);
        batch.first_face = first;
        batch.n_faces = n;
        const auto buffer = buffers_.lease();
        switch (mesh_.mode) {
            case ArrayMesh::Mode::Triangles: {
                const auto ids = read_ids(3 * first, 3 * n, *buffer);
                add_triangles(batch, [&](std::uint64_t i) {
                    return Triangle{ids[3 * i], ids[3 * i + 1], ids[3 * i + 2]};
                });
                break;
            }
            case ArrayMesh::Mode::Strip: {
                const auto ids = read_ids(first, n + 2, *buffer);
                add_triangles(batch, [&](std::uint64_t i) {
                    const bool is_turned = ((first + i) & 1U) != 0;
                    return is_turned ? Triangle{ids[i + 1], ids[i], ids[i + 2]}
                                     : Triangle{ids[i], ids[i + 1], ids[i + 2]};
                });
                break;
            }
            case ArrayMesh::Mode::Fan: {
                const std::uint64_t hub = read_ids(0, 1, *buffer).front();
                const auto ids = read_ids(first + 1, n + 1, *buffer);
                add_triangles(batch, [&](std::uint64_t i) {
                    return Triangle{hub, ids[i], ids[i + 1]};
                });
                break;
            }
        }
        return true;
    }

  private:
    const unsigned char* read_bytes(const StridedArray& array, std::uint64_t first, std::uint64_t n,
                                    ByteBuffer& buffer) {
        const unsigned char* const bytes =
            streaming::read_bytes(info_.name, array, first, n, buffer);
        if (bytes != nullptr) n_bytes_read_.fetch_add(n_bytes_of(array, n), kRelaxed);
        return bytes;
    }

    template <std::size_t N, typename Take>
    void read_components(const StridedArray& array, std::uint64_t first, std::uint64_t n,
                         ByteBuffer& buffer, const Take& take) {
        take_components<N>(array, n, read_bytes(array, first, n, buffer), take);
    }

    static void round_to_float(std::vector<Vec3>& positions) {
        for (Vec3& p : positions) {
            // Through memory: GCC 12 takes rounding to float and back for nothing where it makes
            // vectors of neighbours.
            volatile float rounded = 0;
            for (double& x : p) {
                rounded = static_cast<float>(x);
                x = static_cast<double>(rounded);
            }
        }
    }

    void read_colors(std::uint64_t first, std::uint64_t n, ByteBuffer& buffer,
                     std::vector<Rgba16>& colors) {
        const auto take = [&](std::size_t i, std::array<double, 4> c) {
            const std::vector<std::uint16_t>& srgb = srgb_table();
            for (std::size_t k = 0; k < 4; ++k) {
                const double x = c[k] * mesh_.color_factor[k];
                const auto v = static_cast<std::uint16_t>(
                    std::lround((x > 0 ? std::min(x, 1.0) : 0) * kFullScale));
                colors[i][k] = k < 3 && mesh_.has_linear_colors ? srgb[v] : v;
            }
        };
        if (mesh_.colors.count == 0) {
            for (std::size_t i = 0; i < n; ++i) take(i, {1, 1, 1, 1});
        } else if (mesh_.colors.n_components == 4) {
            read_components<4>(mesh_.colors, first, n, buffer, take);
        } else {
            read_components<3>(mesh_.colors, first, n, buffer, [&](std::size_t i, const Vec3& c) {
                take(i, {c[0], c[1], c[2], 1});
            });
        }
    }

    std::vector<std::uint64_t> read_ids(std::uint64_t first, std::uint64_t n, ByteBuffer& buffer) {
        std::vector<std::uint64_t> ids(n);
        if (mesh_.indices.count == 0) {
            for (std::uint64_t i = 0; i < n; ++i) ids[i] = first + i;
            return ids;
        }
        const unsigned char* const bytes = read_bytes(mesh_.indices, first, n, buffer);
        if (bytes == nullptr) return ids;
        with_integer_type(mesh_.indices.type, [&](auto tag) {
            using T = typename decltype(tag)::Type;
            for (std::uint64_t i = 0; i < n; ++i) {
                ids[i] = std::uint64_t{static_cast<std::make_unsigned_t<T>>(
                    load<T, kSwap>(bytes + i * mesh_.indices.stride))};
            }
        });
        return ids;
    }

    template <typename TriangleAt>
    void add_triangles(TriangleBatch& batch, const TriangleAt& triangle_at) {
        FaceFindings findings;
        batch.corners.reserve(batch.n_faces);
        for (std::uint64_t i = 0; i < batch.n_faces; ++i) {
            Triangle t = triangle_at(i);
            if (std::max({t[0], t[1], t[2]}) >= info_.n_vertices) {
                if (findings.n_out_of_range++ == 0) findings.first_out_of_range_row = i;
                continue;
            }
            // Repeated ids only stitch a strip: they make no triangle.
            const bool is_stitch = mesh_.mode != ArrayMesh::Mode::Triangles &&
                                   (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]);
            if (is_stitch) continue;
            if (normal_map_.flips) std::swap(t[1], t[2]);
            batch.corners.push_back(t);
        }
        reporter_.report_faces(findings, batch, info_.n_vertices, [&](std::uint64_t row) {
            return "index " + std::to_string(batch.first_face + row);
        });
    }

    ArrayMesh mesh_;
    NormalMap normal_map_;
    bool is_moved_;
    FindingsReporter reporter_;
    SourceInfo info_;
    std::atomic<std::uint64_t> n_bytes_read_{0};
    std::atomic<std::uint64_t> next_{0};
    BlockPool<ByteBuffer> buffers_;
};

}  // namespace

std::unique_ptr<MeshSource> open_arrays(ArrayMesh mesh, bool is_strict) {
    return std::make_unique<ArraySource>(std::move(mesh), is_strict);
}

void load_texcoords(const ArrayMesh& mesh, std::uint64_t first, std::uint64_t n,
                    std::array<float, 2>* out) {
    ByteBuffer buffer;
    const unsigned char* const bytes = read_bytes(mesh.name, mesh.texcoords, first, n, buffer);
    take_components<2>(mesh.texcoords, n, bytes, [&](std::size_t i, const auto& uv) {
        out[i] = {static_cast<float>(uv[0]), static_cast<float>(uv[1])};
    });
}

}  // namespace hewer::streaming
