// SPDX-License-Identifier: MIT
/// Which files a user's words for an input stand for.
#include <glob.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <system_error>

#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "ooc/io_error.h"
#include "streaming/file_format.h"

namespace hewer {

namespace {

using Paths = std::vector<std::filesystem::path>;

Paths files_in(const std::filesystem::path& folder) {
    Paths files;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
        if (entry.is_regular_file() && streaming::has_mesh_extension(entry.path())) {
            files.push_back(entry.path());
        }
    }
    if (error) throw IoError(folder.string() + ": cannot read the folder: " + error.message());
    if (files.empty()) {
        throw IoError(folder.string() +
                      ": is a folder without a mesh file (.ply, .stl, .obj, ...)");
    }
    std::sort(files.begin(), files.end());
    return files;
}

Paths files_like(const std::filesystem::path& pattern) {
    struct Found {
        glob_t list{};
        ~Found() { ::globfree(&list); }
    } found;
    const int result = ::glob(pattern.c_str(), 0, nullptr, &found.list);
    if (result == GLOB_NOMATCH) throw IoError(pattern.string() + ": no file has a name like this");
    if (result != 0) ooc::throw_io_error(pattern, "search", ENOMEM);
    return {found.list.gl_pathv, found.list.gl_pathv + found.list.gl_pathc};
}

}  // namespace

std::vector<std::filesystem::path> list_files(const InputPaths& inputs) {
    Paths files;
    for (const std::filesystem::path& path : inputs.paths) {
        std::error_code ignored;
        if (std::filesystem::is_directory(path, ignored)) {
            const Paths several = files_in(path);
            files.insert(files.end(), several.begin(), several.end());
        } else if (path.string().find_first_of("*?[") != std::string::npos &&
                   !std::filesystem::exists(path, ignored)) {
            const Paths several = files_like(path);
            files.insert(files.end(), several.begin(), several.end());
        } else {
            files.push_back(path);
        }
    }
    return files;
}

}  // namespace hewer
