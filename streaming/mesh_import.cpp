// SPDX-License-Identifier: MIT
#include "streaming/mesh_import.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "hewer/error.h"
#include "streaming/position_precision.h"

namespace hewer::streaming {

namespace {

// A page of each kind of record stays in memory as long as the source.
constexpr std::uint64_t kPageBytes = 256 << 10;
constexpr std::uint64_t kBatch = 16384;
constexpr std::size_t kIdBytes = 5;
constexpr Rgba16 kWhite{65535, 65535, 65535, 65535};
constexpr std::uint64_t kNoVertex = PackedTriangle::kMostVertices - 1;

using Normal = std::array<float, 3>;
using SoupTriangle = std::array<Vec3, 3>;

bool is_finite(const Vec3& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

Vec3 round_to_float(const Vec3& p) {
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

/// Appends `values`, or as many of `missing` as there are to be.
template <typename T>
void append_or_fill(ooc::Spool<T>& spool, std::span<const T> values, std::uint64_t n,
                    const T& missing) {
    if (!values.empty()) {
        spool.append(values);
        return;
    }
    const std::vector<T> piece(std::min(n, kBatch), missing);
    for (std::uint64_t done = 0; done < n;) {
        const std::uint64_t part = std::min<std::uint64_t>(n - done, piece.size());
        spool.append(std::span<const T>(piece.data(), part));
        done += part;
    }
}

}  // namespace

PackedTriangle::PackedTriangle(const Triangle& triangle) {
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t b = 0; b < kIdBytes; ++b) {
            bytes_[k * kIdBytes + b] = static_cast<unsigned char>(triangle[k] >> (8 * b));
        }
    }
}

Triangle PackedTriangle::unpack() const {
    Triangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t b = 0; b < kIdBytes; ++b) {
            triangle[k] |= std::uint64_t{bytes_[k * kIdBytes + b]} << (8 * b);
        }
    }
    return triangle;
}

struct MeshImport::State {
    State(const OpenOptions& options, const Hooks& hooks)
        : is_strict(options.strict),
          context({.memory_bytes = options.memory_bytes,
                   .n_threads = options.n_threads,
                   .temp_dir = options.temp_dir,
                   .max_temp_bytes = options.max_temp_bytes,
                   .page_bytes = kPageBytes,
                   .spills_at_once = true},
                  hooks, {{"import", 1}}),
          positions(context, "imported vertices"),
          normals(context, "imported normals"),
          colors(context, "imported colours"),
          triangles(context, "imported triangles") {}

    SourceInfo info;
    bool is_strict;
    bool has_alpha = false;
    InputDefects defects;
    Bounds bounds;
    // Before the spools, which lie in it.
    ooc::Context context;
    ooc::Spool<Vec3> positions;  // of a soup: three a triangle
    ooc::Spool<Normal> normals;
    ooc::Spool<Rgba16> colors;
    ooc::Spool<PackedTriangle> triangles;
    bool is_soup = false;
};

/// What is left of an import.
class MeshImport::Source final : public MeshSource {
  public:
    explicit Source(std::unique_ptr<State> state) : s_(std::move(state)) {}

    [[nodiscard]] const SourceInfo& info() const override { return s_->info; }
    [[nodiscard]] std::uint64_t bytes_read() const override {
        return s_->info.n_bytes + s_->context.spill().bytes_read();
    }
    [[nodiscard]] std::uint64_t held_memory_bytes() const override { return 4 * kPageBytes; }
    [[nodiscard]] std::uint64_t held_temp_bytes() const override {
        return s_->context.spill().used();
    }

    void begin_vertices() override { next_ = 0; }
    bool next_vertices(VertexBatch& batch) override {
        const auto [first, n] = take(s_->info.n_vertices);
        if (n == 0) {
            batch = {};
            return false;
        }
        read_vertices(first, n, batch);
        for (std::uint64_t i = 0; i < n; ++i) {
            if (is_finite(batch.positions[i])) continue;
            if (batch.defects.nonfinite_vertices++ == 0) {
                const std::string& place = s_->defects.first_nonfinite;
                batch.defects.first_nonfinite =
                    !place.empty() ? place : "vertex " + std::to_string(first + i);
            }
        }
        return true;
    }

    [[nodiscard]] bool can_seek_vertices() const override { return true; }
    void read_vertices(std::uint64_t first, std::uint64_t n, VertexBatch& batch) override {
        batch.first = first;
        batch.defects = {};
        read(s_->positions, first, n, batch.positions);
        if (!s_->info.has_double_positions) {
            for (Vec3& p : batch.positions) p = round_to_float(p);
        }
        batch.normals.clear();
        batch.colors.clear();
        if (s_->info.has_normals) read(s_->normals, first, n, batch.normals);
        if (s_->info.has_colors) read(s_->colors, first, n, batch.colors);
    }

