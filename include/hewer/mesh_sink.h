// SPDX-License-Identifier: MIT
/// The door through which a level of detail goes out: counts first, then vertices, then triangles.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "hewer/mesh_source.h"
#include "hewer/types.h"

namespace hewer {

/// What a sink is told before the first vertex.
struct SinkHeader {
    std::uint64_t n_vertices = 0;
    std::uint64_t n_triangles = 0;
    bool has_normals = false;
    bool has_colors = false;
    bool has_alpha = false;
    Bounds bounds;  ///< of the vertices to come
    bool has_double_positions =
        false;  ///< of the input; float formats then write relative to an offset
    /// How far the mesh is from what it stands for, as far as it is known (a root mean square,
    /// model units): automatic quantisation stays well below. 0: not known.
    double error = 0;
};

/// Vertices that go out together. normals and colors are empty or as many as positions.
struct VertexSpan {
    std::span<const Vec3> positions;
    std::span<const std::array<float, 3>> normals;
    std::span<const Rgba16> colors;
};

/// Takes one mesh: begin(), any number of add_vertices(), any number of add_triangles(), finish().
/// A sink that takes_points() may be given any number of add_points() instead of vertices and
/// triangles. Exactly the announced numbers must be added. Nothing is visible under the final name
/// until finish() has returned; a sink that is destroyed before that leaves no file behind. Throws:
/// IoError; InvalidArgument from begin() if the format cannot hold the mesh.
class MeshSink {
  public:
    virtual ~MeshSink() = default;
    virtual void begin(const SinkHeader& header) = 0;
    virtual void add_vertices(const VertexSpan& vertices) = 0;
    virtual void add_triangles(std::span<const Triangle> triangles) = 0;
    /// True where every triangle carries its positions (STL): given as points, the sink need not
    /// hold the vertices.
    [[nodiscard]] virtual bool takes_points() const { return false; }
    /// Throws InternalError unless takes_points().
    virtual void add_points(std::span<const std::array<Vec3, 3>> triangles);
    virtual void finish() = 0;
    [[nodiscard]] virtual std::uint64_t bytes_written() const = 0;

    /// What begin() takes and finish() gives back, for such a mesh: 0 for sinks that stream.
    [[nodiscard]] virtual std::uint64_t held_bytes(const SinkHeader& /*header*/) const { return 0; }
    /// How far quantisation has moved a position at most, model units; after finish().
    [[nodiscard]] virtual double displacement() const { return 0; }
};

/// Positions as integers of so many bits, or at multiples of a step, or as fine as a tenth of
/// SinkHeader::error asks for.
struct Quantization {
    enum class Kind { None, Auto, Bits, Step };
    Kind kind = Kind::None;
    double value = 0;  ///< of Bits: 1..30; of Step: model units
};

enum class Compression {
    None,
    Meshopt,  ///< EXT_meshopt_compression
    Draco,    ///< KHR_draco_mesh_compression
};

/// How to write a file, where its extension leaves a choice.
struct MeshFileOptions {
    bool overwrite = false;
    bool is_ascii = false;                        ///< .ply
    Quantization quantization{};                  ///< .glb, .gltf (16 bits at most), .drc
    Compression compression = Compression::None;  ///< .glb, .gltf
};

/// A sink for a file, by its extension: .ply (binary little endian, or text), .obj, .off, .stl
/// (binary), .glb, .gltf (with a .bin beside it), .drc; docs/output_formats.md has what each holds.
/// Throws InvalidArgument for another extension or options that the format does not have, IoError
/// if the folder cannot be written or the file exists and `overwrite` is false; all at once, before
/// any work is lost.
std::unique_ptr<MeshSink> create_mesh_file(const std::filesystem::path& path,
                                           const MeshFileOptions& options = {});

/// A sink that fills `mesh`, which must outlive it.
std::unique_ptr<MeshSink> collect_mesh(Mesh& mesh);

}  // namespace hewer
