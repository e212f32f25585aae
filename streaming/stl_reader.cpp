// SPDX-License-Identifier: MIT
#include "streaming/stl_reader.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <utility>

#include "hewer/error.h"
#include "ooc/units.h"
#include "streaming/block_pool.h"
#include "streaming/byte_buffer.h"
#include "streaming/findings.h"
#include "streaming/nonfinite.h"
#include "streaming/scalar_type.h"

namespace hewer::streaming {

namespace {

constexpr std::uint64_t kBatch = 16384;
constexpr std::size_t kNormalBytes = 12;
constexpr bool kSwap = std::endian::native == std::endian::big;

using SoupTriangle = std::array<Vec3, 3>;

std::uint64_t announced_count(const ooc::InputFile& file) {
    std::array<unsigned char, 4> bytes{};
    file.read_at(kStlHeaderBytes - 4, bytes.data(), bytes.size());
    return load<std::uint32_t, kSwap>(bytes.data());
}

bool is_finite(const SoupTriangle& triangle) {
    NonfiniteProbe probe;
    for (const Vec3& p : triangle) {
        for (const double x : p) probe.add(x);
    }
    return !probe.any();
}

/// Its corners, behind the normal.
SoupTriangle corners_of(const unsigned char* triangle) {
    SoupTriangle corners;
    const unsigned char* p = triangle + kNormalBytes;
    for (Vec3& corner : corners) {
        for (double& x : corner) {
            x = static_cast<double>(load<float, kSwap>(p));
            p += sizeof(float);
        }
    }
    return corners;
}

class StlSource final : public MeshSource {
  public:
    StlSource(std::unique_ptr<ooc::InputFile> file, bool is_strict)
        : file_(std::move(file)), reporter_(file_->path().string(), is_strict) {
        const std::string path = file_->path().string();
        const std::uint64_t announced = announced_count(*file_);
        const std::uint64_t body_bytes = file_->size() - kStlHeaderBytes;
        info_.n_faces = body_bytes / kStlTriangleBytes;
        const bool is_whole = body_bytes % kStlTriangleBytes == 0;
        if (!is_whole && announced > 0 && announced <= info_.n_faces) {
            // A footer of some other program, or another file.
            info_.n_faces = announced;
            info_.ignored.push_back("the " +
                                    std::to_string(body_bytes - announced * kStlTriangleBytes) +
                                    " bytes behind the triangles");
        } else if (!is_whole) {
            throw FormatError(path + ": truncated binary STL: the header announces " +
                              ooc::format_count(announced) + " triangles, which need " +
                              std::to_string(kStlHeaderBytes + announced * kStlTriangleBytes) +
                              " bytes; the file ends at byte " + std::to_string(file_->size()) +
                              ", in triangle " + std::to_string(info_.n_faces));
        }
        if (info_.n_faces == 0) throw FormatError(path + ": the mesh has no faces: 0 triangles");
        if (announced != info_.n_faces) {
            info_.ignored.push_back("the count " + std::to_string(announced) +
                                    " in the header: the file holds " +
                                    std::to_string(info_.n_faces) + " triangles");
        }
        info_.name = path;
        info_.format = "STL, binary";
        info_.n_bytes = file_->size();
        info_.is_indexed = false;
    }

    [[nodiscard]] const SourceInfo& info() const override { return info_; }
    [[nodiscard]] std::uint64_t bytes_read() const override { return n_bytes_read_.load(); }
    [[nodiscard]] std::uint64_t held_temp_bytes() const override {
        return file_->held_temp_bytes();
    }

    void begin_vertices() override {}
    bool next_vertices(VertexBatch& batch) override {
        batch = {};
        return false;
    }

    void begin_triangles() override { next_ = 0; }

    bool next_triangles(TriangleBatch& batch) override {
        const std::uint64_t first = next_.fetch_add(kBatch);
        if (first >= info_.n_faces) return false;
        const std::size_t n = static_cast<std::size_t>(std::min(kBatch, info_.n_faces - first));
        const std::uint64_t offset = kStlHeaderBytes + first * kStlTriangleBytes;
        const std::size_t bytes = n * kStlTriangleBytes;
        const auto buffer = buffers_.lease();
        const std::size_t got = file_->read_at(offset, buffer->room_for(bytes), bytes);
        n_bytes_read_.fetch_add(got, std::memory_order_relaxed);
        if (got < bytes) {
            throw FormatError(info_.name + ": truncated: the file ends at byte " +
                              std::to_string(offset + got) + ", in triangle " +
                              std::to_string(first + got / kStlTriangleBytes));
        }
        batch.first_face = first;
        batch.n_faces = n;
        batch.corners.clear();
        batch.defects = {};
        if (decode(buffer->data(), n, batch)) drop_nonfinite(first, batch);
        return true;
    }

  private:
    /// Returns whether some coordinate is not finite.
    static bool decode(const unsigned char* p, std::size_t n, TriangleBatch& batch) {
        batch.points.resize(n);
        NonfiniteProbe probe;
        for (SoupTriangle& triangle : batch.points) {
            triangle = corners_of(p);
            for (const Vec3& point : triangle) {
                for (const double x : point) probe.add(x);
            }
            p += kStlTriangleBytes;
        }
        return probe.any();
    }

    void drop_nonfinite(std::uint64_t first, TriangleBatch& batch) const {
        std::size_t n_kept = 0;
        for (std::size_t i = 0; i < batch.points.size(); ++i) {
            if (is_finite(batch.points[i])) {
                batch.points[n_kept++] = batch.points[i];
                continue;
            }
            const std::uint64_t triangle = first + i;
            reporter_.report_nonfinite(batch, triangle, [&] {
                return "byte " + std::to_string(kStlHeaderBytes + triangle * kStlTriangleBytes);
            });
        }
        batch.points.resize(n_kept);
    }

    std::unique_ptr<ooc::InputFile> file_;
    FindingsReporter reporter_;
    SourceInfo info_;
    std::atomic<std::uint64_t> n_bytes_read_{0};
    std::atomic<std::uint64_t> next_{0};
    BlockPool<ByteBuffer> buffers_;
};

}  // namespace

bool is_whole_binary_stl(const ooc::InputFile& file) {
    return file.size() >= kStlHeaderBytes &&
           file.size() == kStlHeaderBytes + announced_count(file) * kStlTriangleBytes;
}

Bounds sample_stl_box(const ooc::InputFile& file) {
    constexpr std::uint64_t kPieces = 64;
    constexpr std::uint64_t kPieceTriangles = 1 << 11;
    const std::uint64_t n =
        (file.size() - std::min(file.size(), kStlHeaderBytes)) / kStlTriangleBytes;
    const std::uint64_t distance = std::max(n / kPieces, kPieceTriangles);
    Bounds bounds;
    std::vector<unsigned char> bytes(kPieceTriangles * kStlTriangleBytes);
    for (std::uint64_t first = 0; first < n; first += distance) {
        const std::size_t got =
            file.read_at(kStlHeaderBytes + first * kStlTriangleBytes, bytes.data(), bytes.size());
        for (std::size_t at = 0; at + kStlTriangleBytes <= got; at += kStlTriangleBytes) {
            const SoupTriangle corners = corners_of(bytes.data() + at);
            if (!is_finite(corners)) continue;
            for (const Vec3& p : corners) bounds.extend(p);
        }
    }
    return bounds;
}

std::unique_ptr<MeshSource> open_binary_stl(std::unique_ptr<ooc::InputFile> file, bool is_strict) {
    return std::make_unique<StlSource>(std::move(file), is_strict);
}

}  // namespace hewer::streaming
