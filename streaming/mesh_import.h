// SPDX-License-Identifier: MIT
/// Meshes whose files cannot be read twice, or not from the middle: text, compressed buffers,
/// instances of parts. They are read once, front to back, into records of fixed size on temporary
/// disk, and are a MeshSource from there.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hewer/mesh_sink.h"
#include "hewer/mesh_source.h"
#include "ooc/context.h"
#include "ooc/spool.h"

namespace hewer::streaming {

/// Three vertex ids below 2^40, in 15 bytes: half of what 64-bit ids take on disk.
class PackedTriangle {
  public:
    static constexpr std::uint64_t kMostVertices = std::uint64_t{1} << 40;

    PackedTriangle() = default;
    /// Precondition: every id is below kMostVertices.
    explicit PackedTriangle(const Triangle& triangle);
    [[nodiscard]] Triangle unpack() const;

  private:
    std::array<unsigned char, 15> bytes_{};
};

/// Takes what a reader of such a file delivers, in the order of the file, and becomes a source. One
/// thread at a time.
///
/// Positions are kept as doubles; whether the source delivers doubles follows from their range (see
/// float_is_too_coarse()), since text does not say how precise it is meant to be.
/// Temporary disk: 24 bytes a vertex, 12 more with normals, 8 more with colours; 15 a triangle; of
/// a soup 72 a triangle. Memory: a page for each kind of record, and what the reader reserves in
/// context().
/// Throws: OutOfDiskBudget, IoError.
class MeshImport {
  public:
    /// `name` and `format` for SourceInfo; the input has `n_bytes`. The progress is one of bytes:
    /// the reader calls context().advance().
    MeshImport(std::string name, std::string format, std::uint64_t n_bytes,
               const OpenOptions& options, const Hooks& hooks);
    ~MeshImport();
    MeshImport(MeshImport&&) noexcept;
    MeshImport& operator=(MeshImport&&) = delete;

    /// Threads, memory and temporary disk of the import; its limits are those of the options.
    ooc::Context& context();
    [[nodiscard]] std::uint64_t n_vertices() const;
    [[nodiscard]] bool is_strict() const;

    /// Counts and first places of the dirt that the reader itself leaves out or notes: short faces,
    /// polygons, triangles of a soup that are not finite. Vertices that are not finite and indices
    /// out of range are counted by the source; their first places are the reader's if it sets them.
    InputDefects& defects();
    /// What the reader does not carry, for SourceInfo::ignored; once each.
    void ignore(const std::string& what);
    /// Alpha is told apart from opaque colours only if the file has it.
    void set_has_alpha();
    /// For SourceInfo::textures.
    void set_textures(std::vector<TextureInfo> textures);

    /// Normals and colours may begin, or be missing, anywhere: what has none gets a zero normal
    /// (that is, none) and opaque white.
    void add_vertices(const VertexSpan& vertices);
    /// Ids may point forward. Ids that are no vertex in the end are dropped and counted by the
    /// source; so are those of 2^40 and beyond.
    void add_triangles(std::span<const Triangle> triangles);
    /// Of a soup; all finite. Not together with the other two.
    void add_points(std::span<const std::array<Vec3, 3>> triangles);

    /// Normals, or colours, of the vertices in their order, for files where they become known apart
    /// from the positions; a spool of context(). Vertices beyond its end have none. Not together
    /// with normals, or colours, in add_vertices().
    void take_normals(ooc::Spool<std::array<float, 3>> normals);
    void take_colors(ooc::Spool<Rgba16> colors);

    /// What was added, to be looked up while more still comes.
    [[nodiscard]] const ooc::Spool<Vec3>& positions() const;
    [[nodiscard]] const ooc::Spool<Rgba16>& colors() const;
    [[nodiscard]] const ooc::Spool<PackedTriangle>& triangles() const;

    /// Once, at the end. Throws FormatError: no triangles.
    std::unique_ptr<MeshSource> finish();

  private:
    struct State;
    class Source;
    std::unique_ptr<State> state_;
};

/// The triangles of an indexed source, in order.
ooc::Spool<PackedTriangle> copy_triangles(ooc::Context& context, MeshSource& source);

/// `source`, with the triangles of a soup as vertices and indices: for soups that have to go
/// together with indexed meshes.
std::unique_ptr<MeshSource> import_indexed(MeshSource& soup, const OpenOptions& options,
                                           const Hooks& hooks);

}  // namespace hewer::streaming
