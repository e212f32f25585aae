// SPDX-License-Identifier: MIT
/// Material libraries of OBJ files: what they say of diffuse colour.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "ooc/context.h"
#include "streaming/texture_filter.h"

namespace hewer::streaming {

struct MtlMaterial {
    std::optional<MeanColor> color;  ///< Kd
    std::filesystem::path map;       ///< map_Kd; empty: none
    std::array<double, 2> scale{1, 1};
    std::array<double, 2> offset{0, 0};
    bool is_clamped = false;
    std::string other_map;  ///< the first statement of another map; empty: none
};

/// By name; of materials that are defined twice the first counts.
using MtlLibrary = std::map<std::string, MtlMaterial, std::less<>>;

/// The file that a library or an OBJ means by `name`: backslashes are slashes, quotes around it are
/// left out, relative to `folder`. Absolute paths are those of another machine: the file is looked
/// for beside the library. The result need not exist.
std::filesystem::path find_beside(const std::filesystem::path& folder, std::string name);

/// Adds the materials of `path` to `library`. Statements that say nothing of colour are read over.
/// Memory: the file, at most kMostMtlBytes, reserved while it is read. Throws: IoError;
/// FormatError: a larger file; OutOfMemoryBudget.
void read_mtl(ooc::Context& context, const std::filesystem::path& path, MtlLibrary& library);

constexpr std::uint64_t kMostMtlBytes = 16 << 20;

}  // namespace hewer::streaming
