// SPDX-License-Identifier: MIT
#include "hewer/plan.h"

#include <iostream>

#include "app/commands.h"
#include "app/format_text.h"
#include "app/report_json.h"
#include "app/simplify_options.h"
#include "hewer/units.h"

namespace hewer::app {

namespace {

void print_plan(const PlanReport& r) {
    std::cout << "input      " << format_plural(r.input.faces, "face") << ", "
              << format_bytes(r.input.bytes) << " (" << r.input.path << ")\n";
    if (r.cells != 0) {
        std::cout << "grid       about " << format_plural(r.cells, "cell") << " with an edge of "
                  << format_length(r.cell_size) << ", " << format_count(r.surviving_triangles)
                  << " triangles between them\n";
    }
    if (r.target_triangles != 0) {
        std::cout << "target     " << format_plural(r.target_triangles, "triangle") << '\n';
    }
    std::cout << "memory     about " << format_bytes(r.memory_bytes) << " of "
              << format_bytes(r.memory_limit_bytes)
              << (r.fits ? ": fits\n"
                         : ": does not fit; raise --memory to " +
                               format_bytes(r.least_memory_bytes) + " or more\n")
              << "disk       about " << format_bytes(r.bytes_read) << " read, "
              << format_bytes(r.bytes_written) << " written, " << format_bytes(r.temp_bytes)
              << " for temporary files\n"
              << "time       about " << format_seconds(r.seconds) << '\n';
}

}  // namespace

void run_plan(const Arguments& arguments) {
    const SimplifyOptions options = make_simplify_options(arguments);
    const PlanReport report = plan(arguments.paths("input"), options);
    if (arguments.flag("json")) {
        std::cout << to_json(report, arguments);
    } else {
        print_plan(report);
    }
}

}  // namespace hewer::app
