// SPDX-License-Identifier: MIT
#include "app/option_table.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "hewer/error.h"

namespace hewer::app {

namespace {

constexpr unsigned bit(Command c) {
    return 1U << static_cast<unsigned>(c);
}

constexpr unsigned kSimplify = bit(Command::Simplify);
constexpr unsigned kMeasure = bit(Command::Measure);
constexpr unsigned kInfo = bit(Command::Info);
constexpr unsigned kPlan = bit(Command::Plan);
constexpr unsigned kGenerate = bit(Command::Generate);
constexpr unsigned kRender = bit(Command::Render);
constexpr unsigned kHelp = bit(Command::Help);
constexpr unsigned kTargets = kSimplify | kPlan;
constexpr unsigned kReaders = kSimplify | kMeasure | kInfo | kPlan | kRender;

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
// Largest count that a double holds exactly: targets travel as doubles.
constexpr double kMostCount = 9007199254740992.0;
// Less than this is a forgotten suffix ("--memory 512"), not a wish.
constexpr double kLeastBytes = 1 << 20;
constexpr double kMostThreads = 1024;
constexpr double kMostPixels = 32768;
constexpr double kSmallest = std::numeric_limits<double>::denorm_min();

constexpr std::string_view kMeshes = ".ply|.obj|.off|.stl|.glb|.gltf|.drc";
constexpr std::string_view kFormats = "ply|stl|obj|off|om|gltf|glb|drc";
constexpr std::string_view kFiles = "Files";
constexpr std::string_view kTarget = "Target (exactly one)";
constexpr std::string_view kMethod = "Method";
constexpr std::string_view kResources = "Resources";
constexpr std::string_view kOutput = "What is told";
constexpr std::string_view kSurface = "Surface";
constexpr std::string_view kPicture = "Picture";

using T = ValueType;

// clang-format off
constexpr std::array kOptions{
// key, flags, metavar, type, commands, unit, default, least, most, choices, group, required, help
OptionSpec{"input", "INPUT", "", T::Paths, kSimplify | kInfo | kPlan, "", "", 0, 0, "", kFiles, true,
    "Mesh to read, its format told by its content; - for standard input. Several files, a folder or a "
    "pattern ('tile_*.ply') are one model."},
OptionSpec{"input", "INPUT", "", T::Path, kRender, "", "", 0, 0, "", kFiles, true,
    "Mesh to draw."},
OptionSpec{"input_format", "--format", "NAME", T::Choice, kReaders, "", "=by the content", 0, 0, kFormats, kFiles, false,
    "Format of the input, where its content does not tell."},
OptionSpec{"after", "AFTER", "", T::Path, kRender, "", "", 0, 0, "", kFiles, false,
    "Second mesh, drawn to the right of the first with the same camera."},
OptionSpec{"map", "--map", "MAP", T::Path, kRender, "", "", 0, 0, "", kFiles, false,
    "Distance map that `hewer measure --map` has written, drawn to the right of the others: before, "
    "after and error in one picture. A map carries its colours, so it can be drawn as INPUT, too."},
OptionSpec{"original", "ORIGINAL", "", T::Path, kMeasure, "", "", 0, 0, "", kFiles, true,
    "Mesh that the other one stands for."},
OptionSpec{"simplified", "SIMPLIFIED", "", T::Path, kMeasure, "", "", 0, 0, "", kFiles, true,
    "Mesh that is judged."},
OptionSpec{"output", "OUTPUT", "", T::Path, kGenerate, "", "", 0, 0, ".ply", kFiles, true,
    "Binary PLY to write."},
OptionSpec{"output", "-o,--output", "OUTPUT", T::Path, kSimplify, "", "", 0, 0, kMeshes, kFiles, true,
    "Mesh to write; its extension names the format. With --lods name.ply becomes name_lod0.ply, "
    "name_lod1.ply, ... and name_lods.json."},
OptionSpec{"ascii", "--ascii", "", T::Flag, kSimplify, "", "", 0, 0, "", kFiles, false,
    "Write .ply as text."},
OptionSpec{"quantize", "--quantize", "HOW", T::Quantization, kSimplify, "auto, bits, or model units", "=none; auto with Draco", 0, 0, "", kFiles, false,
    "Positions of .glb, .gltf and .drc as integers: auto (a tenth of the result's own error), 14bit, or "
    "a step such as 0.001. The rounding is part of the error bound that is reported."},
OptionSpec{"compress", "--compress", "HOW", T::Choice, kSimplify, "", "none", 0, 0, "none|meshopt|draco", kFiles, false,
    "Compression of .glb and .gltf. The result is then held in memory while it is written."},
OptionSpec{"output", "-o,--output", "OUTPUT", T::Path, kRender, "", "", 0, 0, ".png", kFiles, true,
    "Picture to write."},
OptionSpec{"force", "--force", "", T::Flag, kSimplify | kMeasure | kGenerate | kRender, "", "", 0, 0, "", kFiles, false,
    "Replace files that exist."},
OptionSpec{"topic", "COMMAND", "", T::Choice, kHelp, "", "", 0, 0, "simplify|measure|info|plan|generate|render", kFiles, false,
    "Command to explain."},

OptionSpec{"triangles", "--triangles", "N", T::Count, kTargets, "triangles", "", 1, kMostCount, "", kTarget, false,
    "At most this many triangles."},
OptionSpec{"vertices", "--vertices", "N", T::Count, kTargets, "vertices", "", 1, kMostCount, "", kTarget, false,
    "At most this many vertices."},
OptionSpec{"ratio", "--ratio", "R", T::Ratio, kTargets, "of the input's triangles", "", 0, 0, "", kTarget, false,
    "At most this share of the input's triangles: 5% or 0.05."},
OptionSpec{"error", "--error", "E", T::Error, kSimplify, "model units, or % of the diagonal", "", 0, 0, "", kTarget, false,
    "Smallest result that is within this distance of the input, either way, proven for all points: 0.5 "
    "in model units, or 0.01% of the bounding box's diagonal. Up to fourteen runs, mostly five, and repairs "
    "of what is too far then."},
OptionSpec{"displacement", "--displacement", "E", T::Error, kTargets, "model units, or % of the diagonal", "", 0, 0, "", kTarget, false,
    "No original vertex moves farther: proven from the clusters, in one run."},
OptionSpec{"lods", "--lods", "LIST", T::Lods, kTargets, "triangles, or ratios", "", 0, 0, "", kTarget, false,
    "Several levels of detail from one read, nested, fine to coarse: 1M,250k,60k or 10%,2%."},

OptionSpec{"method", "--method", "NAME", T::Choice, kTargets, "", "auto", 0, 0, "auto|refine|uniform|full|copy", kMethod, false,
    "refine: fine grid, refined where the surface needs it, finished by edge collapse. full: the same "
    "from every original vertex, and with feedback; best and slowest. uniform: one coarse grid "
    "and edge collapse; fastest. copy: every triangle as it is, into another format; needs no target. auto: full up to "
    "1M vertices, refine above; copy for --ratio 100%."},
OptionSpec{"cell", "--cell", "SIZE", T::Number, kTargets, "model units", "=from the target", kSmallest, kNoLimit, "", kMethod, false,
    "Edge of a grid cell. With --method uniform it takes the place of a target."},
OptionSpec{"priority", "--priority", "NAME", T::Choice, kTargets, "", "quadric", 0, 0, "quadric|normal", kMethod, false,
    "Which cluster is split next: the one with the largest quadric error, or with the largest "
    "normal variation."},
OptionSpec{"bounds", "--bounds", "BOX", T::Box, kTargets, "model units", "=read from the input", 0, 0, "", kMethod, false,
    "Box that holds the input, x0,y0,z0,x1,y1,z1; spares one scan of the vertices."},
OptionSpec{"border_weight", "--border-weight", "W", T::Number, kTargets, "", "30", 0, 1e6, "", kMethod, false,
    "Weight of open borders against the surface; 0 lets borders wander."},
OptionSpec{"color_weight", "--color-weight", "W", T::Number, kTargets, "% of the diagonal", "0", 0, 1e6, "", kMethod, false,
    "What colours count in choosing and placing vertices: with W, black against white as much as a "
    "distance of W per cent of the bounding box's diagonal. 0 carries them along, no more."},
OptionSpec{"normal_weight", "--normal-weight", "W", T::Number, kTargets, "% of the diagonal", "0", 0, 1e6, "", kMethod, false,
    "The same for the normals of the input's vertices: a component of a unit normal, by one."},
OptionSpec{"weight_property", "--weight-property", "NAME", T::Name, kTargets, "", "", 0, 0, "", kMethod, false,
    "Property of the vertices of a PLY, such as quality or confidence, or of a glTF (_NAME): the surface "
    "at a vertex counts as that many times its area, 0 to 1000. Only ratios matter."},
OptionSpec{"focus", "--focus", "BOX:WEIGHT", T::FocusBoxes, kTargets, "model units", "", 0, 0, "", kMethod, false,
    "Box of interest, x0,y0,z0,x1,y1,z1:WEIGHT: the surface in it counts as WEIGHT times its area, 0 "
    "to 1000. May be given several times; weights multiply."},
OptionSpec{"feedback", "--feedback", "N", T::CountOrOff, kTargets, "rounds, or off", "=2 with --method full; with refine 1 where much is far; else off", 1, 20, "", kMethod, false,
    "Find the places where a first result is far from the input, and give them more triangles."},
OptionSpec{"fit", "--fit", "N", T::CountOrOff, kTargets, "rounds, or off", "=1, with --method full 4; off with --method uniform or --displacement", 1, 100, "", kMethod, false,
    "Move the vertices of the result, as a whole, towards the original surface."},
OptionSpec{"certify", "--certify", "", T::Flag, kSimplify, "", "", 0, 0, "", kMethod, false,
    "Measure the distance of each result from the input, both ways, for the summary and the report."},
OptionSpec{"topology", "--topology", "KIND", T::Choice, kTargets, "", "simplify", 0, 0, "simplify|keep", kMethod, false,
    "keep: the result has the components, handles and border loops of the input, or there is none and the "
    "error names the least that is possible; takes every vertex (--method full). simplify: small "
    "parts and handles may go where the budget needs it, but no surface is opened."},
OptionSpec{"aggregate", "--aggregate", "DIST", T::Error, kTargets, "model units, or % of the diagonal", "", 0, 0, "", kMethod, false,
    "Join connected parts that are nearer to each other than DIST, so that many small parts become "
    "fewer large ones instead of vanishing. Parts are not joined otherwise."},
OptionSpec{"drop_parts", "--drop-parts", "SIZE", T::Error, kSimplify, "model units, or % of the diagonal", "", 0, 0, "", kMethod, false,
    "Remove connected parts whose box has a diagonal below SIZE, to within a cell of the grid, before "
    "triangles are spent on them; the report lists them."},
OptionSpec{"strict", "--strict", "", T::Flag, kTargets, "", "", 0, 0, "", kMethod, false,
    "Refuse an input with defects instead of counting them."},

OptionSpec{"samples", "--samples", "N", T::Count, kMeasure, "points a surface, about", "=one a triangle, 500k to 10M", 1, kMostCount, "", kSurface, false,
    "Points spread over each surface by area, besides all of its vertices."},
OptionSpec{"seed", "--seed", "N", T::Count, kMeasure, "", "1", 0, kMostCount, "", kSurface, false,
    "Another seed gives other points."},
OptionSpec{"within", "--within", "E", T::Error, kMeasure, "model units, or % of the diagonal", "", 0, 0, "", kSurface, false,
    "Prove that no point of either surface is farther from the other one, between the samples as well; "
    "if that does not hold, say where, and exit with 1."},
OptionSpec{"map", "--map", "FILE", T::Path, kMeasure, "", "", 0, 0, ".ply", kSurface, false,
    "Write a mesh with its vertices coloured by distance: dark blue for none, through green, to "
    "yellow at the map's range and beyond."},
OptionSpec{"map_of", "--map-of", "WHICH", T::Choice, kMeasure, "", "simplified", 0, 0, "simplified|original", kSurface, false,
    "simplified: each vertex shows the farthest of its own distance and of the points of the "
    "original that are nearest to its triangles. original: each vertex shows its own distance."},
OptionSpec{"map_range", "--map-range", "D", T::Number, kMeasure, "model units", "=the 99.9 % quantile", kSmallest, kNoLimit, "", kSurface, false,
    "Distance of the last colour of the map."},
OptionSpec{"triangles", "--triangles", "N", T::Count, kGenerate, "triangles", "1M", 1, kMostCount, "", kSurface, false,
    "At most this many triangles, and nearly as many."},
OptionSpec{"seed", "--seed", "N", T::Count, kGenerate, "", "1", 0, kMostCount, "", kSurface, false,
    "Another seed gives another surface."},
OptionSpec{"shuffle", "--shuffle", "", T::Flag, kGenerate, "", "", 0, 0, "", kSurface, false,
    "Vertices and faces in a pseudo-random order."},
OptionSpec{"holes", "--holes", "", T::Flag, kGenerate, "", "", 0, 0, "", kSurface, false,
    "Open borders, ragged as a scanner leaves them."},
OptionSpec{"color", "--color", "", T::Flag, kGenerate, "", "", 0, 0, "", kSurface, false,
    "Vertex colours."},

OptionSpec{"size", "--size", "WxH", T::Pixels, kRender, "pixels", "1024x1024", 1, kMostPixels, "", kPicture, false,
    "Size of the picture; of each, where several are side by side."},
OptionSpec{"view", "--view", "AZ,EL", T::Pair, kRender, "degrees", "30,20", 0, 0, "", kPicture, false,
    "Turn of the camera about the vertical axis, and its elevation."},
OptionSpec{"zoom", "--zoom", "Z", T::Number, kRender, "", "1", 1e-3, 1e6, "", kPicture, false,
    "1 fits the mesh into the picture; 2 shows its middle half."},
OptionSpec{"edges", "--edges", "", T::Flag, kRender, "", "", 0, 0, "", kPicture, false,
    "Draw the edges of the triangles."},
OptionSpec{"no_color", "--no-color", "", T::Flag, kRender, "", "", 0, 0, "", kPicture, false,
    "Leave out vertex colours."},
OptionSpec{"y_up", "--y-up", "", T::Flag, kRender, "", "", 0, 0, "", kPicture, false,
    "The model's y axis points up instead of z."},

OptionSpec{"memory", "--memory", "SIZE", T::Bytes, kReaders, "bytes", "=the control group's limit, else half of the machine", kLeastBytes, 0x1p62, "", kResources, false,
    "All that the process may hold; K, M, G are powers of 1024. Does not change the result."},
OptionSpec{"threads", "--threads", "N", T::Count, kReaders | kGenerate, "", "=all of the machine", 1, kMostThreads, "", kResources, false,
    "Threads that work at once. Does not change the result."},
OptionSpec{"temp_dir", "--temp-dir", "DIR", T::Path, kReaders, "", "=TMPDIR, else /tmp", 0, 0, "", kResources, false,
    "Folder for temporary files, which are made when memory runs short."},
OptionSpec{"max_temp", "--max-temp", "SIZE", T::Bytes, kReaders, "bytes", "=no limit", 1, 0x1p62, "", kResources, false,
    "Most disk space that temporary files may take."},

OptionSpec{"report", "--report", "FILE", T::Path, kSimplify | kMeasure, "", "", 0, 0, "", kOutput, false,
    "Write all figures of the run as JSON."},
OptionSpec{"json", "--json", "", T::Flag, kInfo | kPlan, "", "", 0, 0, "", kOutput, false,
    "Print JSON instead of words."},
OptionSpec{"topology_report", "--topology-report", "", T::Flag, kSimplify, "", "", 0, 0, "", kOutput, false,
    "Put borders, components and what is not manifold of the input into the report, too (those of the "
    "output are always there): one pass more over the input, as by hewer info --topology."},
OptionSpec{"check", "--check", "", T::Flag, kInfo, "", "", 0, 0, "", kOutput, false,
    "Read all of it: exact counts, bounds and area, and defects. Inputs of up to 64 MiB (16 MiB if they "
    "are compressed) are read whole anyway; of larger ones info tells what the header says, and what a "
    "sample does."},
OptionSpec{"topology", "--topology", "", T::Flag, kInfo, "", "", 0, 0, "", kOutput, false,
    "Count components, borders and what is not manifold: one pass more over the triangles, 4 bytes a "
    "vertex of memory, and temporary files where the limit is short. Equal corners of an STL are one "
    "vertex."},
OptionSpec{"progress", "--progress", "HOW", T::Choice, kSimplify | kMeasure | kInfo | kGenerate | kRender, "", "=bar on a terminal, else none", 0, 0, "bar|json|none", kOutput, false,
    "Progress on standard error: a bar, or one JSON object a line."},
OptionSpec{"quiet", "--quiet", "", T::Flag, kSimplify | kMeasure | kGenerate | kRender, "", "", 0, 0, "", kOutput, false,
    "No summary, and no progress unless --progress asks for it."},
OptionSpec{"markdown", "--markdown", "", T::Flag, kHelp, "", "", 0, 0, "", kOutput, false,
    "Print the README's tables of all options and exit codes."},
};

constexpr std::array kCommands{
CommandSpec{Command::Simplify, "simplify", "INPUT... -o OUTPUT TARGET [options]",
    "Simplify a mesh of any size to one or several levels of detail."},
CommandSpec{Command::Measure, "measure", "ORIGINAL SIMPLIFIED [options]",
    "Two-sided distance between two surfaces."},
CommandSpec{Command::Info, "info", "INPUT... [options]",
    "Counts, bounds, attributes and defects of a mesh."},
CommandSpec{Command::Plan, "plan", "INPUT... TARGET [options]",
    "Memory, disk and time that simplify would need, before any work."},
CommandSpec{Command::Generate, "generate", "OUTPUT [options]",
    "Write a scan-like test surface of any size."},
CommandSpec{Command::Render, "render", "INPUT [AFTER] [--map MAP] -o OUTPUT [options]",
    "Draw a shaded picture of a mesh, or of several side by side."},
CommandSpec{Command::Help, "help", "[COMMAND] [options]",
    "Explain a command."},
};
// clang-format on

}  // namespace

std::span<const OptionSpec> option_table() {
    return kOptions;
}
std::span<const CommandSpec> command_table() {
    return kCommands;
}

std::string_view command_name(Command command) {
    const auto* it = std::find_if(kCommands.begin(), kCommands.end(),
                                  [&](const CommandSpec& c) { return c.command == command; });
    if (it == kCommands.end()) throw InternalError("no such command");
    return it->name;
}

const OptionSpec& find_option(Command command, std::string_view key) {
    const auto* it = std::find_if(kOptions.begin(), kOptions.end(), [&](const OptionSpec& o) {
        return o.key == key && o.belongs_to(command);
    });
    if (it == kOptions.end()) throw InternalError("no option " + std::string(key));
    return *it;
}

std::string_view long_name(const OptionSpec& option) {
    const std::size_t comma = option.flags.find(',');
    return comma == std::string_view::npos ? option.flags : option.flags.substr(comma + 1);
}

}  // namespace hewer::app
