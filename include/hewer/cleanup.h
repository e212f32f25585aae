// SPDX-License-Identifier: MIT
/// For programs that must end at once.
#pragma once

namespace hewer {

/// Removes the temporary files of all outputs that are being written. For a signal handler whose
/// next step is _exit(): async-signal-safe, and the runs that own the files must not go on.
void remove_temporary_files() noexcept;

}  // namespace hewer
