// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/format_text.h"
#include "app/path_checks.h"
#include "app/progress_bar.h"
#include "app/report_json.h"
#include "app/resources.h"
#include "hewer/error.h"
#include "hewer/measure.h"
#include "hewer/text_file.h"
#include "hewer/units.h"
#include "hewer/within.h"

namespace hewer::app {

namespace {

constexpr std::size_t kMostPlaces = 3;

void print_row(const char* name, double forward, double backward, double diagonal) {
    std::printf("%-12s %14s %12s %14s %12s\n", name, format_length(forward).c_str(),
                format_percent(forward, diagonal).c_str(), format_length(backward).c_str(),
                format_percent(backward, diagonal).c_str());
}

/// 0.999 as "99.9 %".
std::string format_share(double share) {
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), "%.4g %%", 100 * share);
    return text.data();
}

/// The first few; the report has ten.
void print_worst(const char* surface, const DistanceReport& side, double diagonal) {
    std::printf("worst places of the %s:\n", surface);
    for (std::size_t i = 0; i < std::min(kMostPlaces, side.worst.size()); ++i) {
        const WorstPlace& w = side.worst[i];
        std::printf("  %s (%s) at %.6g, %.6g, %.6g\n", format_length(w.distance).c_str(),
                    format_percent(w.distance, diagonal).c_str(), w.point[0], w.point[1],
                    w.point[2]);
    }
}

/// The first few; the report has ten.
void print_places(const char* surface, const std::vector<WorstPlace>& places) {
    for (const WorstPlace& w : std::span(places).first(std::min(kMostPlaces, places.size()))) {
        std::printf("  %.6g, %.6g, %.6g of %s\n", w.point[0], w.point[1], w.point[2], surface);
    }
}

void print_table(const MeasureReport& r) {
    const double diagonal = r.bounds.diagonal();
    std::printf("%-12s %27s %27s\n", "distance", "original to simplified",
                "simplified to original");
    std::printf("%-12s %14s %12s %14s %12s\n", "", "units", "of diagonal", "units", "of diagonal");
    print_row("maximum", r.forward.maximum, r.backward.maximum, diagonal);
    print_row("mean", r.forward.mean, r.backward.mean, diagonal);
    print_row("rms", r.forward.rms, r.backward.rms, diagonal);
    for (std::size_t i = 0; i < r.forward.quantiles.size(); ++i) {
        const std::string name = format_share(r.forward.quantiles[i].share) + " within";
        print_row(name.c_str(), r.forward.quantiles[i].distance, r.backward.quantiles[i].distance,
                  diagonal);
    }
    print_worst("original", r.forward, diagonal);
    print_worst("simplified surface", r.backward, diagonal);
    std::printf(
        "distances are exact; measured from all %s vertices and %s points spread by area on the "
        "original (%s triangles),\n"
        "and from all %s vertices and %s points on the simplified surface (%s triangles)\n",
        format_count(r.forward.n_vertices).c_str(), format_count(r.forward.n_samples).c_str(),
        format_count(r.original_triangles).c_str(), format_count(r.backward.n_vertices).c_str(),
        format_count(r.backward.n_samples).c_str(), format_count(r.simplified_triangles).c_str());
    std::printf("diagonal %s, %s, peak memory %s\n", format_length(diagonal).c_str(),
                format_seconds(r.seconds).c_str(), format_bytes(r.peak_resident_bytes).c_str());
}

void print_proof(const Proof& proof, double diagonal) {
    const std::string distance =
        format_length(proof.distance) + " (" + format_percent(proof.distance, diagonal) + ")";
    switch (proof.report.verdict) {
        case WithinReport::Verdict::Proven:
            std::printf("proven: no point of either surface is farther than %s from the other\n",
                        distance.c_str());
            break;
        case WithinReport::Verdict::Refuted:
            std::printf("not within %s: farther, or by less than a hundredth nearer, are\n",
                        distance.c_str());
            print_places("the original", proof.report.forward);
            print_places("the simplified surface", proof.report.backward);
            break;
        case WithinReport::Verdict::Undecided:
            std::printf("not decided: that no point is farther than %s was shown neither way\n",
                        distance.c_str());
            break;
    }
}

void print_map(const std::filesystem::path& map, const MeasureReport& r) {
    std::printf("%s: dark blue is distance 0, yellow is %s (%s of the diagonal) and beyond\n",
                map.string().c_str(), format_length(r.map_range).c_str(),
                format_percent(r.map_range, r.bounds.diagonal()).c_str());
}

}  // namespace

ExitCode run_measure(const Arguments& arguments, const std::stop_token& stop) {
    const std::filesystem::path original = arguments.path("original");
    const std::filesystem::path simplified = arguments.path("simplified");
    std::vector<PlannedOutput> outputs;
    if (arguments.is_given("report")) outputs.push_back({arguments.path("report"), "report"});
    MeasureOptions options;
    if (arguments.is_given("map")) {
        options.map = arguments.path("map");
        outputs.push_back({options.map, "map"});
    } else if (arguments.is_given("map_of") || arguments.is_given("map_range")) {
        throw InvalidArgument("--map-of and --map-range say what --map shows: give that, too");
    }
    check_outputs({original, simplified}, outputs, arguments.flag("force"));
    options.overwrite = arguments.flag("force");
    options.map_of =
        arguments.get<std::string>("map_of") == "original" ? MapOf::Original : MapOf::Simplified;
    if (arguments.is_given("map_range")) options.map_range = arguments.get<double>("map_range");
    options.input_format = arguments.get<std::string>("input_format");
    options.temp_dir = arguments.path("temp_dir");
    options.max_temp_bytes = arguments.get<std::uint64_t>("max_temp");
    options.seed = arguments.get<std::uint64_t>("seed");
    options.n_samples = arguments.get<std::uint64_t>("samples");
    take_resources(arguments, options);

    ProgressPrinter printer(
        choose_progress_style(arguments.get<std::string>("progress"), arguments.flag("quiet")));
    const MeasureReport report = measure_files(original, simplified, options, printer.hooks(stop));
    std::optional<Proof> proof;
    if (arguments.is_given("within")) {
        const Target within = arguments.get<Target>("within");
        proof.emplace();
        proof->distance = within.kind == Target::Kind::RelativeError
                              ? within.value * report.bounds.diagonal()
                              : within.value;
        proof->report =
            prove_within_files(original, simplified, proof->distance, options, printer.hooks(stop));
    }
    printer.finish();
    if (!arguments.flag("quiet")) {
        print_table(report);
        if (proof) print_proof(*proof, report.bounds.diagonal());
        if (!options.map.empty()) print_map(options.map, report);
    }
    if (arguments.is_given("report")) {
        write_text_file(arguments.path("report"), to_json(report, proof, arguments),
                        arguments.flag("force"));
    }
    return !proof || proof->report.verdict == WithinReport::Verdict::Proven ? ExitCode::Ok
                                                                            : ExitCode::TooFar;
}

}  // namespace hewer::app
