// SPDX-License-Identifier: MIT
/// What the pipeline has to know of the writers behind create_mesh_file() beyond MeshSink.
#pragma once

#include <filesystem>

#include "hewer/mesh_sink.h"

namespace hewer::streaming {

/// Throws InvalidArgument if the format of `path` cannot hold as many vertices and triangles with
/// such attributes; what it says names one that can. The same check as in begin(), for those who
/// know the counts before the mesh.
void require_format_fits(const std::filesystem::path& path, const SinkHeader& header);

}  // namespace hewer::streaming
