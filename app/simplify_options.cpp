// SPDX-License-Identifier: MIT
#include "app/simplify_options.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "app/resources.h"
#include "hewer/error.h"

namespace hewer::app {

namespace {

constexpr std::array<std::string_view, 6> kTargetKeys{"triangles", "vertices",     "ratio",
                                                      "error",     "displacement", "lods"};

// The key of the one target that was given, or empty.
std::string_view find_target(const Arguments& arguments) {
    std::string_view found;
    for (const std::string_view key : kTargetKeys) {
        // A search has no plan.
        if (key == "error" && arguments.command() == Command::Plan) continue;
        if (!arguments.is_given(key)) continue;
        if (!found.empty()) {
            throw InvalidArgument("--" + std::string(found) + " and --" + std::string(key) +
                                  " contradict each other: a run has one target" +
                                  (key == "lods" ? ", and --lods lists all levels" : ""));
        }
        found = key;
    }
    return found;
}

std::vector<Target> make_targets(const Arguments& arguments, std::string_view key) {
    if (key == "triangles" || key == "vertices") {
        const auto kind = key == "triangles" ? Target::Kind::Triangles : Target::Kind::Vertices;
        return {{kind, static_cast<double>(arguments.get<std::uint64_t>(key))}};
    }
    if (key == "ratio") return {{Target::Kind::Ratio, arguments.get<double>(key)}};
    if (key == "error" || key == "displacement") return {arguments.get<Target>(key)};
    return arguments.get<std::vector<Target>>("lods");
}

Method make_method(const std::string& name) {
    if (name == "uniform") return Method::Uniform;
    if (name == "full") return Method::Full;
    if (name == "copy") return Method::Copy;
    return name == "refine" ? Method::Refine : Method::Auto;
}

void refuse_beside_copy(const Arguments& arguments, std::string_view target) {
    const auto refuse = [](std::string name) {
        std::replace(name.begin(), name.end(), '_', '-');
        throw InvalidArgument("--" + name +
                              " and --method copy contradict each other: a copy keeps every "
                              "triangle as it is");
    };
    const bool is_whole = target == "ratio" && arguments.get<double>("ratio") == 1;
    if (!target.empty() && !is_whole) refuse(std::string(target));
    for (const char* const key :
         {"cell", "priority", "bounds", "border_weight", "feedback", "fit"}) {
        if (arguments.is_given(key)) refuse(key);
    }
}

}  // namespace

SimplifyOptions make_simplify_options(const Arguments& arguments) {
    SimplifyOptions options;
    options.method = make_method(arguments.get<std::string>("method"));
    const bool is_uniform = options.method == Method::Uniform;
    const std::string_view target = find_target(arguments);
    if (arguments.is_given("cell")) {
        options.cell_size = arguments.get<double>("cell");
        if (options.method == Method::Full) {
            throw InvalidArgument(
                "--cell and --method full contradict each other: full has no grid cells to size");
        }
        if (is_uniform && !target.empty()) {
            throw InvalidArgument("--cell and --" + std::string(target) +
                                  " contradict each other: with --method uniform the cell size "
                                  "decides how many triangles come out");
        }
    }
    const bool is_copy = options.method == Method::Copy;
    if (target.empty() && !(is_uniform && options.cell_size) && !is_copy) {
        throw InvalidArgument(
            "no target: say how far to simplify with --triangles, --vertices, --ratio, --error, "
            "--displacement or --lods (or --method uniform --cell)");
    }
    if (is_uniform && arguments.is_given("priority")) {
        throw InvalidArgument(
            "--priority and --method uniform contradict each other: uniform splits no clusters");
    }
    if (is_copy) refuse_beside_copy(arguments, target);
    if (!target.empty()) options.targets = make_targets(arguments, target);
    if (arguments.get<std::string>("topology") == "keep") {
        for (const std::string_view key : {"cell", "drop_parts", "aggregate", "priority"}) {
            if (key == "drop_parts" && arguments.command() == Command::Plan) continue;
            if (!arguments.is_given(key)) continue;
            throw InvalidArgument(
                "--topology keep and --" + std::string(key) + " contradict each other: " +
                (key == "drop_parts" || key == "aggregate" ? "every part is to stay as it is"
                                                           : "keep takes every vertex as it is"));
        }
        options.topology = Topology::Keep;
    }
    if (arguments.is_given("aggregate")) options.aggregate = arguments.get<Target>("aggregate");
    if (arguments.get<std::string>("priority") == "normal") {
        options.priority = SplitPriority::NormalVariation;
    }
    if (arguments.is_given("bounds")) options.bounds = arguments.get<Bounds>("bounds");
    options.border_weight = arguments.get<double>("border_weight");
    options.color_weight = arguments.get<double>("color_weight");
    options.normal_weight = arguments.get<double>("normal_weight");
    for (const std::string_view key : {"color_weight", "normal_weight"}) {
        if (!(arguments.get<double>(key) > 0)) continue;
        const std::string name(long_name(find_option(arguments.command(), key)));
        if (is_uniform) {
            throw InvalidArgument(name +
                                  " and --method uniform contradict each other: uniform looks at "
                                  "places alone");
        }
        if (options.priority == SplitPriority::NormalVariation) {
            throw InvalidArgument(name +
                                  " and --priority normal contradict each other: that priority "
                                  "looks at directions of faces alone");
        }
    }
    options.weight_property = arguments.get<std::string>("weight_property");
    options.focus = arguments.get<std::vector<FocusBox>>("focus");
    if (arguments.is_given("feedback")) {
        options.feedback_rounds = static_cast<unsigned>(arguments.get<std::uint64_t>("feedback"));
    }
    if (arguments.is_given("fit")) {
        options.fit_rounds = static_cast<unsigned>(arguments.get<std::uint64_t>("fit"));
    }
    if (arguments.command() == Command::Simplify) {
        options.file.is_ascii = arguments.flag("ascii");
        options.file.quantization = arguments.get<Quantization>("quantize");
        const auto compress = arguments.get<std::string>("compress");
        options.file.compression = compress == "meshopt" ? Compression::Meshopt
                                   : compress == "draco" ? Compression::Draco
                                                         : Compression::None;
        options.topology_report = arguments.flag("topology_report");
        if (arguments.is_given("drop_parts")) {
            options.drop_parts = arguments.get<Target>("drop_parts");
        }
    }
    options.input_format = arguments.get<std::string>("input_format");
    options.strict = arguments.flag("strict");
    take_resources(arguments, options);
    options.temp_dir = arguments.path("temp_dir");
    if (arguments.is_given("temp_dir") && !std::filesystem::is_directory(options.temp_dir)) {
        throw InvalidArgument("--temp-dir: " + options.temp_dir.string() +
                              " is not a folder that exists");
    }
    if (arguments.is_given("max_temp")) {
        options.max_temp_bytes = arguments.get<std::uint64_t>("max_temp");
    }
    return options;
}

}  // namespace hewer::app
