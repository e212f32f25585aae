// SPDX-License-Identifier: MIT
/// Reports as JSON: the fields of the report structs under their own names, bytes as numbers,
/// enumerators in lower case, infinite and NaN numbers as null.
#pragma once

#include <optional>
#include <string>

#include "app/arguments.h"
#include "hewer/measure.h"
#include "hewer/plan.h"
#include "hewer/report.h"
#include "hewer/within.h"

namespace hewer::app {

/// What was asked of prove_within(), and what it said.
struct Proof {
    double distance = 0;
    WithinReport report;
};

/// "options" holds every option of the command under the option table's keys; what the run filled
/// in (memory, threads, temp_dir) stands there too.
std::string to_json(const SimplifyReport& report, const Arguments& arguments);
std::string to_json(const MeasureReport& report, const std::optional<Proof>& proof,
                    const Arguments& arguments);
std::string to_json(const InputReport& report);
std::string to_json(const PlanReport& report, const Arguments& arguments);

}  // namespace hewer::app
