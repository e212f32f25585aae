// SPDX-License-Identifier: MIT
/// What the pipeline has to know of the writers behind create_mesh_file() beyond MeshSink.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hewer/mesh_sink.h"

namespace hewer::ooc {
class OutputGroup;
}  // namespace hewer::ooc

namespace hewer::streaming {

/// As hewer::create_mesh_file(), but the file gets its name from group.publish(), not in finish().
std::unique_ptr<MeshSink> create_mesh_file(const std::filesystem::path& path,
                                           const MeshFileOptions& options, ooc::OutputGroup& group);

/// Throws InvalidArgument if the format of `path` cannot hold as many vertices and triangles with
/// such attributes; what it says names one that can. The same check as in begin(), for those who
/// know the counts before the mesh.
void require_format_fits(const std::filesystem::path& path, const SinkHeader& header);

/// Sentences on what of such a mesh the format of `path` does not keep: attributes, and positions
/// far from the origin. Counts are not looked at.
std::vector<std::string> what_is_lost(const std::filesystem::path& path, const SinkHeader& header);

}  // namespace hewer::streaming