    void begin_triangles() override { next_ = 0; }
    bool next_triangles(TriangleBatch& batch) override {
        const auto [first, n] = take(s_->info.n_faces);
        batch.corners.clear();
        batch.points.clear();
        batch.defects = {};
        if (n == 0) return false;
        if (first == 0) batch.defects = s_->defects;  // met while it was imported
        batch.first_face = first;
        batch.n_faces = n;
        if (s_->is_soup) {
            read_points(first, n, batch);
        } else {
            read_corners(first, n, batch);
        }
        return true;
    }

  private:
    struct Range {
        std::uint64_t first;
        std::uint64_t n;
    };
    Range take(std::uint64_t size) {
        const std::uint64_t first = next_.fetch_add(kBatch);
        return {first, first >= size ? 0 : std::min(kBatch, size - first)};
    }

    template <typename T>
    static void read(const ooc::Spool<T>& spool, std::uint64_t first, std::uint64_t n,
                     std::vector<T>& out) {
        out.resize(n);
        spool.read(first, std::span<T>(out));
    }

    void read_points(std::uint64_t first, std::uint64_t n, TriangleBatch& batch) const {
        batch.points.resize(n);
        static_assert(sizeof(SoupTriangle) == 3 * sizeof(Vec3));
        s_->positions.read(3 * first, std::span<Vec3>(batch.points.front().data(), 3 * n));
        if (s_->info.has_double_positions) return;
        for (SoupTriangle& triangle : batch.points) {
            for (Vec3& p : triangle) p = round_to_float(p);
        }
    }

    void read_corners(std::uint64_t first, std::uint64_t n, TriangleBatch& batch) const {
        std::vector<PackedTriangle> packed(n);
        s_->triangles.read(first, std::span<PackedTriangle>(packed));
        batch.corners.reserve(n);
        for (std::uint64_t i = 0; i < n; ++i) {
            const Triangle t = packed[i].unpack();
            if (std::max({t[0], t[1], t[2]}) < s_->info.n_vertices) {
                batch.corners.push_back(t);
                continue;
            }
            const std::string place = "face " + std::to_string(first + i);
            if (s_->is_strict) {
                throw FormatError(s_->info.name + ": " + place +
                                  ": a vertex index outside the vertices, of which there are " +
                                  std::to_string(s_->info.n_vertices));
            }
            if (batch.defects.out_of_range_triangles++ == 0) {
                const std::string& first_place = s_->defects.first_out_of_range;
                batch.defects.first_out_of_range = !first_place.empty() ? first_place : place;
            }
        }
    }

    std::unique_ptr<State> s_;
    std::atomic<std::uint64_t> next_{0};
};

MeshImport::MeshImport(std::string name, std::string format, std::uint64_t n_bytes,
                       const OpenOptions& options, const Hooks& hooks)
    : state_(std::make_unique<State>(options, hooks)) {
    state_->info.name = std::move(name);
    state_->info.format = std::move(format);
    state_->info.n_bytes = n_bytes;
    state_->context.begin_stage("import", n_bytes, "bytes");
}

MeshImport::~MeshImport() = default;
MeshImport::MeshImport(MeshImport&&) noexcept = default;

ooc::Context& MeshImport::context() {
    return state_->context;
}
std::uint64_t MeshImport::n_vertices() const {
    return state_->positions.size();
}
bool MeshImport::is_strict() const {
    return state_->is_strict;
}
InputDefects& MeshImport::defects() {
    return state_->defects;
}
const ooc::Spool<Vec3>& MeshImport::positions() const {
    return state_->positions;
}
const ooc::Spool<Rgba16>& MeshImport::colors() const {
    return state_->colors;
}
const ooc::Spool<PackedTriangle>& MeshImport::triangles() const {
    return state_->triangles;
}
void MeshImport::set_has_alpha() {
    state_->has_alpha = true;
}
void MeshImport::set_textures(std::vector<TextureInfo> textures) {
    state_->info.textures = std::move(textures);
}

void MeshImport::ignore(const std::string& what) {
    std::vector<std::string>& all = state_->info.ignored;
    if (std::find(all.begin(), all.end(), what) == all.end()) all.push_back(what);
}

