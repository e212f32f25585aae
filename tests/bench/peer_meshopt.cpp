// SPDX-License-Identifier: MIT
/// The peer that the benchmark compares with: meshoptimizer as a whole program. A plain reader, one
/// call of the library, a plain writer, one thread: what a practised programmer would write around
/// it in an afternoon. It must stay decent, or the comparison is worth nothing.
///
///     peer_meshopt simplify|sloppy IN.ply OUT.ply TARGET_TRIANGLES
///
/// Prints one JSON line: seconds of each phase, peak resident memory, triangles in and out.
#include <meshoptimizer.h>
#include <sys/resource.h>

#include <cfloat>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/plain_ply.h"

namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
}

/// Replaces the index buffer by at most `target_triangles` triangles. No error limit, so that the
/// count alone ends the collapse.
void reduce(bench::PlainMesh& mesh, bool is_sloppy, std::size_t target_triangles) {
    const std::size_t n_vertices = mesh.positions.size() / 3;
    // Not a vector: filling 12 bytes a triangle that the library overwrites would be our waste.
    const auto reduced = std::make_unique_for_overwrite<std::uint32_t[]>(mesh.indices.size());
    const std::size_t n_indices =
        is_sloppy ? meshopt_simplifySloppy(reduced.get(), mesh.indices.data(), mesh.indices.size(),
                                           mesh.positions.data(), n_vertices, 3 * sizeof(float),
                                           3 * target_triangles, FLT_MAX, nullptr)
                  : meshopt_simplify(reduced.get(), mesh.indices.data(), mesh.indices.size(),
                                     mesh.positions.data(), n_vertices, 3 * sizeof(float),
                                     3 * target_triangles, FLT_MAX, 0, nullptr);
    mesh.indices.assign(reduced.get(), reduced.get() + n_indices);
}

/// Drops the vertices that no triangle uses any more, in place.
void compact(bench::PlainMesh& mesh) {
    const std::size_t n_used = meshopt_optimizeVertexFetch(
        mesh.positions.data(), mesh.indices.data(), mesh.indices.size(), mesh.positions.data(),
        mesh.positions.size() / 3, 3 * sizeof(float));
    mesh.positions.resize(3 * n_used);
}

int run(const std::string& method, const char* input, const char* output, std::size_t target) {
    const Clock::time_point start = Clock::now();
    bench::PlainMesh mesh = bench::read_plain_ply(input);
    const std::size_t n_triangles_in = mesh.indices.size() / 3;
    const Clock::time_point after_read = Clock::now();
    reduce(mesh, method == "sloppy", target);
    const Clock::time_point after_reduce = Clock::now();
    compact(mesh);
    bench::write_plain_ply(output, mesh);
    const Clock::time_point end = Clock::now();

    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    std::printf(
        "{\"method\": \"%s\", \"triangles_in\": %zu, \"triangles_out\": %zu, "
        "\"read_seconds\": %.3f, \"simplify_seconds\": %.3f, \"write_seconds\": %.3f, "
        "\"total_seconds\": %.3f, \"peak_resident_kib\": %ld}\n",
        method.c_str(), n_triangles_in, mesh.indices.size() / 3, seconds_between(start, after_read),
        seconds_between(after_read, after_reduce), seconds_between(after_reduce, end),
        seconds_between(start, end), usage.ru_maxrss);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string method = argc == 5 ? argv[1] : "";
    const std::size_t target = argc == 5 ? std::strtoull(argv[4], nullptr, 10) : 0;
    if ((method != "simplify" && method != "sloppy") || target == 0) {
        std::fputs("usage: peer_meshopt simplify|sloppy IN.ply OUT.ply TARGET_TRIANGLES\n", stderr);
        return 2;
    }
    try {
        return run(method, argv[2], argv[3], target);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "peer_meshopt: %s\n", error.what());
        return 1;
    }
}
