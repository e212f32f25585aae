// SPDX-License-Identifier: MIT
/// The commands: options in, results on standard output. Each throws what the library throws.
#pragma once

#include <stop_token>

#include "app/arguments.h"
#include "app/exit_code.h"

namespace hewer::app {

void run_simplify(const Arguments& arguments, const std::stop_token& stop);
/// TooFar: --within does not hold.
ExitCode run_measure(const Arguments& arguments, const std::stop_token& stop);
void run_info(const Arguments& arguments, const std::stop_token& stop);
void run_plan(const Arguments& arguments);
void run_generate(const Arguments& arguments, const std::stop_token& stop);
void run_render(const Arguments& arguments, const std::stop_token& stop);

}  // namespace hewer::app
