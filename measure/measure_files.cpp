// SPDX-License-Identifier: MIT
#include <memory>

#include "hewer/measure.h"
#include "hewer/mesh_source.h"

namespace hewer {

MeasureReport measure_files(const std::filesystem::path& original,
                            const std::filesystem::path& simplified, const MeasureOptions& options,
                            const Hooks& hooks) {
    const std::unique_ptr<MeshSource> from = open_mesh(original);
    const std::unique_ptr<MeshSource> to = open_mesh(simplified);
    return measure(*from, *to, options, hooks);
}

}  // namespace hewer
