// SPDX-License-Identifier: MIT
/// The options that simplify and plan share.
#pragma once

#include "app/arguments.h"
#include "hewer/options.h"

namespace hewer::app {

/// Throws InvalidArgument: no target, more than one, or options that contradict each other.
SimplifyOptions make_simplify_options(const Arguments& arguments);

}  // namespace hewer::app
