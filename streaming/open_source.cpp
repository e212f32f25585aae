// SPDX-License-Identifier: MIT
/// From paths to one source: compressed data unpacked, the right reader, several files joined.
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "ooc/memory_budget.h"
#include "ooc/progress_part.h"
#include "streaming/ascii_stl_reader.h"
#include "streaming/draco_arrays.h"
#include "streaming/file_format.h"
#include "streaming/gltf_reader.h"
#include "streaming/joined_source.h"
#include "streaming/mesh_import.h"
#include "streaming/obj_reader.h"
#include "streaming/off_reader.h"
#include "streaming/om_reader.h"
#include "streaming/ply_textures.h"
#include "streaming/stl_reader.h"
#include "streaming/temporary_input.h"
#include "streaming/unpack.h"

namespace hewer {

namespace {

using streaming::beside;
using streaming::FileFormat;

std::unique_ptr<ooc::InputFile> open_input(const std::filesystem::path& path,
                                           const OpenOptions& options, const Hooks& hooks) {
    if (streaming::is_pipe(path)) return streaming::spool_pipe(path, options, hooks);
    auto file = std::make_unique<ooc::InputFile>(path == "-" ? "/dev/stdin" : path);
    // What the system reads ahead counts in a control group, and cannot be taken back before the
    // disk has delivered it: 16 MiB where block devices are set to 8. Readers ask for large blocks,
    // on several threads, so little is lost.
    constexpr std::uint64_t kRoomToReadAhead = std::uint64_t{1} << 30;
    const std::uint64_t limit =
        options.memory_bytes != 0 ? options.memory_bytes : ooc::default_memory_limit();
    if (limit < kRoomToReadAhead) file->disable_readahead();
    return file;
}

/// The file itself, or what it unpacks to.
std::unique_ptr<ooc::InputFile> unpack(std::unique_ptr<ooc::InputFile> file,
                                       const OpenOptions& options, const Hooks& hooks) {
    using streaming::Packing;
    const Packing packing = streaming::detect_packing(*file);
    if (packing == Packing::None) return file;
    const OpenOptions rest = beside(options, file->held_temp_bytes());
    std::unique_ptr<ooc::InputFile> inside = packing == Packing::Gzip
                                                 ? streaming::unpack_gzip(*file, rest, hooks)
                                                 : streaming::unpack_zstd(*file, rest, hooks);
    if (streaming::detect_packing(*inside) != Packing::None) {
        throw FormatError(file->path().string() + ": compressed twice; unpack it once first");
    }
    return inside;
}

std::unique_ptr<MeshSource> open_as(FileFormat format, std::unique_ptr<ooc::InputFile> file,
                                    const OpenOptions& options, const Hooks& hooks) {
    const bool has_names =
        format == FileFormat::Ply || format == FileFormat::Gltf || format == FileFormat::Glb;
    if (!options.weight_property.empty() && !has_names) {
        throw InvalidArgument(file->path().string() +
                              ": --weight-property needs a PLY or glTF, whose vertices can have "
                              "numbers of any name; this is another format");
    }
    switch (format) {
        case FileFormat::Ply:
            return streaming::open_textured_ply(std::move(file), options, hooks);
        case FileFormat::BinaryStl:
            return streaming::open_binary_stl(std::move(file), options.strict);
        case FileFormat::Gltf:
            return streaming::open_gltf(std::move(file), false, options, hooks);
        case FileFormat::Glb:
            return streaming::open_gltf(std::move(file), true, options, hooks);
        case FileFormat::Draco:
            return streaming::open_draco(std::move(file), options);
        case FileFormat::OpenMesh:
            return streaming::open_om(std::move(file), options, hooks);
        case FileFormat::AsciiStl:
            return streaming::open_ascii_stl(*file, options, hooks);
        case FileFormat::Obj:
            return streaming::open_obj(*file, options, hooks);
        case FileFormat::Off:
            return streaming::open_off(*file, options, hooks);
    }
    throw InternalError("an input format without a reader");
}

std::unique_ptr<MeshSource> open_file(const std::filesystem::path& path, const OpenOptions& asked,
                                      const Hooks& hooks) {
    // Text inside compressed data is read twice, before and after it is unpacked.
    constexpr double kUnpacked = 0.5;
    const Hooks before = ooc::part_of(hooks, 0, kUnpacked);
    std::unique_ptr<ooc::InputFile> file = unpack(open_input(path, asked, before), asked, before);
    const OpenOptions options = beside(asked, file->held_temp_bytes());
    const FileFormat format = options.format.empty()
                                  ? streaming::detect_format(*file)
                                  : streaming::format_named(options.format, *file);
    const double from = file->held_temp_bytes() > 0 ? kUnpacked : 0;
    return open_as(format, std::move(file), options, ooc::part_of(hooks, from, 1));
}

std::string name_of(const std::vector<std::filesystem::path>& files) {
    return files.front().string() + " and " + std::to_string(files.size() - 1) + " more";
}

std::string format_of(const std::vector<std::unique_ptr<MeshSource>>& parts) {
    const std::string& first = parts.front()->info().format;
    const bool is_one = std::all_of(parts.begin(), parts.end(),
                                    [&](const auto& p) { return p->info().format == first; });
    return (is_one ? first : "several formats") + ", " + std::to_string(parts.size()) + " files";
}

/// Soups beside indexed meshes get indices.
void make_alike(std::vector<std::unique_ptr<MeshSource>>& parts, const OpenOptions& options,
                const Hooks& hooks) {
    const auto is_soup = [](const auto& part) { return !part->info().is_indexed; };
    if (std::all_of(parts.begin(), parts.end(), is_soup)) return;
    for (std::unique_ptr<MeshSource>& part : parts) {
        if (is_soup(part)) part = streaming::import_indexed(*part, options, hooks);
    }
}

std::unique_ptr<MeshSource> open_files(const std::vector<std::filesystem::path>& files,
                                       const OpenOptions& options, const Hooks& hooks) {
    if (files.size() == 1) return open_file(files.front(), options, hooks);
    std::vector<std::unique_ptr<MeshSource>> parts;
    std::uint64_t held_temp_bytes = 0;
    const double share = 1.0 / static_cast<double>(files.size());
    for (std::size_t i = 0; i < files.size(); ++i) {
        const double from = share * static_cast<double>(i);
        parts.push_back(open_file(files[i], beside(options, held_temp_bytes),
                                  ooc::part_of(hooks, from, from + share)));
        held_temp_bytes += parts.back()->held_temp_bytes();
    }
    make_alike(parts, beside(options, held_temp_bytes), ooc::part_of(hooks, 1, 1));
    std::string format = format_of(parts);
    return streaming::join_sources(std::move(parts), name_of(files), std::move(format));
}

}  // namespace

std::vector<std::string> input_formats() {
    return streaming::format_names();
}

std::unique_ptr<MeshSource> open_mesh(const InputPaths& inputs, const OpenOptions& options,
                                      const Hooks& hooks) {
    const auto start = std::chrono::steady_clock::now();
    const std::vector<std::filesystem::path> files = list_files(inputs);
    if (files.empty()) throw InvalidArgument("no input is named");
    std::unique_ptr<MeshSource> source = open_files(files, options, hooks);
    source->set_opening_seconds(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return source;
}

}  // namespace hewer
