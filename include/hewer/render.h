// SPDX-License-Identifier: MIT
/// A shaded picture of a mesh, for looking at results.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "hewer/mesh_source.h"
#include "hewer/progress.h"

namespace hewer {

struct RenderOptions {
    unsigned width = 1024;
    unsigned height = 1024;
    double azimuth_degrees = 30;    ///< turn of the camera about the vertical axis (z up, or y up)
    double elevation_degrees = 20;  ///< of the camera above the horizon
    bool y_up = false;
    bool use_colors = true;  ///< vertex colours where the mesh has them
    bool edges = false;      ///< draw the triangles' edges
    double zoom = 1;         ///< 1 fits the bounding sphere into the picture
    bool overwrite = false;
    /// Of the input; see OpenOptions::format.
    std::string input_format{};
    std::uint64_t memory_bytes = 0;
    unsigned n_threads = 0;
    std::filesystem::path temp_dir{};  ///< for inputs that have to be imported
    std::uint64_t max_temp_bytes = 0;  ///< 0: no limit
};

/// Orthographic view, flat shading from triangle normals, 2x2 supersampling, written as PNG. Back
/// faces are drawn in a warning colour, so that flipped triangles and holes show. Equal options
/// give equal pictures for any thread count. Azimuth 0 looks from -y (z up) or from +z (y up).
/// Memory: 12 bytes a vertex (15 with colours) and 38 bytes a pixel. Throws: InvalidArgument,
/// FormatError, IoError, OutOfMemoryBudget, Cancelled.
void render(MeshSource& mesh, const std::filesystem::path& png, const RenderOptions& options,
            const Hooks& hooks = {});

/// Several meshes side by side in one picture, each of the size in the options: the camera is the
/// same for all and fits the box around all of them, so that before, after and a map of the error
/// can be compared. One mesh after the other is in memory; 3 bytes for each pixel of the whole
/// picture.
void render(std::span<MeshSource* const> meshes, const std::filesystem::path& png,
            const RenderOptions& options, const Hooks& hooks = {});

}  // namespace hewer
