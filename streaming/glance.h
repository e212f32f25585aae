// SPDX-License-Identifier: MIT
/// What a file says of itself, without being read through.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "hewer/mesh_source.h"
#include "hewer/progress.h"
#include "hewer/report.h"

namespace hewer::streaming {

/// What has to be read is in the report's `basis`:
///   Header  PLY, binary STL, OFF, glTF, GLB, Draco; compressed PLY and OFF, of which the first MiB
///           is unpacked. Boxes are those that glTF claims, else those of a sample.
///   Sample  OBJ, ASCII STL: pieces at equal distances, 8 MiB together, scaled up.
///   Name    other compressed files, .om, Draco with metadata: no figures.
/// Several files: the sum, by the weakest of these.
/// Nothing if the files have no more than `whole_below` bytes (what is compressed counts four
/// times) or one of them is a pipe: then they are to be read whole. Throws: as open_mesh() does,
/// where the beginning of a file shows it.
std::optional<InputReport> glance(const std::vector<std::filesystem::path>& files,
                                  std::uint64_t whole_below, const OpenOptions& options,
                                  const Hooks& hooks);

}  // namespace hewer::streaming
