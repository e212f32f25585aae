// SPDX-License-Identifier: MIT
/// The door through which geometry comes in: a stream of vertex batches and of triangle batches.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hewer/progress.h"
#include "hewer/types.h"

namespace hewer {

/// Dirt met while reading. Data, not errors: such elements are left out and the run goes on.
struct InputDefects {
    std::uint64_t nonfinite_vertices = 0;      ///< a coordinate is NaN or infinite
    std::uint64_t nonfinite_triangles = 0;     ///< dropped: a corner is such a vertex
    std::uint64_t out_of_range_triangles = 0;  ///< dropped: a vertex index outside the vertex list
    std::uint64_t short_faces = 0;             ///< dropped: a face of fewer than three corners
    std::uint64_t polygons = 0;                ///< kept: faces of more than three corners, fanned
    std::uint64_t degenerate_triangles = 0;    ///< repeated corner or zero area
    std::uint64_t bad_weights = 0;     ///< of vertices: negative, no number, or above kMostWeight
    std::uint64_t trailing_bytes = 0;  ///< not read: behind the mesh, such as a second file
    /// Where the first of them was met: "vertex 17 (byte 1234)". Empty: none.
    std::string first_nonfinite;
    std::string first_out_of_range;

    /// Adds the counts; of two places, keeps that of the lower element number, so that the order in
    /// which threads merge their batches does not show.
    void merge(const InputDefects& other);
};

/// An image that the colours of vertices were sampled from.
struct TextureInfo {
    std::string name;    ///< the path, or the place in the file
    std::string format;  ///< "PNG", "JPEG"
    std::uint32_t width = 0;
    std::uint32_t height = 0;
};

/// What is known of an input before it is read through. Counts are the file's own claim.
struct SourceInfo {
    std::string name;              ///< the path, for messages
    std::string format;            ///< "PLY, binary little endian"
    std::uint64_t n_vertices = 0;  ///< 0 for a triangle soup
    std::uint64_t n_faces =
        0;  ///< faces of any size; n_triangles() is at least this, bar short faces
    std::uint64_t n_bytes = 0;  ///< of the file; 0 for memory
    bool is_indexed = true;     ///< false: triangle soup, vertices come with the triangles
    bool has_double_positions = false;
    bool has_normals = false;
    bool has_colors = false;
    bool has_alpha = false;
    bool has_weights = false;           ///< see OpenOptions::weight_property
    std::vector<TextureInfo> textures;  ///< that are in the colours; see docs/textures.md
    std::vector<std::string> ignored;   ///< properties and elements that hewer does not carry
};

/// Consecutive vertices. `normals`, `colors` and `weights` are empty unless SourceInfo says that
/// they are there. A non-finite position is delivered as it is (so that ids stay right) and counted
/// in `defects`.
struct VertexBatch {
    std::uint64_t first = 0;  ///< id of positions[0]
    std::vector<Vec3> positions;
    std::vector<std::array<float, 3>> normals;
    std::vector<Rgba16> colors;
    std::vector<float> weights;  ///< as the input has them
    InputDefects defects;
};

/// Consecutive triangles in file order; polygons arrive as fans. Exactly one of the two lists is
/// used: `corners` by indexed sources (every id < n_vertices), `points` by soups (all finite).
struct TriangleBatch {
    std::uint64_t first_face = 0;  ///< number of the face that begins the batch
    std::uint64_t n_faces =
        0;  ///< faces consumed for this batch, dropped ones included: for progress
    std::vector<Triangle> corners;
    std::vector<std::array<Vec3, 3>> points;
    InputDefects defects;
};

/// A rewindable stream of a mesh. Reading is by passes: begin_vertices(), then next_vertices()
/// until it returns false; the same for triangles. Either kind of pass may be made any number of
/// times, in any order; they do not overlap.
///
/// Thread-safety: next_*() may be called by many threads at once; each call takes the next batch in
/// file order and decodes it outside the lock, so that decoding runs on all of them.
/// Memory: bounded by the batches in flight; never a function of the counts in a header.
/// Throws: FormatError (path, byte or line), IoError.
class MeshSource {
  public:
    virtual ~MeshSource() = default;
    [[nodiscard]] virtual const SourceInfo& info() const = 0;

