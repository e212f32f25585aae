// SPDX-License-Identifier: MIT
#include "ooc/io_error.h"

#include <cerrno>
#include <string>
#include <system_error>

#include "hewer/error.h"

namespace hewer::ooc {

void throw_io_error(const std::filesystem::path& path, const char* operation, int error) {
    std::string text =
        path.string() + ": cannot " + operation + ": " + std::generic_category().message(error);
    if (error == ENOSPC || error == EDQUOT) {
        text += "; free some space there or choose another place for the output";
    }
    throw IoError(text);
}

}  // namespace hewer::ooc
