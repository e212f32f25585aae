// SPDX-License-Identifier: MIT
/// simplify() with everything it hands out kept in memory.
#pragma once

#include <vector>

#include "hewer/simplify.h"

namespace hewer::test {

struct Outcome {
    std::vector<Mesh> lods;
    std::vector<LodParents> parents;
    SimplifyReport report;
};

Outcome run_simplify(MeshSource& source, const SimplifyOptions& options);
Outcome run_simplify(const Mesh& mesh, const SimplifyOptions& options);

/// Options for one target of `kind`.
SimplifyOptions options_for(Target::Kind kind, double value);

}  // namespace hewer::test
