// SPDX-License-Identifier: MIT
/// The main door: a mesh of any size in, levels of detail out.
///
///     hewer::SimplifyOptions options;
///     options.targets = {{hewer::Target::Kind::Triangles, 100'000}};
///     hewer::simplify_file("scan.ply", "small.glb", options);
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "hewer/error.h"
#include "hewer/mesh_sink.h"
#include "hewer/mesh_source.h"
#include "hewer/options.h"
#include "hewer/progress.h"
#include "hewer/report.h"

namespace hewer {

/// The parents that tie one LOD to the next coarser one: parent[v] is the vertex of LOD k+1 that
/// stands for vertex v of LOD k. Empty for the coarsest.
using LodParents = std::vector<std::uint64_t>;

/// Called once per LOD, finest first, just before it is written.
using SinkFactory = std::function<std::unique_ptr<MeshSink>(std::size_t lod)>;

/// Called after all LODs are written, once per pair (k, k+1), if set.
using ParentsCallback = std::function<void(std::size_t lod, const LodParents& parents)>;

/// Simplifies `source` to options.targets.
///
/// Passes: one over the vertices (two if positions are double and options.bounds is not set, one
/// more with colours or normals) and one over the triangles; a soup is read three times. Memory:
/// docs/memory.md gives the formula; all of it is reserved within options.memory_bytes.
/// Determinism: equal input and options give equal bytes for any thread count and memory limit.
/// Throws: InvalidArgument, FormatError, IoError, OutOfMemoryBudget, Cancelled.
SimplifyReport simplify(MeshSource& source, const SinkFactory& sinks,
                        const SimplifyOptions& options, const Hooks& hooks = {},
                        const ParentsCallback& parents = {});

/// One file for each target: OUTPUT itself for a single target, else
/// name_lod0.ext, name_lod1.ext, ... and name_lods.json beside them.
SimplifyReport simplify_to_files(MeshSource& source, const std::filesystem::path& output,
                                 const SimplifyOptions& options, const Hooks& hooks = {},
                                 bool overwrite = false);

/// open_mesh(), then simplify_to_files(). Throws what both do; InvalidArgument if an output is one
/// of the inputs.
SimplifyReport simplify_file(const InputPaths& input, const std::filesystem::path& output,
                             const SimplifyOptions& options, const Hooks& hooks = {},
                             bool overwrite = false);

/// In memory, one target.
Mesh simplify_mesh(const Mesh& mesh, const SimplifyOptions& options, const Hooks& hooks = {});

/// Where LOD `lod` of `n_lods` goes when the user named `output`: "statue.ply" ->
/// "statue_lod0.ply".
std::filesystem::path lod_path(const std::filesystem::path& output, std::size_t lod,
                               std::size_t n_lods);

}  // namespace hewer
