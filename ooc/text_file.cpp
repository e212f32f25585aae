// SPDX-License-Identifier: MIT
#include "hewer/text_file.h"

#include "ooc/file.h"

namespace hewer {

void write_text_file(const std::filesystem::path& path, const std::string& text, bool overwrite) {
    ooc::OutputFile file(path, overwrite);
    file.write(text);
    file.commit();
}

}  // namespace hewer
