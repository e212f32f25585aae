// SPDX-License-Identifier: MIT
/// Numbers in messages.
#pragma once

#include "hewer/units.h"

namespace hewer::ooc {

using hewer::format_bytes;
using hewer::format_count;

}  // namespace hewer::ooc
