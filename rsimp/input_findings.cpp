// SPDX-License-Identifier: MIT
#include "rsimp/input_findings.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "hewer/error.h"

namespace hewer::rsimp {

namespace {

void check_strict(const std::string& name, const InputDefects& d) {
    const auto refuse_any = [&](std::uint64_t n, const char* what) {
        if (n == 0) return;
        throw FormatError(name + ": " + std::to_string(n) + what +
                          "; leave --strict out to have them counted instead");
    };
    refuse_any(d.nonfinite_vertices, " vertices have NaN or infinite coordinates");
    refuse_any(d.nonfinite_triangles, " triangles have NaN or infinite coordinates");
    refuse_any(d.out_of_range_triangles, " triangles have a vertex index out of range");
    refuse_any(d.degenerate_triangles, " triangles have no area");
    refuse_any(d.bad_weights, " vertices have a weight that is no number from 0 to 1000");
    refuse_any(d.trailing_bytes, " bytes are behind the mesh");
}

void warn_of(ooc::Context& context, const std::string& name, const InputDefects& d) {
    if (d.nonfinite_vertices + d.nonfinite_triangles > 0) {
        context.warn(name + ": " + std::to_string(d.nonfinite_vertices) + " vertices and " +
                     std::to_string(d.nonfinite_triangles) +
                     " triangles with NaN or infinite coordinates were left out" +
                     (d.first_nonfinite.empty() ? "" : ", first " + d.first_nonfinite));
    }
    if (d.out_of_range_triangles > 0) {
        context.warn(name + ": " + std::to_string(d.out_of_range_triangles) +
                     " triangles with a vertex index out of range were left out, first " +
                     d.first_out_of_range);
    }
    if (d.bad_weights > 0) {
        context.warn(
            name + ": " + std::to_string(d.bad_weights) +
            " weights of vertices are no numbers from 0 to 1000: larger ones were taken as "
            "1000, others as 1");
    }
    if (d.trailing_bytes > 0) {
        context.warn(name + ": " + std::to_string(d.trailing_bytes) +
                     " bytes behind the mesh were not read; if they are a second file, give it as "
                     "an input of its own");
    }
}

void warn_of_ignored(ooc::Context& context, const SourceInfo& info) {
    constexpr std::size_t kMostNames = 8;
    const std::vector<std::string>& all = info.ignored;
    if (all.empty()) return;
    std::string names;
    for (std::size_t i = 0; i < std::min(all.size(), kMostNames); ++i) {
        names += (i == 0 ? "" : ", ") + all[i];
    }
    if (all.size() > kMostNames) {
        names += " and " + std::to_string(all.size() - kMostNames) + " more";
    }
    context.warn(info.name + ": not carried: " + names);
}

}  // namespace

void describe_input(const SourceInfo& info, InputReport& input) {
    input.path = info.name;
    input.format = info.format;
    input.bytes = info.n_bytes;
    input.vertices = info.n_vertices;
    input.faces = info.n_faces;
    input.has_normals = info.has_normals;
    input.has_colors = info.has_colors;
    input.has_weights = info.has_weights;
    input.textures = info.textures;
    input.ignored = info.ignored;
}

void judge_findings(ooc::Context& context, const MeshSource& source, bool is_strict,
                    const InputReport& input) {
    const SourceInfo& info = source.info();
    warn_of_ignored(context, info);
    warn_of(context, info.name, input.defects);
    if (is_strict) check_strict(info.name, input.defects);
    if (input.triangles == 0) {
        throw FormatError(info.name + ": has " + std::to_string(info.n_faces) +
                          " faces, but not one usable triangle");
    }
}

}  // namespace hewer::rsimp
