// SPDX-License-Identifier: MIT
/// ASCII STL.
#pragma once

#include <memory>

#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "streaming/text_import.h"

namespace hewer::streaming {

/// Reads the file once, front to back, parsing it on all threads, into a MeshImport: a triangle
/// soup. Words may be in capitals and stand on any line; a file may hold several solids. Normals of
/// facets are not carried, nor are colours, which some writers add.
/// Throws FormatError: path, line and what was found there; the file ends in a facet; no facets. As
/// MeshImport.
std::unique_ptr<MeshSource> open_ascii_stl(const ooc::InputFile& file, const OpenOptions& options,
                                           const Hooks& hooks, const TextTuning& tuning = {});

}  // namespace hewer::streaming
