// SPDX-License-Identifier: MIT
#include "hewer/cleanup.h"

#include "ooc/pending_file.h"

namespace hewer {

void remove_temporary_files() noexcept {
    ooc::remove_temporary_outputs();
}

}  // namespace hewer
