// SPDX-License-Identifier: MIT
#include <iostream>

#include "app/commands.h"
#include "app/format_text.h"
#include "app/path_checks.h"
#include "app/progress_bar.h"
#include "hewer/generate.h"
#include "hewer/units.h"

namespace hewer::app {

void run_generate(const Arguments& arguments, const std::stop_token& stop) {
    const std::filesystem::path output = arguments.path("output");
    GenerateOptions options;
    options.n_triangles = arguments.get<std::uint64_t>("triangles");
    options.seed = arguments.get<std::uint64_t>("seed");
    options.shuffle = arguments.flag("shuffle");
    options.holes = arguments.flag("holes");
    options.color = arguments.flag("color");
    options.n_threads = static_cast<unsigned>(arguments.get<std::uint64_t>("threads"));
    options.overwrite = arguments.flag("force");
    check_outputs({}, {{output, "output"}}, options.overwrite);

    ProgressPrinter printer(
        choose_progress_style(arguments.get<std::string>("progress"), arguments.flag("quiet")));
    const GenerateReport report = generate(output, options, printer.hooks(stop));
    printer.finish();
    if (arguments.flag("quiet")) return;
    std::cout << output.string() << ": " << format_plural(report.triangles, "triangle") << ", "
              << format_count(report.vertices) << " vertices, " << format_bytes(report.bytes)
              << ", " << format_seconds(report.seconds) << '\n';
}

}  // namespace hewer::app
