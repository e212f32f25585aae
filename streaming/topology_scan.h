// SPDX-License-Identifier: MIT
/// The topology of an input of any size.
#pragma once

#include "hewer/mesh_source.h"
#include "hewer/report.h"
#include "ooc/context.h"

namespace hewer::streaming {

/// Borders, fans and components of an indexed mesh by its indices; of a soup by positions: corners
/// at exactly equal coordinates are one vertex (-0 equals 0). Faces that the source delivers count,
/// whether their corners are finite or not.
///
/// One pass over the triangles; a progress stage in faces is the caller's. Memory: 4 bytes a vertex
/// (TopologyCounter) and a 32nd of the limit for sorting, at most 64 times Context::sort_bytes();
/// of a soup also Weld's. Disk, where memory is short: 36 bytes a triangle, and of a soup what Weld
/// takes. Any number of threads read, one
/// counts. Throws: what the source throws, OutOfMemoryBudget, OutOfDiskBudget, Cancelled.
TopologyReport count_topology(ooc::Context& context, MeshSource& source);

}  // namespace hewer::streaming