void MeshImport::add_vertices(const VertexSpan& v) {
    State& s = *state_;
    const std::uint64_t n_before = s.positions.size();
    for (const Vec3& p : v.positions) {
        if (is_finite(p)) {
            s.bounds.extend(p);
        } else if (s.is_strict) {
            throw FormatError(
                s.info.name + ": vertex " +
                std::to_string(n_before + static_cast<std::uint64_t>(&p - v.positions.data())) +
                ": a coordinate is not finite");
        }
    }
    s.positions.append(v.positions);
    const std::uint64_t n = v.positions.size();
    if (!v.normals.empty() || !s.normals.empty()) {
        append_or_fill(s.normals, {}, n_before - s.normals.size(), Normal{});
        append_or_fill(s.normals, v.normals, n, Normal{});
    }
    if (!v.colors.empty() || !s.colors.empty()) {
        append_or_fill(s.colors, {}, n_before - s.colors.size(), kWhite);
        append_or_fill(s.colors, v.colors, n, kWhite);
    }
}

void MeshImport::add_triangles(std::span<const Triangle> triangles) {
    std::vector<PackedTriangle> packed;
    packed.reserve(triangles.size());
    for (const Triangle& t : triangles) {
        packed.emplace_back(Triangle{std::min(t[0], kNoVertex), std::min(t[1], kNoVertex),
                                     std::min(t[2], kNoVertex)});
    }
    state_->triangles.append(packed);
}

void MeshImport::add_points(std::span<const SoupTriangle> triangles) {
    if (triangles.empty()) return;
    state_->is_soup = true;
    add_vertices({{triangles.front().data(), 3 * triangles.size()}, {}, {}});
}

void MeshImport::take_normals(ooc::Spool<Normal> normals) {
    state_->normals = std::move(normals);
}

void MeshImport::take_colors(ooc::Spool<Rgba16> colors) {
    state_->colors = std::move(colors);
}

std::unique_ptr<MeshSource> MeshImport::finish() {
    State& s = *state_;
    const std::uint64_t n_vertices = s.positions.size();
    if (!s.normals.empty()) {
        append_or_fill(s.normals, {}, n_vertices - s.normals.size(), Normal{});
    }
    if (!s.colors.empty()) append_or_fill(s.colors, {}, n_vertices - s.colors.size(), kWhite);
    s.info.is_indexed = !s.is_soup;
    s.info.n_vertices = s.is_soup ? 0 : s.positions.size();
    s.info.n_faces = s.is_soup ? s.positions.size() / 3 : s.triangles.size();
    s.info.has_normals = !s.normals.empty();
    s.info.has_colors = !s.colors.empty();
    s.info.has_alpha = s.info.has_colors && s.has_alpha;
    s.info.has_double_positions = float_is_too_coarse(s.bounds);
    if (s.info.n_faces == 0) {
        throw FormatError(s.info.name + ": the mesh has no faces" +
                          (s.info.n_vertices > 0 ? ", only " + std::to_string(s.info.n_vertices) +
                                                       " vertices: a point cloud has no surface"
                                                 : std::string()));
    }
    s.context.end_stage();
    return std::make_unique<Source>(std::move(state_));
}

ooc::Spool<PackedTriangle> copy_triangles(ooc::Context& context, MeshSource& source) {
    ooc::Spool<PackedTriangle> triangles(context, "triangles");
    std::vector<PackedTriangle> packed;
    TriangleBatch batch;
    source.begin_triangles();
    while (source.next_triangles(batch)) {
        packed.clear();
        for (const Triangle& t : batch.corners) packed.emplace_back(t);
        triangles.append(packed);
        context.check_stop();
    }
    return triangles;
}

std::unique_ptr<MeshSource> import_indexed(MeshSource& soup, const OpenOptions& options,
                                           const Hooks& hooks) {
    const SourceInfo& info = soup.info();
    MeshImport import(info.name, info.format, info.n_bytes, options, hooks);
    for (const std::string& what : info.ignored) import.ignore(what);
    soup.begin_triangles();
    TriangleBatch batch;
    std::vector<Triangle> corners;
    while (soup.next_triangles(batch)) {
        if (batch.points.empty()) continue;
        corners.clear();
        for (std::uint64_t v = import.n_vertices(); corners.size() < batch.points.size(); v += 3) {
            corners.push_back({v, v + 1, v + 2});
        }
        import.add_vertices({{batch.points.front().data(), 3 * batch.points.size()}, {}, {}});
        import.add_triangles(corners);
        import.defects().merge(batch.defects);
        import.context().check_stop();
    }
    return import.finish();
}

}  // namespace hewer::streaming
