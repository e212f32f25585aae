// SPDX-License-Identifier: MIT
#include "app/report_json.h"

#include <nlohmann/json.hpp>
#include <type_traits>

#include "hewer/error.h"
#include "hewer/version.h"

namespace hewer::app {

namespace {

using Json = nlohmann::ordered_json;

const char* name_of(Method method) {
    switch (method) {
        case Method::Refine:
            return "refine";
        case Method::Uniform:
            return "uniform";
        case Method::Full:
            return "full";
        case Method::Copy:
            return "copy";
        case Method::Auto:
            break;
    }
    return "auto";
}

Json to_value(const Vec3& v) {
    return {v[0], v[1], v[2]};
}

Json to_value(const Bounds& b) {
    if (b.is_empty()) return nullptr;
    return {{"min", to_value(b.min)}, {"max", to_value(b.max)}};
}

const char* name_of(Target::Kind kind) {
    switch (kind) {
        case Target::Kind::Triangles:
            return "triangles";
        case Target::Kind::Vertices:
            return "vertices";
        case Target::Kind::Ratio:
            return "ratio";
        case Target::Kind::Error:
            return "error";
        case Target::Kind::RelativeError:
            return "relative_error";
    }
    throw InternalError("target kind without a name");
}

Json to_value(const Quantization& q) {
    switch (q.kind) {
        case Quantization::Kind::None:
            break;
        case Quantization::Kind::Auto:
            return "auto";
        case Quantization::Kind::Bits:
            return {{"bits", static_cast<std::uint64_t>(q.value)}};
        case Quantization::Kind::Step:
            return {{"step", q.value}};
    }
    return nullptr;
}

Json to_value(const Target& t) {
    Json json{{"kind", name_of(t.kind)}, {"value", t.value}};
    // A count reads as one, not as 250000.0.
    if (t.kind == Target::Kind::Triangles || t.kind == Target::Kind::Vertices) {
        json["value"] = static_cast<std::uint64_t>(t.value);
    }
    return json;
}

Json to_value(const InputDefects& d) {
    return {{"nonfinite_vertices", d.nonfinite_vertices},
            {"nonfinite_triangles", d.nonfinite_triangles},
            {"out_of_range_triangles", d.out_of_range_triangles},
            {"short_faces", d.short_faces},
            {"polygons", d.polygons},
            {"degenerate_triangles", d.degenerate_triangles},
            {"bad_weights", d.bad_weights},
            {"trailing_bytes", d.trailing_bytes},
            {"first_nonfinite", d.first_nonfinite},
            {"first_out_of_range", d.first_out_of_range}};
}

Json to_value(const TopologyReport& r) {
    return {{"components", r.components},
            {"border_edges", r.border_edges},
            {"border_loops", r.border_loops},
            {"nonmanifold_edges", r.nonmanifold_edges},
            {"nonmanifold_vertices", r.nonmanifold_vertices},
            {"euler", r.euler}};
}

const char* name_of(InputReport::Basis basis) {
    switch (basis) {
        case InputReport::Basis::Whole:
            return "whole";
        case InputReport::Basis::Header:
            return "header";
        case InputReport::Basis::Sample:
            return "sample";
        case InputReport::Basis::Name:
            break;
    }
    return "name";
}

Json to_value(const std::vector<TextureInfo>& textures) {
    Json list = Json::array();
    for (const TextureInfo& t : textures) {
        list.push_back(
            {{"name", t.name}, {"format", t.format}, {"width", t.width}, {"height", t.height}});
    }
    return list;
}

/// Null is what was not read.
Json to_value(const InputReport& r) {
    const bool is_whole = r.basis == InputReport::Basis::Whole;
    const bool has_counts = r.basis != InputReport::Basis::Name;
    const auto known = [](bool is_known, const auto& value) {
        return is_known ? Json(value) : Json();
    };
    Json json{{"path", r.path},
              {"format", r.format},
              {"bytes", r.bytes},
              {"basis", name_of(r.basis)},
              {"opening_seconds", r.opening_seconds},
              {"vertices", known(has_counts, r.vertices)},
              {"faces", known(has_counts, r.faces)},
              {"triangles", known(has_counts, r.triangles)},
              {"bounds", to_value(r.bounds)},
              {"has_normals", known(has_counts, r.has_normals)},
              {"has_colors", known(has_counts, r.has_colors)},
              {"has_weights", r.has_weights},
              {"textures", to_value(r.textures)},
              {"ignored", r.ignored},
              {"defects", known(is_whole, to_value(r.defects))},
              {"area", known(is_whole, r.area)},
              {"vertex_passes", r.vertex_passes},
              {"triangle_passes", r.triangle_passes}};
    if (r.topology) json["topology"] = to_value(*r.topology);
    return json;
}

Json to_value(const GridReport& r) {
    return {{"cell_size", r.cell_size},
            {"dimensions", r.dimensions},
            {"occupied_cells", r.occupied_cells},
            {"border_cells", r.border_cells},
            {"surviving_triangles", r.surviving_triangles},
            {"is_consistently_wound", r.is_consistently_wound}};
}

Json to_value(const FitReport& r) {
    return {{"rounds", r.rounds},       {"first_move", r.first_move},
            {"last_move", r.last_move}, {"distance", r.distance},
            {"held", r.held},           {"flips", r.flips}};
}

Json to_value(const FeedbackReport& r) {
    return {{"rounds", r.rounds},
            {"far_cells", r.far_cells},
            {"first_worst", r.first_worst},
            {"last_worst", r.last_worst}};
}

Json to_value(const LostPlace& p) {
    return {{"center", to_value(p.center)}, {"size", p.size}, {"cells", p.cells}};
}

Json to_value(const LostPlaces& r) {
    Json list = Json::array();
    for (const LostPlace& place : r.list) list.push_back(to_value(place));
    return {{"places", r.places}, {"cells", r.cells}, {"list", list}};
}

Json to_value(const FoldedFace& f) {
    return {{"center", to_value(f.center)}, {"size", f.size}};
}

Json to_value(const FoldedFaces& r) {
    Json list = Json::array();
    for (const FoldedFace& face : r.list) list.push_back(to_value(face));
    return {{"faces", r.faces}, {"unfolded", r.unfolded}, {"list", list}};
}

Json to_value(const AggregateReport& r) {
    return {{"parts", r.parts},
            {"joined_parts", r.joined_parts},
            {"merged_cells", r.merged_cells},
            {"distance", r.distance}};
}

Json to_value(const DistanceBin& b) {
    return {{"from", b.from}, {"to", b.to}, {"n", b.n}};
}

Json to_value(const DistanceQuantile& q) {
    return {{"share", q.share}, {"distance", q.distance}};
}

Json to_value(const WorstPlace& w) {
    return {{"point", to_value(w.point)}, {"distance", w.distance}};
}

// to_list() finds only what is declared before it.
Json to_value(const LodReport& r);
Json to_value(const SearchStep& s);
Json to_value(const StageReport& r);
Json to_value(const FocusBox& f);

template <typename T>
Json to_list(const std::vector<T>& items) {
    Json list = Json::array();
    for (const T& item : items) list.push_back(to_value(item));
    return list;
}

Json to_value(const DistanceReport& r) {
    return {{"maximum", r.maximum},
            {"mean", r.mean},
            {"rms", r.rms},
            {"vertex_maximum", r.vertex_maximum},
            {"vertex_mean", r.vertex_mean},
            {"vertex_rms", r.vertex_rms},
            {"n_vertices", r.n_vertices},
            {"n_samples", r.n_samples},
            {"quantiles", to_list(r.quantiles)},
            {"histogram", to_list(r.histogram)},
            {"worst", to_list(r.worst)}};
}

const char* name_of(WithinReport::Verdict verdict) {
    switch (verdict) {
        case WithinReport::Verdict::Proven:
            return "proven";
        case WithinReport::Verdict::Refuted:
            return "refuted";
        case WithinReport::Verdict::Undecided:
            break;
    }
    return "undecided";
}

Json to_value(const Proof& p) {
    return {{"distance", p.distance},
            {"verdict", name_of(p.report.verdict)},
            {"forward", to_list(p.report.forward)},
            {"backward", to_list(p.report.backward)},
            {"n_pieces", p.report.n_pieces}};
}

Json to_value(const SearchStep& s) {
    return {{"triangles", s.triangles}, {"distance", s.distance}};
}

Json to_value(const MeasureReport& r) {
    return {{"forward", to_value(r.forward)}, {"backward", to_value(r.backward)}};
}

Json to_value(const LodReport& r) {
    return {{"path", r.path},
            {"target", to_value(r.target)},
            {"target_triangles", r.target_triangles},
            {"triangles", r.triangles},
            {"vertices", r.vertices},
            {"bounds", to_value(r.bounds)},
            {"error_bound", r.error_bound},
            {"quantization", r.quantization},
            {"lost_cells", r.lost_cells},
            {"lost", to_value(r.lost)},
            {"fit", to_value(r.fit)},
            {"folded", r.folded ? to_value(*r.folded) : Json()},
            {"topology", to_value(r.topology)},
            {"measured", r.measured ? to_value(*r.measured) : Json()},
            {"proven_within", r.proven_within},
            {"is_nested", r.is_nested},
            {"bytes", r.bytes}};
}

Json to_value(const StageReport& r) {
    return {{"name", r.name},
            {"seconds", r.seconds},
            {"bytes_read", r.bytes_read},
            {"bytes_written", r.bytes_written},
            {"temp_bytes_read", r.temp_bytes_read},
            {"temp_bytes_written", r.temp_bytes_written},
            {"peak_budget_bytes", r.peak_budget_bytes},
            {"peak_resident_bytes", r.peak_resident_bytes}};
}

Json to_value(const FocusBox& f) {
    return {{"box", to_value(f.box)}, {"weight", f.weight}};
}

Json to_value(const Value& value) {
    return std::visit(
        [](const auto& v) -> Json {
            using T = std::decay_t<decltype(v)>;
            if constexpr (std::is_same_v<T, std::vector<Target>> ||
                          std::is_same_v<T, std::vector<FocusBox>>) {
                return to_list(v);
            } else if constexpr (std::is_same_v<T, Target> || std::is_same_v<T, Bounds> ||
                                 std::is_same_v<T, Quantization>) {
                return to_value(v);
            } else {
                return v;
            }
        },
        value);
}

Json options_of(const Arguments& arguments) {
    Json json = Json::object();
    for (const OptionSpec& option : option_table()) {
        if (!option.belongs_to(arguments.command())) continue;
        const std::string key(option.key);
        const Value* value = arguments.find(option.key);
        if (value != nullptr) {
            json[key] = to_value(*value);
        } else if (option.type == ValueType::Flag) {
            json[key] = false;
        } else {
            json[key] = nullptr;
        }
    }
    return json;
}

// File names need not be UTF-8, JSON has to be.
std::string dump(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace

std::string to_json(const SimplifyReport& r, const Arguments& arguments) {
    Json options = options_of(arguments);
    options["memory"] = r.options.memory_bytes;
    options["threads"] = r.options.n_threads;
    options["temp_dir"] = r.options.temp_dir.string();
    return dump({{"version", r.version},
                 {"command", "simplify"},
                 {"options", options},
                 {"method", name_of(r.options.method)},
                 {"input", to_value(r.input)},
                 {"grid", to_value(r.grid)},
                 {"kept_topology", r.kept_topology ? to_value(*r.kept_topology) : Json()},
                 {"aggregate", r.aggregate ? to_value(*r.aggregate) : Json()},
                 {"dropped", to_value(r.dropped)},
                 {"refined_clusters", r.refined_clusters},
                 {"feedback", to_value(r.feedback)},
                 {"joined_necks", r.joined_necks},
                 {"collapses", r.collapses},
                 {"lods", to_list(r.lods)},
                 {"search", to_list(r.search)},
                 {"stages", to_list(r.stages)},
                 {"warnings", r.warnings},
                 {"seconds", r.seconds},
                 {"bytes_read", r.bytes_read},
                 {"bytes_written", r.bytes_written},
                 {"temp_bytes_read", r.temp_bytes_read},
                 {"temp_bytes_written", r.temp_bytes_written},
                 {"peak_temp_bytes", r.peak_temp_bytes},
                 {"peak_budget_bytes", r.peak_budget_bytes},
                 {"peak_resident_bytes", r.peak_resident_bytes},
                 {"result_hash", r.result_hash}});
}

std::string to_json(const MeasureReport& r, const std::optional<Proof>& proof,
                    const Arguments& arguments) {
    return dump({{"version", version()},
                 {"command", "measure"},
                 {"options", options_of(arguments)},
                 {"forward", to_value(r.forward)},
                 {"backward", to_value(r.backward)},
                 {"bounds", to_value(r.bounds)},
                 {"diagonal", r.bounds.diagonal()},
                 {"original_triangles", r.original_triangles},
                 {"simplified_triangles", r.simplified_triangles},
                 {"map_range", r.map_range},
                 {"within", proof ? to_value(*proof) : Json()},
                 {"temp_bytes_written", r.temp_bytes_written},
                 {"seconds", r.seconds},
                 {"peak_resident_bytes", r.peak_resident_bytes}});
}

std::string to_json(const InputReport& r) {
    Json json{{"version", version()}, {"command", "info"}};
    json.update(to_value(r));
    return dump(json);
}

std::string to_json(const PlanReport& r, const Arguments& arguments) {
    return dump({{"version", version()},
                 {"command", "plan"},
                 {"options", options_of(arguments)},
                 {"input", to_value(r.input)},
                 {"cell_size", r.cell_size},
                 {"cells", r.cells},
                 {"surviving_triangles", r.surviving_triangles},
                 {"target_triangles", r.target_triangles},
                 {"memory_bytes", r.memory_bytes},
                 {"memory_limit_bytes", r.memory_limit_bytes},
                 {"least_memory_bytes", r.least_memory_bytes},
                 {"fits", r.fits},
                 {"temp_bytes", r.temp_bytes},
                 {"bytes_read", r.bytes_read},
                 {"bytes_written", r.bytes_written},
                 {"seconds", r.seconds}});
}

}  // namespace hewer::app
