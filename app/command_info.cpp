// SPDX-License-Identifier: MIT
#include "hewer/info.h"

#include <array>
#include <iostream>
#include <limits>
#include <string>
#include <utility>

#include "app/commands.h"
#include "app/format_text.h"
#include "app/progress_bar.h"
#include "app/report_json.h"
#include "app/resources.h"
#include "hewer/units.h"

namespace hewer::app {

namespace {

void print_topology(const TopologyReport& t) {
    std::cout << "topology   " << format_plural(t.components, "component")
              << ", Euler characteristic " << t.euler << '\n'
              << "           " << format_plural(t.border_edges, "border edge") << " in "
              << format_plural(t.border_loops, "loop") << '\n'
              << "           not manifold: " << format_plural(t.nonmanifold_edges, "edge") << ", "
              << format_count(t.nonmanifold_vertices)
              << (t.nonmanifold_vertices == 1 ? " vertex" : " vertices") << '\n';
}

void print_counts(const InputReport& r) {
    const char* const about = r.basis == InputReport::Basis::Sample ? "about " : "";
    if (r.vertices != 0) {
        std::cout << "vertices   " << about << format_count(r.vertices) << '\n';
    } else {
        std::cout << "vertices   none of their own: a triangle soup\n";
    }
    std::cout << "faces      " << about << format_count(r.faces) << '\n';
    // A header does not tell polygons from triangles.
    if (r.basis != InputReport::Basis::Header) {
        std::cout << "triangles  " << about << format_count(r.triangles) << '\n';
    }
}

void print_attributes(const InputReport& r) {
    std::cout << "attributes " << (r.has_normals ? "normals " : "")
              << (r.has_colors ? "colours" : "") << (r.has_normals || r.has_colors ? "" : "none")
              << '\n';
    for (const TextureInfo& t : r.textures) {
        std::cout << "texture    " << t.name << ": " << t.format << ", " << t.width << " x "
                  << t.height << ", sampled into the colours\n";
    }
}

void print_defects(const InputDefects& d) {
    const std::array<std::pair<std::uint64_t, std::string>, 7> rows{{
        {d.nonfinite_vertices, "vertices with a coordinate that is not finite"},
        {d.nonfinite_triangles, "triangles with such a vertex (left out)"},
        {d.out_of_range_triangles, "triangles with an index out of range (left out)"},
        {d.short_faces, "faces of fewer than three corners (left out)"},
        {d.polygons, "faces of more than three corners (cut into triangles)"},
        {d.degenerate_triangles, "triangles without area"},
        {d.trailing_bytes, "bytes behind the mesh (not read)"},
    }};
    bool has_defects = false;
    for (const auto& [count, what] : rows) {
        if (count == 0) continue;
        std::cout << (has_defects ? "           " : "defects    ") << format_count(count) << ' '
                  << what << '\n';
        has_defects = true;
    }
    if (!has_defects) std::cout << "defects    none\n";
    if (!d.first_nonfinite.empty()) {
        std::cout << "           not finite first: " << d.first_nonfinite << '\n';
    }
    if (!d.first_out_of_range.empty()) {
        std::cout << "           out of range first: " << d.first_out_of_range << '\n';
    }
}

/// What the figures rest on, where not everything was read.
const char* basis_of(const InputReport& r) {
    switch (r.basis) {
        case InputReport::Basis::Whole:
            break;
        case InputReport::Basis::Header:
            return "the header only; --check reads all of it";
        case InputReport::Basis::Sample:
            return "a sample of 8 MiB; --check reads all of it";
        case InputReport::Basis::Name:
            return "not read; --check reads all of it";
    }
    return nullptr;
}

void print_info(const InputReport& r) {
    std::cout << r.path << ": " << r.format << ", " << format_bytes(r.bytes) << '\n';
    const bool is_known = r.basis != InputReport::Basis::Name;
    if (is_known) print_counts(r);
    if (!r.bounds.is_empty()) {
        std::cout << "bounds     " << format_bounds(r.bounds) << '\n'
                  << "diagonal   " << format_length(r.bounds.diagonal()) << '\n';
    }
    if (r.area > 0) std::cout << "area       " << format_length(r.area) << '\n';
    if (is_known) print_attributes(r);
    if (!r.ignored.empty()) {
        std::cout << "not used  ";
        for (const std::string& name : r.ignored) std::cout << ' ' << name;
        std::cout << '\n';
    }
    if (r.topology) print_topology(*r.topology);
    if (const char* const basis = basis_of(r)) {
        std::cout << "read       " << basis << '\n';
    } else {
        print_defects(r.defects);
    }
}

}  // namespace

void run_info(const Arguments& arguments, const std::stop_token& stop) {
    ProgressPrinter printer(choose_progress_style(arguments.get<std::string>("progress"), false));
    InfoOptions options;
    options.with_topology = arguments.flag("topology");
    if (arguments.flag("check")) {
        options.whole_below = std::numeric_limits<std::uint64_t>::max();
    }
    take_resources(arguments, options);
    options.input_format = arguments.get<std::string>("input_format");
    options.temp_dir = arguments.path("temp_dir");
    options.max_temp_bytes = arguments.get<std::uint64_t>("max_temp");
    const InputReport report = info(arguments.paths("input"), options, printer.hooks(stop));
    printer.finish();
    if (arguments.flag("json")) {
        std::cout << to_json(report);
    } else {
        print_info(report);
    }
}

}  // namespace hewer::app
