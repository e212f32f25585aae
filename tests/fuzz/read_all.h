// SPDX-License-Identifier: MIT
/// What a hostile file must survive: being read to its end, twice, or being refused.
#pragma once

#include <filesystem>
#include <string>

#include "hewer/error.h"
#include "hewer/info.h"
#include "hewer/mesh_source.h"

namespace hewer::fuzz {

/// What info() tells without reading the file through, or a refusal. The same limits as below.
inline void glance_at(const std::filesystem::path& path, const std::string& format) {
    InfoOptions options;
    options.whole_below = 0;
    options.input_format = format;
    options.memory_bytes = 64 << 20;
    options.n_threads = 1;
    options.max_temp_bytes = 64 << 20;
    try {
        (void)info(path, options);
    } catch (const InternalError&) {
        throw;
    } catch (const Error&) {
        // A clear refusal is what is asked for.
    }
}

/// Inside limits that a small file has no reason to reach. Returns whether the file was read.
inline bool read_all(const std::filesystem::path& path, const std::string& format, bool is_strict) {
    glance_at(path, format);
    try {
        const auto source = open_mesh(path, {.strict = is_strict,
                                             .format = format,
                                             .memory_bytes = 64 << 20,
                                             .n_threads = 1,
                                             .max_temp_bytes = 64 << 20});
        VertexBatch vertices;
        TriangleBatch triangles;
        for (int pass = 0; pass < 2; ++pass) {
            if (source->info().is_indexed) {
                source->begin_vertices();
                while (source->next_vertices(vertices)) {
                }
            }
            source->begin_triangles();
            while (source->next_triangles(triangles)) {
                for (const Triangle& t : triangles.corners) {
                    for (const std::uint64_t v : t) {
                        if (v >= source->info().n_vertices) throw InternalError("no such vertex");
                    }
                }
            }
        }
        return true;
    } catch (const InternalError&) {
        throw;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace hewer::fuzz
