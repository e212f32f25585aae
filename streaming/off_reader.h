// SPDX-License-Identifier: MIT
/// OFF, Geomview's object file format, as text.
#pragma once

#include <memory>

#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "streaming/text_import.h"

namespace hewer::streaming {

/// Reads the vertices twice and the faces once: where the faces begin is known only after the lines
/// of the vertices are counted; then both are parsed on all threads into a MeshImport.
///
/// A vertex or a face is a line; empty lines and comments may stand anywhere. Carried: positions,
/// normals (N), colours (C, or without it three or four numbers behind a plain vertex; 0..1 or
/// 0..255), faces of any size. Named in SourceInfo::ignored: texture coordinates (ST), colours of
/// faces, lines after the last face. Refused: binary OFF, four and n dimensions.
/// Throws FormatError: path, line and what was found there; fewer lines than announced; no faces.
/// As MeshImport.
std::unique_ptr<MeshSource> open_off(const ooc::InputFile& file, const OpenOptions& options,
                                     const Hooks& hooks, const TextTuning& tuning = {});

}  // namespace hewer::streaming
