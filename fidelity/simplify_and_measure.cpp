// SPDX-License-Identifier: MIT
#include <memory>

#include "hewer/certify.h"
#include "hewer/error.h"
#include "hewer/measure.h"
#include "hewer/simplify.h"

namespace hewer {

SimplifyReport simplify_and_measure(const InputPaths& input, const std::filesystem::path& output,
                                    const SimplifyOptions& options, const Hooks& hooks,
                                    bool overwrite) {
    const std::unique_ptr<MeshSource> source = open_mesh(input, opening(options), hooks);
    SimplifyReport report = simplify_to_files(*source, output, options, hooks, overwrite);
    MeasureOptions how;
    how.memory_bytes = options.memory_bytes;
    how.n_threads = options.n_threads;
    how.temp_dir = options.temp_dir;
    how.max_temp_bytes = options.max_temp_bytes;
    for (LodReport& lod : report.lods) {
        const std::unique_ptr<MeshSource> level = open_mesh(lod.path, opening(how));
        lod.measured = measure(*source, *level, how, hooks);
        report.seconds += lod.measured->seconds;
    }
    return report;
}

}  // namespace hewer
