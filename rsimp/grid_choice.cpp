// SPDX-License-Identifier: MIT
#include "rsimp/grid_choice.h"

#include <algorithm>
#include <cmath>

#include "cluster/uniform_grid.h"
#include "hewer/error.h"

namespace hewer::rsimp {

namespace {

double longest_side(const Bounds& bounds) {
    const Vec3 size = bounds.size();
    return std::max({size[0], size[1], size[2]});
}

double resolution_of_cell(double cell, const Bounds& bounds, const char* what) {
    const double resolution = longest_side(bounds) / cell;
    if (resolution > cluster::UniformGrid::kMaxResolution) {
        throw InvalidArgument(std::string(what) +
                              " is too small for the model: more than 2^20 cells " +
                              "on its longest side would be needed");
    }
    return std::max(1.0, resolution);
}

bool is_error(Target::Kind kind) {
    return kind == Target::Kind::Error || kind == Target::Kind::RelativeError;
}

}  // namespace

double target_vertices(const Target& target, std::uint64_t n_input_faces) {
    switch (target.kind) {
        case Target::Kind::Triangles:
            return target.value / 2;
        case Target::Kind::Vertices:
            return target.value;
        case Target::Kind::Ratio:
            return target.value * static_cast<double>(n_input_faces) / 2;
        case Target::Kind::Error:
        case Target::Kind::RelativeError:
            break;
    }
    return 0;
}

double wanted_cells(Method method, double vertices, std::uint64_t n_input_faces) {
    if (method == Method::Uniform) {
        return std::max(kUniformFewestCells, kUniformCellsPerVertex * vertices);
    }
    const double fewest = std::clamp(static_cast<double>(n_input_faces) / kTrianglesPerCell,
                                     kFewestCells, kMostOfFewest);
    return std::max(fewest, kCellsPerVertex * vertices);
}

double target_error(const Target& target, const Bounds& bounds) {
    if (target.kind == Target::Kind::Error) return target.value;
    if (target.kind == Target::Kind::RelativeError) return target.value * bounds.diagonal();
    return 0;
}

namespace {

bool is_whole(const std::vector<Target>& targets) {
    return targets.size() == 1 && targets.front().kind == Target::Kind::Ratio &&
           targets.front().value == 1;
}

/// An option that is there to change what comes out, but for the targets; null if there is none.
const char* shaping_option(const SimplifyOptions& options) {
    if (options.cell_size) return "a cell size";
    if (options.drop_parts) return "dropping parts";
    if (options.bounds) return "a box";
    if (options.priority != SplitPriority::Quadric) return "a priority";
    if (options.feedback_rounds.value_or(0) > 0) return "feedback";
    if (options.fit_rounds.value_or(0) > 0) return "a fit";
    if (options.topology == Topology::Keep) return "a topology that is kept";
    if (options.aggregate) return "joining parts";
    if (options.color_weight > 0 || options.normal_weight > 0) return "a weight of attributes";
    if (!options.weight_property.empty() || !options.focus.empty()) return "a weight of places";
    return nullptr;
}

}  // namespace

Method method_for(const SimplifyOptions& options, const SourceInfo& info) {
    if (options.method != Method::Auto) return options.method;
    if (options.topology == Topology::Keep) return Method::Full;
    if (is_whole(options.targets) && shaping_option(options) == nullptr) return Method::Copy;
    if (options.cell_size || is_error(options.targets.front().kind)) return Method::Refine;
    // Of a soup: what a closed surface would have.
    const std::uint64_t n_vertices = info.is_indexed ? info.n_vertices : info.n_faces / 2;
    return n_vertices <= kVerticesWorthAll ? Method::Full : Method::Refine;
}

double choose_resolution(const SimplifyOptions& options, const Bounds& bounds,
                         const cluster::CellSample& sample, std::uint64_t n_input_faces,
                         double finer) {
    if (!(longest_side(bounds) > 0)) return 1;  // all vertices in one place
    if (options.cell_size) return resolution_of_cell(*options.cell_size, bounds, "--cell");
    // Vertices that are nearer to each other than the finest grid tells count as one.
    if (options.topology == Topology::Keep) return cluster::UniformGrid::kMaxResolution;
    if (options.method == Method::Full) {
        // Vertices that share a cell are moved by up to its size.
        const double separating = sample.separating_resolution();
        if (!(options.feedback_distance > 0)) return separating;
        const double wanted = kCellsPerDistance * longest_side(bounds) / options.feedback_distance;
        return std::min(std::clamp(wanted, separating, kMostSeparation * separating),
                        cluster::UniformGrid::kMaxResolution);
    }
    const Target& finest = options.targets.front();
    const double error = target_error(finest, bounds);
    if (error > 0) {
        return std::min(
            std::sqrt(finer) * resolution_of_cell(error / kCellsPerError, bounds, "--error"),
            cluster::UniformGrid::kMaxResolution);
    }
    const double vertices = target_vertices(finest, n_input_faces);
    return sample.resolution_for(finer * wanted_cells(options.method, vertices, n_input_faces));
}

unsigned feedback_rounds(const SimplifyOptions& options) {
    if (options.targets.empty() || is_error(options.targets.front().kind)) return 0;
    if (options.method == Method::Uniform) return 0;
    return options.feedback_rounds.value_or(options.method == Method::Full ? kFeedbackRounds : 1);
}

bool looks_before_feedback(const SimplifyOptions& options) {
    return !options.feedback_rounds && options.method == Method::Refine;
}

unsigned fit_rounds(const SimplifyOptions& options) {
    const bool has_error = !options.targets.empty() && is_error(options.targets.front().kind);
    return options.fit_rounds.value_or(has_error ? 0 : default_fit_rounds(options.method));
}

void check_options(const SimplifyOptions& options) {
    const bool is_free_uniform = options.method == Method::Uniform && options.cell_size;
    const bool is_copy = options.method == Method::Copy;
    if (is_copy && !options.targets.empty() && !is_whole(options.targets)) {
        throw InvalidArgument("a copy keeps every triangle; a target contradicts it");
    }
    if (const char* const shaping = shaping_option(options); is_copy && shaping != nullptr) {
        throw InvalidArgument(std::string("a copy changes nothing; ") + shaping +
                              " contradicts it");
    }
    if (options.targets.empty() && !is_free_uniform && !is_copy) {
        throw InvalidArgument(
            "no target: give a number of triangles or vertices, a ratio or an error");
    }
    if (!options.targets.empty() && is_free_uniform) {
        throw InvalidArgument(
            "with the uniform method a cell size and a target contradict each other");
    }
    if (options.method == Method::Full && options.cell_size) {
        throw InvalidArgument("the full method uses every vertex; a cell size contradicts it");
    }
    if (options.topology == Topology::Keep) {
        if (options.method == Method::Refine || options.method == Method::Uniform) {
            throw InvalidArgument(
                "topology keep contradicts the methods refine and uniform, which merge vertices "
                "whatever they belong to; use the method full");
        }
        if (options.cell_size || options.drop_parts || options.aggregate) {
            throw InvalidArgument(
                "topology keep contradicts a cell size, dropping and joining parts: every vertex "
                "and every part is to stay");
        }
    }
    if (options.cell_size && !(*options.cell_size > 0 && std::isfinite(*options.cell_size))) {
        throw InvalidArgument("the cell size must be positive");
    }
    if (!(options.border_weight >= 0 && std::isfinite(options.border_weight))) {
        throw InvalidArgument("the border weight must not be negative");
    }
    for (const double weight : {options.color_weight, options.normal_weight}) {
        if (!(weight >= 0 && std::isfinite(weight))) {
            throw InvalidArgument("the weights of colours and normals must not be negative");
        }
        if (weight > 0 && options.method == Method::Uniform) {
            throw InvalidArgument(
                "the uniform method looks at places alone; weights of colours and normals "
                "contradict it");
        }
        if (weight > 0 && options.priority == SplitPriority::NormalVariation) {
            throw InvalidArgument(
                "the normal priority looks at directions of faces alone; weights of colours and "
                "normals contradict it");
        }
    }
    for (const FocusBox& focus : options.focus) {
        if (focus.box.is_empty()) {
            throw InvalidArgument(
                "a box of interest is empty: each minimum must be at most its maximum");
        }
        if (!(focus.weight >= 0 && focus.weight <= kMostWeight)) {
            throw InvalidArgument("the weight of a box of interest must be from 0 to 1000");
        }
    }
    const auto is_length = [](const Target& t) {
        return is_error(t.kind) && t.value > 0 && std::isfinite(t.value);
    };
    if (options.drop_parts && !is_length(*options.drop_parts)) {
        throw InvalidArgument("the size of parts to drop must be a positive length");
    }
    if (options.aggregate && !is_length(*options.aggregate)) {
        throw InvalidArgument("the distance of parts to join must be a positive length");
    }
    if (options.bounds && options.bounds->is_empty()) {
        throw InvalidArgument("the bounds are empty: each minimum must be at most its maximum");
    }
    if (options.feedback_rounds.value_or(0) > 0 && options.method == Method::Uniform) {
        throw InvalidArgument("the uniform method splits no clusters; feedback contradicts it");
    }
    if (options.fit_rounds.value_or(0) > 0 && !options.targets.empty() &&
        is_error(options.targets.front().kind)) {
        throw InvalidArgument("a fit could break the error bound; leave it out");
    }
    for (std::size_t i = 0; i < options.targets.size(); ++i) {
        const Target& t = options.targets[i];
        if (!(t.value > 0 && std::isfinite(t.value))) {
            throw InvalidArgument("every target must be positive");
        }
        if (t.kind == Target::Kind::Ratio && t.value > 1) {
            throw InvalidArgument("a ratio is at most 1 (100 %)");
        }
        if (is_error(t.kind) && options.method == Method::Uniform) {
            throw InvalidArgument(
                "the uniform method cannot meet an error bound; use --cell, or another method");
        }
        if (i == 0) continue;
        const Target& finer = options.targets[i - 1];
        if (t.kind != finer.kind) throw InvalidArgument("all LODs need targets of one kind");
        if (is_error(t.kind) ? !(t.value > finer.value) : !(t.value < finer.value)) {
            throw InvalidArgument("LODs must go from fine to coarse");
        }
        if (options.method == Method::Uniform) {
            throw InvalidArgument(
                "the uniform method makes one LOD at a time; use another method for several");
        }
    }
}

}  // namespace hewer::rsimp
