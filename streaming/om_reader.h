// SPDX-License-Identifier: MIT
/// OpenMesh's own binary format, .om.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "hewer/mesh_source.h"
#include "ooc/file.h"

namespace hewer::streaming {

/// What stands at the beginning. The counts are the file's own claim.
struct OmHeader {
    char kind = 'T';  ///< [T]riangles, [Q]uads, [P]olygons
    std::uint8_t version = 0;
    std::uint64_t n_vertices = 0;
    std::uint64_t n_faces = 0;
    std::uint64_t n_edges = 0;
};

/// Nothing if the file does not begin like one of OpenMesh.
std::optional<OmHeader> find_om_header(const ooc::InputFile& file);

/// Imports the mesh (streaming/mesh_import.h). Carried: positions (float, double), normals and
/// colours of vertices; named as not carried: texture coordinates, what belongs to faces, edges or
/// halfedges, status flags, named properties.
///
/// Version 2 of the format has no list of faces, but the halfedges: next one, vertex, face. Each
/// face is a walk along them, anywhere in the list, so these are held in memory while the file is
/// imported, 12 bytes each: 36 bytes a triangle. Version 1 has the faces as lists of vertices.
///
/// Read by our own code: OpenMesh's reader trusts the counts of a file, allocates by them, and
/// follows its handles unchecked.
/// Throws: FormatError (path, byte), OutOfMemoryBudget (with the number that would do),
/// OutOfDiskBudget, IoError, Cancelled.
std::unique_ptr<MeshSource> open_om(std::shared_ptr<const ooc::InputFile> file,
                                    const OpenOptions& options, const Hooks& hooks);

}  // namespace hewer::streaming
