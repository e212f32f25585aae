// SPDX-License-Identifier: MIT
#include <algorithm>
#include <iostream>

#include "app/commands.h"
#include "app/format_text.h"
#include "app/path_checks.h"
#include "app/progress_bar.h"
#include "app/report_json.h"
#include "app/simplify_options.h"
#include "hewer/certify.h"
#include "hewer/simplify.h"
#include "hewer/text_file.h"
#include "hewer/units.h"

namespace hewer::app {

namespace {

std::vector<PlannedOutput> plan_outputs(const Arguments& arguments, std::size_t n_lods) {
    const std::filesystem::path output = arguments.path("output");
    std::vector<PlannedOutput> outputs;
    for (std::size_t lod = 0; lod < n_lods; ++lod) {
        outputs.push_back({lod_path(output, lod, n_lods), "output"});
        if (output.extension() == ".gltf") {
            std::filesystem::path buffer = outputs.back().path;
            outputs.push_back({buffer.replace_extension(".bin"), "buffer of the output"});
        }
    }
    if (n_lods > 1) {
        std::filesystem::path list = output;
        list.replace_filename(output.stem().string() + "_lods.json");
        outputs.push_back({list, "list of levels"});
    }
    if (arguments.is_given("report")) outputs.push_back({arguments.path("report"), "report"});
    return outputs;
}

void print_defects(const InputReport& input) {
    const InputDefects& d = input.defects;
    const std::uint64_t dropped = d.nonfinite_triangles + d.out_of_range_triangles + d.short_faces;
    if (dropped + d.degenerate_triangles == 0) return;
    std::cout << "           " << format_plural(dropped, "face") << " of no use left out, "
              << format_plural(d.degenerate_triangles, "degenerate triangle") << '\n';
}

void print_measured(const MeasureReport& m, double diagonal) {
    const auto figures = [&](const char* name, const DistanceReport& d) {
        std::cout << "           " << name << " at most " << format_length(d.maximum) << " ("
                  << format_percent(d.maximum, diagonal) << "), RMS " << format_length(d.rms)
                  << " (" << format_percent(d.rms, diagonal) << "); " << format_count(d.n_vertices)
                  << " vertices, all of them, and " << format_count(d.n_samples) << " samples\n";
    };
    std::cout << "measured   distance to the nearest point of the other surface\n";
    figures("input to output", m.forward);
    figures("output to input", m.backward);
}

void print_summary(const SimplifyReport& r, bool is_reported) {
    const double diagonal = r.input.bounds.diagonal();
    const char* const where = is_reported ? "; the report lists them" : "; --report lists them";
    std::cout << "input      " << format_plural(r.input.triangles, "triangle") << ", "
              << format_bytes(r.input.bytes) << " (" << r.input.path << ")\n";
    print_defects(r.input);
    if (r.dropped.places != 0) {
        std::cout << "dropped    " << format_plural(r.dropped.places, "part") << ", the largest "
                  << format_length(r.dropped.list[0].size) << " across" << where << '\n';
    }
    for (const LodReport& lod : r.lods) {
        std::cout << "output     " << format_plural(lod.triangles, "triangle") << ", "
                  << format_count(lod.vertices) << (lod.vertices == 1 ? " vertex" : " vertices")
                  << ", " << format_bytes(lod.bytes) << " (" << lod.path << ")\n"
                  << "           no vertex moved farther than " << format_length(lod.error_bound)
                  << " (" << format_percent(lod.error_bound, diagonal) << " of the diagonal)";
        if (lod.quantization > 0) {
            std::cout << ",\n           " << format_length(lod.quantization)
                      << " of it by quantisation";
        }
        std::cout << '\n';
        if (lod.proven_within > 0) {
            std::cout << "proven     no point of either surface is farther than "
                      << format_length(lod.proven_within) << " ("
                      << format_percent(lod.proven_within, diagonal) << ") from the other\n";
        }
        if (lod.measured) print_measured(*lod.measured, diagonal);
        if (lod.lost.places != 0) {
            std::cout << "lost       " << format_plural(lod.lost.places, "place")
                      << " where parts were too small to stay or folded up, the largest "
                      << format_length(lod.lost.list[0].size) << " across" << where << '\n';
        }
    }
    std::cout << "time       " << format_seconds(r.seconds) << ", peak memory "
              << format_bytes(r.peak_resident_bytes) << '\n';
}

}  // namespace

void run_simplify(const Arguments& arguments, const std::stop_token& stop) {
    const SimplifyOptions options = make_simplify_options(arguments);
    const std::size_t n_lods = std::max<std::size_t>(1, options.targets.size());
    check_outputs(list_files(arguments.paths("input")), plan_outputs(arguments, n_lods),
                  arguments.flag("force"));

    ProgressPrinter printer(
        choose_progress_style(arguments.get<std::string>("progress"), arguments.flag("quiet")));
    const auto run = arguments.is_given("error") ? simplify_to_distance
                     : arguments.flag("certify") ? simplify_and_measure
                                                 : simplify_file;
    const SimplifyReport report = run(arguments.paths("input"), arguments.path("output"), options,
                                      printer.hooks(stop), arguments.flag("force"));
    printer.finish();
    if (!arguments.flag("quiet")) print_summary(report, arguments.is_given("report"));
    if (arguments.is_given("report")) {
        write_text_file(arguments.path("report"), to_json(report, arguments),
                        arguments.flag("force"));
    }
}

}  // namespace hewer::app
