// SPDX-License-Identifier: MIT
#include "run_simplify.h"

#include <deque>
#include <utility>

namespace hewer::test {

Outcome run_simplify(MeshSource& source, const SimplifyOptions& options) {
    Outcome run;
    std::deque<Mesh> lods;  // sinks keep their addresses
    run.report = simplify(
        source,
        [&](std::size_t) {
            lods.emplace_back();
            return collect_mesh(lods.back());
        },
        options, {},
        [&](std::size_t lod, const LodParents& parents) {
            run.parents.resize(lod + 1);
            run.parents[lod] = parents;
        });
    for (Mesh& mesh : lods) run.lods.push_back(std::move(mesh));
    return run;
}

Outcome run_simplify(const Mesh& mesh, const SimplifyOptions& options) {
    const auto source = view_mesh(mesh);
    return run_simplify(*source, options);
}

SimplifyOptions options_for(Target::Kind kind, double value) {
    SimplifyOptions options;
    options.targets = {{kind, value}};
    return options;
}

}  // namespace hewer::test
