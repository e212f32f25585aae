// SPDX-License-Identifier: MIT
#pragma once

namespace hewer {

/// "0.1.0"
const char* version();

}  // namespace hewer
