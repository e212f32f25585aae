// SPDX-License-Identifier: MIT
/// What a run tells of its input.
#pragma once

#include "hewer/mesh_source.h"
#include "hewer/report.h"
#include "ooc/context.h"

namespace hewer::rsimp {

/// Name, format, counts and attributes; the rest of `input` stays.
void describe_input(const SourceInfo& info, InputReport& input);

/// After the passes, with input.defects and input.triangles: warns of dirt that was left out.
/// Throws FormatError: dirt in strict mode (files refuse it while they are read, other sources only
/// count it), or not one usable triangle.
void judge_findings(ooc::Context& context, const MeshSource& source, bool is_strict,
                    const InputReport& input);

}  // namespace hewer::rsimp
