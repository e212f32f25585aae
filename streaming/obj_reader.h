// SPDX-License-Identifier: MIT
/// Wavefront OBJ.
#pragma once

#include <memory>

#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "streaming/text_import.h"

namespace hewer::streaming {

/// Reads the file once, front to back, parsing it on all threads, into a MeshImport.
///
/// Carried: vertices with colours behind them (0..1 or 0..255), faces of any size and with any kind
/// of ids, normals where every corner of the file refers to the normal that has the number of its
/// vertex, colours and textures of materials as colours of the vertices (ObjMaterials). Named in
/// SourceInfo::ignored: other normals, other maps, lines, points, curves, what is unknown. Groups,
/// objects and smoothing are nothing to be carried. Throws FormatError: path, line and what was
/// found there; no faces. As MeshImport.
std::unique_ptr<MeshSource> open_obj(const ooc::InputFile& file, const OpenOptions& options,
                                     const Hooks& hooks, const TextTuning& tuning = {});

}  // namespace hewer::streaming
