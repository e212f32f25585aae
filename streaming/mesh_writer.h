// SPDX-License-Identifier: MIT
/// What the pipeline has to know of the writers behind create_mesh_file() beyond MeshSink.
#pragma once

#include <cstdint>
#include <filesystem>

#include "hewer/mesh_sink.h"

namespace hewer::streaming {

/// Most bytes that the sink for `path` holds between begin() and finish(), to be reserved by the
/// caller: a sink has no budget of its own. Constant for .ply, .obj and .glb; 12 bytes a vertex
/// more for .stl. Throws InvalidArgument for an extension that is not supported.
std::uint64_t sink_memory_bytes(const std::filesystem::path& path, const SinkHeader& header);

}  // namespace hewer::streaming
