// SPDX-License-Identifier: MIT
#include "app/path_checks.h"

#include <string>
#include <system_error>

#include "hewer/error.h"

namespace hewer::app {

namespace {

namespace fs = std::filesystem;

bool is_same_file(const fs::path& a, const fs::path& b) {
    std::error_code code;
    if (fs::equivalent(a, b, code)) return true;
    // One of them is not there yet: compare the names that they would have.
    const fs::path full_a = fs::weakly_canonical(fs::absolute(a, code), code);
    const fs::path full_b = fs::weakly_canonical(fs::absolute(b, code), code);
    return !full_a.empty() && full_a == full_b;
}

void check_place(const PlannedOutput& output, bool force) {
    const std::string name = output.path.string();
    std::error_code code;
    const fs::path folder = output.path.has_parent_path() ? output.path.parent_path() : ".";
    if (!fs::is_directory(folder, code)) {
        throw InvalidArgument(name + ": the folder " + folder.string() + " does not exist");
    }
    if (fs::is_directory(output.path, code)) throw InvalidArgument(name + ": is a folder");
    if (fs::exists(output.path, code) && !fs::is_regular_file(output.path, code)) {
        throw InvalidArgument(name + ": is a device or a pipe; outputs are ordinary files");
    }
    if (!force && fs::exists(output.path, code)) {
        throw InvalidArgument(name + ": exists already; use --force to replace it");
    }
}

}  // namespace

void check_outputs(const std::vector<fs::path>& inputs, const std::vector<PlannedOutput>& outputs,
                   bool force) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        for (const fs::path& input : inputs) {
            if (is_same_file(outputs[i].path, input)) {
                throw InvalidArgument(outputs[i].path.string() + ": the " +
                                      std::string(outputs[i].what) + " would replace the input");
            }
        }
        for (std::size_t k = 0; k < i; ++k) {
            if (is_same_file(outputs[i].path, outputs[k].path)) {
                throw InvalidArgument(outputs[i].path.string() + ": the " +
                                      std::string(outputs[i].what) + " would replace the " +
                                      std::string(outputs[k].what));
            }
        }
    }
    for (const PlannedOutput& output : outputs) check_place(output, force);
}

}  // namespace hewer::app
