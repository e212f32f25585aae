// SPDX-License-Identifier: MIT
/// A triangle soup with vertices and indices.
#pragma once

#include "hewer/mesh_source.h"
#include "ooc/context.h"
#include "ooc/spool.h"

namespace hewer::streaming {

/// Vertices in the order in which the triangles use them first; triangles in the order of the file.
struct WeldedMesh {
    ooc::Spool<Vec3> positions;
    ooc::Spool<Triangle> triangles;
    InputDefects defects;  ///< those of the source, and triangles with two corners in one place
};

/// Makes one vertex of all corners with exactly the same position. Reads the triangles once; three
/// sorts. Memory: the buffers of two sorters. Disk, where memory is short: 140 bytes a triangle at
/// once (200 with double positions), 96 of a closed surface in the end.
/// Throws: as the source does, OutOfDiskBudget, Cancelled.
WeldedMesh weld(ooc::Context& context, MeshSource& soup);

}  // namespace hewer::streaming
