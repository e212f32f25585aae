// SPDX-License-Identifier: MIT
/// Reports on disk, under the same promises as meshes.
#pragma once

#include <filesystem>
#include <string>

namespace hewer {

/// Writes `text` to a file that appears whole or not at all. An old file is replaced only if
/// `overwrite`, and untouched if the writing fails.
/// Throws: IoError.
void write_text_file(const std::filesystem::path& path, const std::string& text,
                     bool overwrite = false);

}  // namespace hewer
