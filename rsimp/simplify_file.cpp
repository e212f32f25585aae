// SPDX-License-Identifier: MIT
/// simplify() from file to files, with the manifest of a LOD chain.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "hewer/simplify.h"
#include "hewer/version.h"
#include "ooc/file.h"
#include "ooc/memory_budget.h"
#include "ooc/progress_part.h"
#include "ooc/units.h"
#include "rsimp/memory_model.h"
#include "streaming/mesh_writer.h"

namespace hewer {

namespace {

std::filesystem::path manifest_path(const std::filesystem::path& output) {
    std::filesystem::path name = output.stem();
    name += "_lods.json";
    return output.parent_path() / name;
}

std::string manifest(const SimplifyReport& report) {
    nlohmann::ordered_json root;
    root["generator"] = std::string("hewer ") + version();
    root["source"] = report.input.path;
    root["source_triangles"] = report.input.triangles;
    const Bounds& b = report.input.bounds;
    root["bounds"] = {{"min", b.min}, {"max", b.max}};
    const Vec3 center = b.center();
    root["bounding_sphere"] = {{"center", center}, {"radius", b.diagonal() / 2}};
    root["lods"] = nlohmann::ordered_json::array();
    for (const LodReport& lod : report.lods) {
        root["lods"].push_back({{"file", std::filesystem::path(lod.path).filename().string()},
                                {"triangles", lod.triangles},
                                {"vertices", lod.vertices},
                                {"error_bound", lod.error_bound},
                                {"lost_cells", lod.lost_cells},
                                {"bytes", lod.bytes}});
    }
    return root.dump(2) + "\n";
}

/// The least that `target` comes to; nothing where it does not tell the size.
std::optional<SinkHeader> least_output(const Target& target, const SourceInfo& info) {
    // A run makes at least this share of a target that the input has enough triangles for.
    constexpr double kLeastShare = 0.99;
    // Closed surfaces have half a vertex a triangle, those with borders more; fewer than this only
    // where nearly every vertex belongs to a handle.
    constexpr double kLeastVerticesPerTriangle = 0.45;
    const auto n_faces = static_cast<double>(info.n_faces);
    double triangles = 0;
    switch (target.kind) {
        case Target::Kind::Triangles:
            triangles = std::min(target.value, n_faces);
            break;
        case Target::Kind::Ratio:
            triangles = std::min(target.value, 1.0) * n_faces;
            break;
        case Target::Kind::Vertices:
            triangles = std::min(target.value / kLeastVerticesPerTriangle, n_faces);
            break;
        case Target::Kind::Error:
        case Target::Kind::RelativeError:
            return {};
    }
    SinkHeader header;
    header.n_triangles =
        std::max(static_cast<std::uint64_t>(kLeastShare * triangles), std::uint64_t{1});
    header.n_vertices =
        std::max(static_cast<std::uint64_t>(kLeastVerticesPerTriangle * kLeastShare * triangles),
                 std::uint64_t{1});
    header.has_normals = info.has_normals;
    header.has_colors = info.has_colors;
    header.has_alpha = info.has_alpha;
    return header;
}

// What cannot be evicted while an LOD goes out, of its size: page tables and checksums of spools.
constexpr std::uint64_t kShareOfWorking = 64;

/// Throws OutOfMemoryBudget if an output that is held while it is written cannot be.
void require_output_fits(const MeshSink& sink, const SinkHeader& least,
                         const std::filesystem::path& path, const SimplifyOptions& options) {
    const std::uint64_t limit =
        options.memory_bytes != 0 ? options.memory_bytes : ooc::default_memory_limit();
    const std::uint64_t held = sink.held_bytes(least);
    if (held == 0) return;
    // Beside it are windows of the mesh, pages of spools, and what the process itself takes.
    constexpr std::uint64_t kBeside = ooc::MemoryBudget::kFixedBytes + (32 << 20);
    const std::uint64_t needed =
        held + held / kShareOfWorking + kBeside + rsimp::slack_bytes(2 * held);
    if (needed <= limit) return;
    const std::string enough = std::to_string((needed >> 20) + 1) + " MiB";
    throw OutOfMemoryBudget(path.string() +
                            ": a compressed output is held while it is written, "
                            "which needs " +
                            enough + "; the limit is " + ooc::format_bytes(limit) +
                            "; raise --memory to " + enough + " or more, or leave out --compress");
}

void require_other_file(const std::filesystem::path& input, const std::filesystem::path& output) {
    std::error_code ignored;
    if (std::filesystem::equivalent(input, output, ignored)) {
        throw InvalidArgument(output.string() +
                              ": is the input; choose another name for the output");
    }
}

}  // namespace

std::filesystem::path lod_path(const std::filesystem::path& output, std::size_t lod,
                               std::size_t n_lods) {
    if (n_lods == 1) return output;
    std::filesystem::path name = output.stem();
    name += "_lod" + std::to_string(lod);
    name += output.extension();
    return output.parent_path() / name;
}

SimplifyReport simplify_to_files(MeshSource& source, const std::filesystem::path& output,
                                 const SimplifyOptions& options, const Hooks& hooks,
                                 bool overwrite) {
    const std::size_t n = std::max<std::size_t>(1, options.targets.size());
    // All outputs are opened before any work, so that a bad place for them costs nothing. They get
    // their names together: a run that fails leaves no part of a chain, and none that is half new.
    ooc::OutputGroup outputs;
    std::vector<std::unique_ptr<MeshSink>> sinks;
    MeshFileOptions file = options.file;
    file.overwrite = overwrite;
    for (std::size_t i = 0; i < n; ++i) {
        const std::filesystem::path path = lod_path(output, i, n);
        std::optional<SinkHeader> least;
        if (i < options.targets.size()) least = least_output(options.targets[i], source.info());
        // Now, not after hours of work.
        if (least) streaming::require_format_fits(path, *least);
        sinks.push_back(streaming::create_mesh_file(path, file, outputs));
        if (least) require_output_fits(*sinks.back(), *least, path, options);
    }
    std::unique_ptr<ooc::OutputFile> manifest_file;
    if (n > 1) {
        manifest_file = std::make_unique<ooc::OutputFile>(manifest_path(output), overwrite);
        manifest_file->publish_with(outputs);
    }
    SimplifyReport report = simplify(
        source, [&](std::size_t i) { return std::move(sinks[i]); }, options, hooks);
    for (std::size_t i = 0; i < n; ++i) report.lods[i].path = lod_path(output, i, n).string();
    const SourceInfo& info = source.info();
    SinkHeader header;
    header.has_normals = info.has_normals;
    header.has_colors = info.has_colors;
    header.has_alpha = info.has_alpha;
    header.bounds = report.input.bounds;
    header.has_double_positions = info.has_double_positions;
    for (const std::string& what : streaming::what_is_lost(output, header)) {
        if (hooks.on_warning) hooks.on_warning(what);
        report.warnings.push_back(what);
    }
    if (manifest_file) {
        manifest_file->write(manifest(report));
        manifest_file->commit();
    }
    outputs.publish();
    return report;
}

SimplifyReport simplify_file(const InputPaths& input, const std::filesystem::path& output,
                             const SimplifyOptions& options, const Hooks& hooks, bool overwrite) {
    // Share of the time for an input that is imported, for progress.
    constexpr double kImported = 0.4;
    const std::size_t n = std::max<std::size_t>(1, options.targets.size());
    for (const std::filesystem::path& file : list_files(input)) {
        for (std::size_t i = 0; i < n; ++i) require_other_file(file, lod_path(output, i, n));
    }
    const std::unique_ptr<MeshSource> source =
        open_mesh(input, opening(options), ooc::part_of(hooks, 0, kImported));
    const double from = source->held_temp_bytes() > 0 ? kImported : 0;
    return simplify_to_files(*source, output, options, ooc::part_of(hooks, from, 1), overwrite);
}

}  // namespace hewer
