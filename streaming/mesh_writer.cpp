// SPDX-License-Identifier: MIT
#include "streaming/mesh_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "hewer/error.h"
#include "streaming/drc_writer.h"
#include "streaming/gltf_writer.h"
#include "streaming/obj_writer.h"
#include "streaming/off_writer.h"
#include "streaming/ply_writer.h"
#include "streaming/position_precision.h"
#include "streaming/quantization.h"
#include "streaming/stl_writer.h"

namespace hewer {

namespace {

struct Format {
    std::string_view extension;
    std::unique_ptr<streaming::FileSink> (*create)(const std::filesystem::path&,
                                                   const MeshFileOptions&);
    void (*require_fits)(const std::filesystem::path&, const SinkHeader&);
    bool has_ascii;
    bool has_quantization;
    bool has_compression;
    // What it holds; positions as more than floats, or relative to an offset.
    bool has_normals = true;
    bool has_colors = true;
    bool has_alpha = true;
    bool has_far_positions = true;
};

/// Text has no limits.
void accept(const std::filesystem::path& /*path*/, const SinkHeader& /*header*/) {}

constexpr std::array<Format, 7> kFormats{{
    {".ply", streaming::create_ply, streaming::require_ply_fits, true, false, false},
    {".obj", streaming::create_obj, accept, false, false, false, true, true, false},
    {".off", streaming::create_off, accept, false, false, false},
    {".stl", streaming::create_stl, streaming::require_stl_fits, false, false, false, false, false,
     false, false},
    {".glb", streaming::create_gltf, streaming::require_glb_fits, false, true, true},
    {".gltf", streaming::create_gltf, streaming::require_gltf_fits, false, true, true},
    {".drc", streaming::create_drc, streaming::require_drc_fits, false, true, false, true, true,
     true, false},
}};

const Format& format_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    // Not std::tolower: a path means the same in every locale.
    for (char& c : extension) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    const auto* const it = std::find_if(kFormats.begin(), kFormats.end(),
                                        [&](const Format& f) { return f.extension == extension; });
    if (it != kFormats.end()) return *it;
    std::string text = path.string() + ": ";
    text += extension.empty() ? "a name without extension" : "extension " + extension;
    text += " does not say how to write a mesh; supported are";
    for (const Format& f : kFormats)
        text += (&f == kFormats.data() ? " " : ", ") + std::string(f.extension);
    throw InvalidArgument(text);
}

const Format& format_with(const std::filesystem::path& path, const MeshFileOptions& options) {
    const Format& format = format_of(path);
    const auto refuse = [&](const std::string& what) {
        throw InvalidArgument(path.string() + ": " + std::string(format.extension) + what);
    };
    if (options.is_ascii && !format.has_ascii) refuse(" has no text variant; write .ply");
    if (options.compression != Compression::None && !format.has_compression) {
        refuse(" is not compressed; write .glb or .gltf, or .drc for Draco");
    }
    const Quantization& q = options.quantization;
    if (q.kind == Quantization::Kind::None) return format;
    if (!format.has_quantization) refuse(" is not quantised; write .glb, .gltf or .drc");
    const bool is_drc = format.extension == ".drc" || options.compression == Compression::Draco;
    const unsigned most = is_drc ? streaming::kMostDracoBits : streaming::kMostGltfBits;
    if (q.kind == Quantization::Kind::Bits && !(q.value >= 1 && q.value <= most)) {
        refuse(" takes 1 to " + std::to_string(most) + " bits a coordinate");
    }
    if (q.kind == Quantization::Kind::Step && !(q.value > 0 && std::isfinite(q.value))) {
        refuse(": a step of quantisation is a positive length");
    }
    return format;
}

}  // namespace

std::unique_ptr<MeshSink> create_mesh_file(const std::filesystem::path& path,
                                           const MeshFileOptions& options) {
    return format_with(path, options).create(path, options);
}

std::unique_ptr<MeshSink> streaming::create_mesh_file(const std::filesystem::path& path,
                                                      const MeshFileOptions& options,
                                                      ooc::OutputGroup& group) {
    std::unique_ptr<FileSink> sink = format_with(path, options).create(path, options);
    sink->publish_with(group);
    return sink;
}

void streaming::require_format_fits(const std::filesystem::path& path, const SinkHeader& header) {
    format_of(path).require_fits(path, header);
}

std::vector<std::string> streaming::what_is_lost(const std::filesystem::path& path,
                                                 const SinkHeader& header) {
    const Format& format = format_of(path);
    std::string missing;
    const auto miss = [&](bool is_lost, const char* what) {
        if (is_lost) missing += (missing.empty() ? "" : ", ") + std::string(what);
    };
    miss(header.has_normals && !format.has_normals, "normals of vertices");
    miss(header.has_colors && !format.has_colors, "colours");
    miss(header.has_alpha && format.has_colors && !format.has_alpha, "alpha");
    const std::string name = path.string() + ": " + std::string(format.extension);
    std::vector<std::string> lost;
    if (!missing.empty()) lost.push_back(name + " has no place for " + missing + "; left out");
    if (needs_double(header) && !format.has_far_positions) {
        lost.push_back(name +
                       " holds floats, which are too coarse this far from the origin: "
                       "positions are rounded; .ply, .obj, .off and .glb keep them");
    }
    return lost;
}

}  // namespace hewer
