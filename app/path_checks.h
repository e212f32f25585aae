// SPDX-License-Identifier: MIT
/// What can be told about outputs before any work.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace hewer::app {

/// A file that the command will write.
struct PlannedOutput {
    std::filesystem::path path;
    std::string_view what;  ///< for messages: "output", "report"
};

/// Throws InvalidArgument: an output is one of the inputs, two outputs are one file, a folder is
/// missing, or a file is there and `force` is false.
void check_outputs(const std::vector<std::filesystem::path>& inputs,
                   const std::vector<PlannedOutput>& outputs, bool force);

}  // namespace hewer::app
