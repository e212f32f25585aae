// SPDX-License-Identifier: MIT
/// Which reader fits a file, by its content; and what to say if none does.
#include <algorithm>
#include <array>
#include <cctype>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "streaming/ply_header.h"
#include "streaming/ply_reader.h"
#include "streaming/stl_reader.h"

namespace hewer {

namespace {

using streaming::kStlHeaderBytes;
using streaming::PlyEncoding;
using streaming::PlyHeader;

constexpr const char* kFormats =
    "hewer reads PLY (binary of both byte orders, ASCII) and binary STL";

struct Signature {
    std::string_view bytes;
    const char* meaning;
};

// Prefixes that name a format by themselves.
constexpr std::array<Signature, 30> kSignatures{{
    {"\x1f\x8b", "gzip-compressed data; unpack it first"},
    {"PK\x03\x04", "a ZIP archive; unpack it first"},
    {"\x28\xb5\x2f\xfd", "Zstandard-compressed data; unpack it first"},
    {"\xfd"
     "7zXZ",
     "xz-compressed data; unpack it first"},
    {"BZh", "bzip2-compressed data; unpack it first"},
    {"7z\xbc\xaf\x27\x1c", "a 7-Zip archive; unpack it first"},
    {"LASF", "a LAS or LAZ point cloud, which has no triangles"},
    {"ASTM-E57", "an E57 point cloud, which has no triangles"},
    {"# .PCD", "a PCD point cloud, which has no triangles"},
    {"glTF", "binary glTF (GLB)"},
    {"Kaydara FBX", "FBX"},
    {"DRACO", "Draco-compressed data"},
    {"# vtk", "a legacy VTK file"},
    {"#VRML", "VRML"},
    {"#usda", "USD"},
    {"PXR-USDC", "USD"},
    {"<?xml", "XML (COLLADA, X3D, VTK, ...)"},
    {"<VTKFile", "a VTK XML file"},
    {"\x89HDF", "HDF5"},
    {"OFF", "OFF"},
    {"COFF", "OFF"},
    {"NOFF", "OFF"},
    {"STOFF", "OFF"},
    {"\x89PNG", "a PNG image"},
    {"\xff\xd8\xff", "a JPEG image"},
    {"GIF8", "a GIF image"},
    {{"II*\0", 4}, "a TIFF image"},
    {{"MM\0*", 4}, "a TIFF image"},
    {"%PDF", "a PDF document"},
    {"RIFF", "a RIFF file (WebP image, sound)"},
}};

bool is_text(std::string_view head) {
    return std::all_of(head.begin(), head.end(), [](char c) {
        return static_cast<unsigned char>(c) >= ' ' || std::isspace(static_cast<unsigned char>(c));
    });
}

/// Whether the lines begin as those of an OBJ file do: at least one "v " and no stranger.
bool is_obj(std::string_view head) {
    constexpr std::array<std::string_view, 11> kKeywords{"v", "vn", "vt",     "vp",     "f", "o",
                                                         "g", "s",  "mtllib", "usemtl", "l"};
    bool has_vertex = false;
    while (!head.empty()) {
        const std::size_t end = head.find('\n');
        if (end == head.npos) break;  // cut by the window, perhaps
        const std::string_view line = head.substr(0, end);
        head.remove_prefix(end + 1);
        const std::string_view word = line.substr(0, line.find_first_of(" \t\r"));
        if (word.empty() || word.front() == '#') continue;
        if (std::find(kKeywords.begin(), kKeywords.end(), word) == kKeywords.end()) return false;
        has_vertex = has_vertex || word == "v";
    }
    return has_vertex;
}

/// What a file that no reader takes seems to be; empty if there is no telling.
std::string describe(std::string_view head) {
    for (const Signature& signature : kSignatures) {
        if (head.substr(0, signature.bytes.size()) == signature.bytes) return signature.meaning;
    }
    if (!is_text(head)) return {};
    if (head.substr(0, 5) == "solid") {
        return "ASCII STL, which is not supported yet; convert it to binary STL or PLY";
    }
    const std::size_t first = head.find_first_not_of(" \t\r\n");
    if (first != head.npos && head[first] == '{') {
        return head.find("\"asset\"") != head.npos ? "glTF (JSON)" : "JSON";
    }
    if (is_obj(head)) return "OBJ";
    return "text of a format unknown to hewer";
}

bool has_stl_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension == ".stl";
}

/// STL has no signature. If its count is wrong too, the comment field is a hint: text, or zeros.
bool has_stl_comment(std::string_view head) {
    std::string_view comment = head.substr(0, std::min(head.size(), kStlHeaderBytes - 4));
    comment = comment.substr(0, std::min(comment.find_last_not_of('\0') + 1, comment.size()));
    return is_text(comment);
}

}  // namespace

std::unique_ptr<MeshSource> open_mesh(const std::filesystem::path& path, bool strict) {
    auto file = std::make_unique<ooc::InputFile>(path);
    file->advise_sequential();
    const std::string name = path.string();
    if (file->size() == 0) throw FormatError(name + ": the file is empty; " + kFormats);

    std::array<char, 4096> bytes{};
    const std::string_view head(bytes.data(), file->read_at(0, bytes.data(), bytes.size()));
    if (head.substr(0, 4) == "ply\n" || head.substr(0, 4) == "ply\r") {
        PlyHeader header = streaming::read_ply_header(*file);
        return header.encoding == PlyEncoding::Ascii
                   ? streaming::open_ascii_ply(std::move(file), std::move(header), strict)
                   : streaming::open_binary_ply(std::move(file), std::move(header), strict);
    }
    if (streaming::is_whole_binary_stl(*file)) {
        return streaming::open_binary_stl(std::move(file), strict);
    }
    const std::string meaning = describe(head);
    if (!meaning.empty()) {
        throw FormatError(name + ": this seems to be " + meaning + "; " + kFormats);
    }
    if (file->size() >= kStlHeaderBytes && (has_stl_extension(path) || has_stl_comment(head))) {
        return streaming::open_binary_stl(std::move(file), strict);
    }
    throw FormatError(name + ": not a mesh file that hewer knows; " + kFormats);
}

}  // namespace hewer
