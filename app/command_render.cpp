// SPDX-License-Identifier: MIT
#include <iostream>
#include <memory>
#include <vector>

#include "app/commands.h"
#include "app/path_checks.h"
#include "app/progress_bar.h"
#include "app/resources.h"
#include "hewer/mesh_source.h"
#include "hewer/render.h"

namespace hewer::app {

void run_render(const Arguments& arguments, const std::stop_token& stop) {
    const std::filesystem::path input = arguments.path("input");
    const std::filesystem::path output = arguments.path("output");
    const auto size = arguments.get<std::array<std::uint64_t, 2>>("size");
    const auto view = arguments.get<std::array<double, 2>>("view");
    RenderOptions options;
    options.width = static_cast<unsigned>(size[0]);
    options.height = static_cast<unsigned>(size[1]);
    options.azimuth_degrees = view[0];
    options.elevation_degrees = view[1];
    options.zoom = arguments.get<double>("zoom");
    options.edges = arguments.flag("edges");
    options.use_colors = !arguments.flag("no_color");
    options.y_up = arguments.flag("y_up");
    options.overwrite = arguments.flag("force");
    take_resources(arguments, options);
    options.input_format = arguments.get<std::string>("input_format");
    options.temp_dir = arguments.path("temp_dir");
    options.max_temp_bytes = arguments.get<std::uint64_t>("max_temp");
    std::vector<std::filesystem::path> inputs{input};
    for (const char* key : {"after", "map"}) {
        if (arguments.is_given(key)) inputs.push_back(arguments.path(key));
    }
    check_outputs(inputs, {{output, "output"}}, options.overwrite);

    ProgressPrinter printer(
        choose_progress_style(arguments.get<std::string>("progress"), arguments.flag("quiet")));
    std::vector<std::unique_ptr<MeshSource>> sources;
    std::vector<MeshSource*> meshes;
    for (const std::filesystem::path& path : inputs) {
        sources.push_back(open_mesh(path, opening(options)));
        meshes.push_back(sources.back().get());
    }
    render(meshes, output, options, printer.hooks(stop));
    printer.finish();
    if (!arguments.flag("quiet")) std::cout << output.string() << ": written\n";
}

}  // namespace hewer::app
