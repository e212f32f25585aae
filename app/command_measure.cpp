// SPDX-License-Identifier: MIT
#include <cstdio>
#include <iostream>

#include "app/commands.h"
#include "app/format_text.h"
#include "app/path_checks.h"
#include "app/progress_bar.h"
#include "app/report_json.h"
#include "hewer/measure.h"
#include "hewer/text_file.h"
#include "hewer/units.h"

namespace hewer::app {

namespace {

void print_row(const char* name, double forward, double backward, double diagonal) {
    std::printf("%-10s %14s %12s %14s %12s\n", name, format_length(forward).c_str(),
                format_percent(forward, diagonal).c_str(), format_length(backward).c_str(),
                format_percent(backward, diagonal).c_str());
}

void print_table(const MeasureReport& r) {
    const double diagonal = r.bounds.diagonal();
    std::printf("%-10s %27s %27s\n", "distance", "original to simplified",
                "simplified to original");
    std::printf("%-10s %14s %12s %14s %12s\n", "", "units", "of diagonal", "units", "of diagonal");
    print_row("maximum", r.forward.maximum, r.backward.maximum, diagonal);
    print_row("mean", r.forward.mean, r.backward.mean, diagonal);
    print_row("rms", r.forward.rms, r.backward.rms, diagonal);
    std::printf(
        "measured from %s vertices and %s points spread by area on the original (%s triangles),\n"
        "and from %s vertices and %s points on the simplified surface (%s triangles)\n",
        format_count(r.forward.n_vertices).c_str(), format_count(r.forward.n_samples).c_str(),
        format_count(r.original_triangles).c_str(), format_count(r.backward.n_vertices).c_str(),
        format_count(r.backward.n_samples).c_str(), format_count(r.simplified_triangles).c_str());
    std::printf("diagonal %s, %s, peak memory %s\n", format_length(diagonal).c_str(),
                format_seconds(r.seconds).c_str(), format_bytes(r.peak_resident_bytes).c_str());
}

}  // namespace

void run_measure(const Arguments& arguments, const std::stop_token& stop) {
    const std::filesystem::path original = arguments.path("original");
    const std::filesystem::path simplified = arguments.path("simplified");
    if (arguments.is_given("report")) {
        check_outputs({original, simplified}, {{arguments.path("report"), "report"}},
                      arguments.flag("force"));
    }
    MeasureOptions options;
    options.n_samples = arguments.get<std::uint64_t>("samples");
    options.memory_bytes = arguments.get<std::uint64_t>("memory");
    options.n_threads = static_cast<unsigned>(arguments.get<std::uint64_t>("threads"));

    ProgressPrinter printer(
        choose_progress_style(arguments.get<std::string>("progress"), arguments.flag("quiet")));
    const MeasureReport report = measure_files(original, simplified, options, printer.hooks(stop));
    printer.finish();
    if (!arguments.flag("quiet")) print_table(report);
    if (arguments.is_given("report")) {
        write_text_file(arguments.path("report"), to_json(report, arguments),
                        arguments.flag("force"));
    }
}

}  // namespace hewer::app