    virtual void begin_vertices() = 0;
    /// Fills `batch` (its storage is reused) and returns true, or returns false at the end.
    virtual bool next_vertices(VertexBatch& batch) = 0;

    /// Whether read_vertices() works: the place of a vertex in the file follows from its number.
    [[nodiscard]] virtual bool can_seek_vertices() const { return false; }
    /// The vertices first .. first + n - 1, after a begin_vertices(); n at most 2^14. Any thread,
    /// at any time.
    virtual void read_vertices(std::uint64_t first, std::uint64_t n, VertexBatch& batch);

    virtual void begin_triangles() = 0;
    virtual bool next_triangles(TriangleBatch& batch) = 0;

    /// Bytes read from storage so far.
    [[nodiscard]] virtual std::uint64_t bytes_read() const = 0;

    /// What the source holds as long as it lives, besides the batches in flight: a run counts it
    /// against its own limits.
    [[nodiscard]] virtual std::uint64_t held_memory_bytes() const { return 0; }
    [[nodiscard]] virtual std::uint64_t held_temp_bytes() const { return 0; }

    /// What open_mesh() took: imports, unpacking. 0 for sources that it did not make.
    [[nodiscard]] double opening_seconds() const { return opening_seconds_; }
    void set_opening_seconds(double seconds) { opening_seconds_ = seconds; }

  private:
    double opening_seconds_ = 0;
};

/// How to open inputs. The limits are for those that cannot be streamed where they lie: text,
/// compressed data and pipes are read once, front to back, into temporary files.
struct OpenOptions {
    /// Defects are thrown as FormatError.
    bool strict = false;
    /// A name of input_formats(). Empty: by the content.
    std::string format{};
    /// Scalar property of the vertices that is their weight; PLY, and glTF (_NAME). Empty: none.
    std::string weight_property{};
    /// As in SimplifyOptions.
    std::uint64_t memory_bytes = 0;
    unsigned n_threads = 0;
    std::filesystem::path temp_dir{};
    std::uint64_t max_temp_bytes = 0;
};

/// What any options say of the opening of their input.
template <typename Options>
OpenOptions opening(const Options& options) {
    OpenOptions open{.format = options.input_format,
                     .memory_bytes = options.memory_bytes,
                     .n_threads = options.n_threads,
                     .temp_dir = options.temp_dir,
                     .max_temp_bytes = options.max_temp_bytes};
    if constexpr (requires { options.strict; }) open.strict = options.strict;
    if constexpr (requires { options.weight_property; }) {
        open.weight_property = options.weight_property;
    }
    return open;
}

/// One model: a path, or several, of which each is a file, a folder (all mesh files in it, by
/// name), a pattern such as "tile_*.ply" where no file has that very name, or "-" for standard
/// input.
struct InputPaths {
    std::vector<std::filesystem::path> paths;

    InputPaths(std::filesystem::path path) : paths{std::move(path)} {}
    InputPaths(const char* path) : paths{path} {}
    InputPaths(const std::string& path) : paths{path} {}
    InputPaths(std::vector<std::filesystem::path> several) : paths(std::move(several)) {}
};

/// The files that `inputs` stands for. Throws IoError: a pattern or folder without a mesh file.
std::vector<std::filesystem::path> list_files(const InputPaths& inputs);

/// Names for OpenOptions::format: "ply", "stl", ...
std::vector<std::string> input_formats();

/// Opens a model by its content, not its name. docs/input_formats.md lists what is read. Headers
/// are checked against the file sizes. Several files are one model: their vertices and triangles
/// follow each other.
/// Throws: FormatError, IoError, OutOfDiskBudget, OutOfMemoryBudget, Cancelled.
std::unique_ptr<MeshSource> open_mesh(const InputPaths& inputs, const OpenOptions& options = {},
                                      const Hooks& hooks = {});

/// A mesh in memory. normals, colors and weights are empty or as many as positions.
struct Mesh {
    std::vector<Vec3> positions;
    std::vector<std::array<float, 3>> normals;
    std::vector<Rgba16> colors;
    std::vector<Triangle> triangles;
    std::vector<float> weights{};  ///< see SimplifyOptions::weight_property
};

/// Streams a mesh that the caller keeps alive and unchanged. Copies nothing but the batches.
std::unique_ptr<MeshSource> view_mesh(const Mesh& mesh, std::string name = "memory");

}  // namespace hewer
