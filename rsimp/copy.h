// SPDX-License-Identifier: MIT
/// A mesh that goes out as it is: Method::Copy.
#pragma once

#include "hewer/mesh_sink.h"
#include "hewer/mesh_source.h"
#include "hewer/options.h"
#include "hewer/report.h"
#include "ooc/context.h"
#include "ooc/result_hash.h"
#include "rsimp/stage_log.h"

namespace hewer::rsimp {

/// Every triangle of the input, in its order, with its vertices in theirs; equal corners of a soup
/// become one vertex, in the order of first use. Left out are triangles with a repeated corner or a
/// coordinate that is not finite, and vertices that no triangle is left to use: what the other
/// methods leave out as well. Triangles that the file has twice stay, and so do vertices that lie
/// in one place.
///
/// Passes: two over the vertices and two over the triangles; a soup is read twice if it becomes
/// indexed, else three times. Fills report.input and counts, bounds and topology of `lod`; calls
/// begin() and all add_*() of `sink`. Returns FNV-1a over what went out. Memory: kCopyBatchBytes,
/// copy_bytes() or Weld::bytes(), the topology counter's 4 bytes a vertex, and the buffers of what
/// Weld or stream_points() take. Throws: FormatError (nothing is left; dirt in strict mode), what
/// source and sink throw, OutOfMemoryBudget, OutOfDiskBudget, Cancelled.
ooc::ResultHash copy_mesh(ooc::Context& context, MeshSource& source, MeshSink& sink,
                          const SimplifyOptions& options, StageLog& stages, SimplifyReport& report,
                          LodReport& lod);

/// Batches of input and output in flight, for each thread.
constexpr std::uint64_t kCopyBatchBytes = 4ULL << 20;

/// Two bits a vertex, and their ranks.
constexpr std::uint64_t copy_bytes(std::uint64_t n_vertices) {
    return n_vertices / 4 + n_vertices / 64 + 64;
}

}  // namespace hewer::rsimp
