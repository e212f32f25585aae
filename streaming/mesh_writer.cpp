// SPDX-License-Identifier: MIT
#include "streaming/mesh_writer.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "hewer/error.h"
#include "streaming/glb_writer.h"
#include "streaming/obj_writer.h"
#include "streaming/ply_writer.h"
#include "streaming/stl_writer.h"

namespace hewer {

namespace {

struct Format {
    std::string_view extension;
    std::unique_ptr<streaming::FileSink> (*create)(const std::filesystem::path&, bool);
    void (*require_fits)(const std::filesystem::path&, const SinkHeader&);
};

/// OBJ is text: it has no limits.
void accept(const std::filesystem::path& /*path*/, const SinkHeader& /*header*/) {}

constexpr std::array<Format, 4> kFormats{{
    {".ply", streaming::create_ply, streaming::require_ply_fits},
    {".obj", streaming::create_obj, accept},
    {".stl", streaming::create_stl, streaming::require_stl_fits},
    {".glb", streaming::create_glb, streaming::require_glb_fits},
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

}  // namespace

std::unique_ptr<MeshSink> create_mesh_file(const std::filesystem::path& path, bool overwrite) {
    return format_of(path).create(path, overwrite);
}

std::unique_ptr<MeshSink> streaming::create_mesh_file(const std::filesystem::path& path,
                                                      bool overwrite, ooc::OutputGroup& group) {
    std::unique_ptr<FileSink> sink = format_of(path).create(path, overwrite);
    sink->publish_with(group);
    return sink;
}

void streaming::require_format_fits(const std::filesystem::path& path, const SinkHeader& header) {
    format_of(path).require_fits(path, header);
}

}  // namespace hewer
