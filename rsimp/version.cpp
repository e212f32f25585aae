// SPDX-License-Identifier: MIT
#include "hewer/version.h"

namespace hewer {

const char* version() {
    return HEWER_VERSION;
}

}  // namespace hewer
