// SPDX-License-Identifier: MIT
#include "streaming/file_format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "streaming/om_reader.h"
#include "streaming/stl_reader.h"

namespace hewer::streaming {

namespace {

constexpr const char* kFormats =
    "hewer reads PLY, STL, OBJ, OFF, OpenMesh, glTF, GLB and Draco, also compressed (.gz, .zst)";

// Prefixes that name a format by themselves.
constexpr std::array<std::pair<std::string_view, FileFormat>, 4> kOurs{{
    {"ply\n", FileFormat::Ply},
    {"ply\r", FileFormat::Ply},
    {"glTF", FileFormat::Glb},
    {"DRACO", FileFormat::Draco},
}};

struct Signature {
    std::string_view bytes;
    const char* meaning;
};

constexpr auto kForeign = std::to_array<Signature>({
    {{"PK\x03\x04", 4}, "a ZIP archive; unpack it first"},
    {{"\xfd"
      "7zXZ",
      5},
     "xz-compressed data; unpack it first"},
    {"BZh", "bzip2-compressed data; unpack it first"},
    {"7z\xbc\xaf\x27\x1c", "a 7-Zip archive; unpack it first"},
    {"Rar!", "a RAR archive; unpack it first"},
    {{"\x04\x22\x4d\x18", 4}, "LZ4-compressed data; unpack it first"},
    {"LASF", "a LAS or LAZ point cloud, which has no triangles"},
    {"ASTM-E57", "an E57 point cloud, which has no triangles"},
    {"# .PCD", "a PCD point cloud, which has no triangles"},
    {{"NGSP", 4}, "an SPZ file of Gaussian splats, which have no triangles"},
    {{"\xff\xfe", 2}, "text in UTF-16; convert it to UTF-8 first"},
    {{"\xfe\xff", 2}, "text in UTF-16; convert it to UTF-8 first"},
    {"Kaydara FBX", "FBX; export it as glTF, OBJ or PLY"},
    {"; FBX", "FBX; export it as glTF, OBJ or PLY"},
    {"BLENDER", "a Blender file; export it as glTF, OBJ or PLY"},
    {"ISO-10303-21", "STEP or IFC, which describe solids; export a triangle mesh"},
    {"#usda", "USD; export it as glTF, OBJ or PLY"},
    {"PXR-USDC", "USD; export it as glTF, OBJ or PLY"},
    {"Ogawa", "Alembic; export it as glTF, OBJ or PLY"},
    {"# vtk", "a legacy VTK file"},
    {"#VRML", "VRML"},
    {"<VTKFile", "a VTK XML file"},
    {"AC10", "an AutoCAD drawing"},
    {"IDP2", "a Quake model"},
    {"\x89HDF", "HDF5"},
    {"SQLite format 3", "an SQLite database"},
    {"\x89PNG", "a PNG image"},
    {"\xff\xd8\xff", "a JPEG image"},
    {"GIF8", "a GIF image"},
    {{"II*\0", 4}, "a TIFF image"},
    {{"MM\0*", 4}, "a TIFF image"},
    {{"\x76\x2f\x31\x01", 4}, "an OpenEXR image"},
    {"#?RADIANCE", "a Radiance image"},
    {"8BPS", "a Photoshop image"},
    {"\xabKTX", "a KTX texture"},
    {"%PDF", "a PDF document"},
    {"RIFF", "a RIFF file (WebP image, sound)"},
    {"\x7f"
     "ELF",
     "a program"},
});

/// What ZIP archives are used for, by the names of their files.
constexpr std::array<std::pair<std::string_view, const char*>, 4> kZipped{{
    {".3mf", "3MF; export it as STL, OBJ or PLY"},
    {".usdz", "USD; export it as glTF, OBJ or PLY"},
    {".kmz", "KMZ; unpack it first"},
    {".fcstd", "a FreeCAD document; export a triangle mesh"},
}};

/// What begins with an angle bracket, by the first of these words.
constexpr std::array<std::pair<std::string_view, const char*>, 6> kMarkup{{
    {"<!doctype html", "an HTML page"},
    {"<html", "an HTML page"},
    {"<collada", "COLLADA; export it as glTF, OBJ or PLY"},
    {"<x3d", "X3D; export it as glTF, OBJ or PLY"},
    {"<vtkfile", "a VTK XML file"},
    {"<svg", "an SVG drawing"},
}};

bool is_text(std::string_view head) {
    return std::all_of(head.begin(), head.end(), [](char c) {
        return static_cast<unsigned char>(c) >= ' ' || std::isspace(static_cast<unsigned char>(c));
    });
}

/// The first line, without blanks around it, that is not empty; taken off `text`. Empty if there is
/// none, or if it is cut by the end of the text.
std::string_view next_line(std::string_view& text) {
    for (;;) {
        const std::size_t end = text.find_first_of("\r\n");
        if (end == text.npos) return {};
        std::string_view line = text.substr(0, end);
        text.remove_prefix(end + 1);
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        if (!line.empty()) return line;
    }
}

/// Whether the lines begin as those of an OBJ file do: at least one vertex or face, or a material
/// library, and no stranger.
bool is_obj(std::string_view head) {
    constexpr std::array<std::string_view, 16> kKeywords{"v",  "vn",  "vt",     "vp",     "f", "o",
                                                         "g",  "s",   "mtllib", "usemtl", "l", "p",
                                                         "mg", "lod", "usemap", "maplib"};
    bool has_vertex = false;
    bool is_continued = false;
    for (std::string_view line = next_line(head); !line.empty(); line = next_line(head)) {
        const std::string_view word = line.substr(0, line.find_first_of(" \t"));
        if (!is_continued && word.front() != '#') {
            if (std::find(kKeywords.begin(), kKeywords.end(), word) == kKeywords.end()) {
                return false;
            }
            has_vertex = has_vertex || word == "v" || word == "f" || word == "mtllib";
        }
        is_continued = line.back() == '\\';
    }
    return has_vertex;
}

/// [ST][C][N][4][n]OFF, perhaps behind comments; counts may follow it at once.
bool is_off(std::string_view head) {
    std::string_view line = next_line(head);
    while (!line.empty() && line.front() == '#') line = next_line(head);
    const std::size_t off = line.find("OFF");
    if (off == line.npos || line.find_first_not_of("STCN4n") < off) return false;
    return line.size() == off + 3 || line.find_first_of(" \t#0123456789", off + 3) == off + 3;
}

/// Whether `word` stands somewhere in `text`, in small letters or capitals.
bool has_word(std::string_view text, std::string_view word) {
    return std::search(text.begin(), text.end(), word.begin(), word.end(), [](char a, char b) {
               return std::tolower(static_cast<unsigned char>(a)) == b;
           }) != text.end();
}

/// "solid", and further on a facet: many binary files begin with that word, too.
bool is_ascii_stl(std::string_view head) {
    head.remove_prefix(std::min(head.find_first_not_of(" \t\r\n"), head.size()));
    return has_word(head.substr(0, 5), "solid") && is_text(head) &&
           (has_word(head, "facet") || has_word(head, "endsolid"));
}

std::string lower_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

/// A tar archive has its mark far from its beginning.
bool is_tar(std::string_view head) {
    constexpr std::size_t kMarkAt = 257;
    return head.size() > kMarkAt && head.substr(kMarkAt, 5) == "ustar";
}

/// Lines of nothing but numbers, three or more: points as text.
bool is_number_lines(std::string_view head) {
    unsigned n_lines = 0;
    for (std::string_view line = next_line(head); !line.empty(); line = next_line(head)) {
        if (line.find_first_not_of("0123456789+-.eE,; \t") != line.npos) return false;
        if (line.find_first_of(" \t,;") == line.npos && n_lines > 0) return false;
        ++n_lines;
    }
    return n_lines > 2;
}

/// What a file that no reader takes seems to be; empty if there is no telling.
std::string describe(std::string_view head, const std::string& name) {
    for (const Signature& signature : kForeign) {
        if (head.substr(0, signature.bytes.size()) != signature.bytes) continue;
        if (head.substr(0, 2) == "PK") {
            for (const auto& [extension, meaning] : kZipped) {
                if (lower_extension(name) == extension) return meaning;
            }
        }
        return signature.meaning;
    }
    if (is_tar(head)) return "a tar archive; unpack it first";
    if (!is_text(head)) return {};
    const std::size_t first = head.find_first_not_of(" \t\r\n");
    if (first != head.npos && head[first] == '{') return "JSON, but not glTF";
    if (first != head.npos && head[first] == '<') {
        for (const auto& [word, meaning] : kMarkup) {
            if (has_word(head, word)) return meaning;
        }
        return "XML";
    }
    if (is_number_lines(head)) return "points as text, which have no triangles";
    return "text of a format unknown to hewer";
}

/// STL has no signature. If its count is wrong too, the comment field is a hint: text, or zeros.
bool has_stl_comment(std::string_view head) {
    std::string_view comment = head.substr(0, std::min(head.size(), kStlHeaderBytes - 4));
    comment = comment.substr(0, std::min(comment.find_last_not_of('\0') + 1, comment.size()));
    return is_text(comment);
}

/// The first bytes of a file, without a byte order mark. Long comments at the beginning fit.
struct Window {
    std::vector<char> bytes;
    std::string_view head;
    explicit Window(const ooc::InputFile& file) : bytes(64 << 10) {
        head = std::string_view(bytes.data(), file.read_at(0, bytes.data(), bytes.size()));
        constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
        if (head.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
            head.remove_prefix(kByteOrderMark.size());
        }
    }
};

struct Name {
    const char* name;
    FileFormat format;
};
constexpr std::array<Name, 8> kNames{{{"ply", FileFormat::Ply},
                                      {"stl", FileFormat::BinaryStl},
                                      {"obj", FileFormat::Obj},
                                      {"off", FileFormat::Off},
                                      {"om", FileFormat::OpenMesh},
                                      {"gltf", FileFormat::Gltf},
                                      {"glb", FileFormat::Glb},
                                      {"drc", FileFormat::Draco}}};

}  // namespace

std::vector<std::string> format_names() {
    std::vector<std::string> names;
    names.reserve(kNames.size());
    for (const Name& n : kNames) names.emplace_back(n.name);
    return names;
}

std::string name_of(FileFormat format) {
    if (format == FileFormat::AsciiStl) format = FileFormat::BinaryStl;
    const auto* const it = std::find_if(kNames.begin(), kNames.end(),
                                        [&](const Name& n) { return n.format == format; });
    return it == kNames.end() ? std::string() : it->name;
}

FileFormat format_named(std::string_view name, const ooc::InputFile& file) {
    const auto* const it =
        std::find_if(kNames.begin(), kNames.end(), [&](const Name& n) { return n.name == name; });
    if (it == kNames.end()) {
        throw InvalidArgument("no input format is named " + std::string(name));
    }
    if (it->format == FileFormat::BinaryStl && !is_whole_binary_stl(file) &&
        is_ascii_stl(Window(file).head)) {
        return FileFormat::AsciiStl;
    }
    return it->format;
}

Packing detect_packing(const ooc::InputFile& file) {
    const Window window(file);
    if (window.head.substr(0, 2) == "\x1f\x8b") return Packing::Gzip;
    if (window.head.substr(0, 4) == "\x28\xb5\x2f\xfd") return Packing::Zstd;
    return Packing::None;
}

FileFormat detect_format(const ooc::InputFile& file) {
    const std::string name = file.path().string();
    if (file.size() == 0) throw FormatError(name + ": the file is empty; " + kFormats);
    const Window window(file);
    const std::string_view head = window.head;
    for (const auto& [prefix, format] : kOurs) {
        if (head.substr(0, prefix.size()) == prefix) return format;
    }
    // Not only as text: the reader says that it does not take binary OFF.
    if (is_off(head)) return FileFormat::Off;
    if (is_whole_binary_stl(file)) return FileFormat::BinaryStl;
    if (find_om_header(file)) return FileFormat::OpenMesh;
    if (is_ascii_stl(head)) return FileFormat::AsciiStl;
    if (is_text(head)) {
        const std::size_t first = head.find_first_not_of(" \t\r\n");
        const bool is_json = first != head.npos && head[first] == '{';
        if (is_json && (head.find("\"asset\"") != head.npos || lower_extension(name) == ".gltf")) {
            return FileFormat::Gltf;
        }
        if (is_obj(head) || lower_extension(name) == ".obj") return FileFormat::Obj;
    }
    const std::string meaning = describe(head, name);
    if (!meaning.empty()) {
        throw FormatError(name + ": this seems to be " + meaning + "; " + kFormats);
    }
    if (file.size() >= kStlHeaderBytes &&
        (lower_extension(name) == ".stl" || has_stl_comment(head))) {
        return FileFormat::BinaryStl;
    }
    throw FormatError(name + ": not a mesh file that hewer knows; " + kFormats);
}

bool has_mesh_extension(const std::filesystem::path& path) {
    std::string extension = lower_extension(path);
    if (extension == ".gz" || extension == ".zst") extension = lower_extension(path.stem());
    return std::any_of(kNames.begin(), kNames.end(),
                       [&](const Name& n) { return extension == std::string(".") + n.name; });
}

}  // namespace hewer::streaming
