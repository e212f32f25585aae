// SPDX-License-Identifier: MIT
/// How much memory a run takes, as a function of counts: docs/memory.md in code.
#pragma once

#include <algorithm>
#include <cstdint>

#include "hewer/mesh_source.h"
#include "hewer/options.h"

namespace hewer::rsimp {

/// The counts that memory depends on. All but the first two are estimates before a run.
struct MemoryCounts {
    std::uint64_t vertices = 0;  ///< of an indexed input; 0 for a soup
    std::uint64_t cells = 0;
    std::uint64_t clusters = 0;                ///< that the edge collapse begins with
    std::uint64_t lod_vertices = 0;            ///< of the largest level of detail
    std::uint64_t triangles_out_of_order = 0;  ///< all of them, or none
    unsigned n_threads = 1;
    Method method = Method::Refine;
    bool has_attributes = false;
    bool has_weights = false;
    bool has_attribute_quadrics = false;
    bool has_fit = false;
    bool has_feedback = false;
    bool joins_parts = false;  ///< --aggregate
};

/// What a run carries beside places; by its options and what the input has.
void count_attributes(const SimplifyOptions& options, const SourceInfo& info, MemoryCounts& counts);

/// Vertices stay in memory while the triangles are read if they take no more than this part of it;
/// else there is a window over them, of another part.
inline constexpr std::uint64_t kResidentShare = 3;
inline constexpr std::uint64_t kWindowShare = 8;
/// While the triangles are read: left to the pages of spools, and to batches of input in flight.
inline constexpr std::uint64_t kSpareShare = 16;
inline constexpr std::uint64_t kSpareBytes = 6 << 20;

/// Of a limit, for what the allocator and the system take on top of what is reserved: page tables,
/// ends of mappings, small pieces on the heap.
constexpr std::uint64_t slack_bytes(std::uint64_t limit) {
    return std::min<std::uint64_t>(limit / 48, 64ULL << 20);
}

/// With less than this a run may fail; with it, it goes through, whatever the rest of the counts:
/// what does not fit waits on disk.
std::uint64_t least_memory_bytes(const MemoryCounts& counts);

/// What simplify() asks for at least, by what is known before any work: whole MiB, so that the
/// number can be typed.
std::uint64_t least_limit(const SimplifyOptions& options, const SourceInfo& info);

/// Refuses a limit that the run would hit later, with one that will do: OutOfMemoryBudget.
void require_memory(const SimplifyOptions& options, const SourceInfo& info);

/// What a run takes when it has all that it can use: nothing goes to disk then.
std::uint64_t ample_memory_bytes(const MemoryCounts& counts, std::uint64_t limit);

/// Whether triangles that are in no order have to be sorted by place, with `limit` bytes of memory.
bool sorts_triangles(const MemoryCounts& counts, std::uint64_t limit);

/// Most temporary disk space at once with `limit` bytes of memory.
std::uint64_t temp_bytes(const MemoryCounts& counts, std::uint64_t limit);

}  // namespace hewer::rsimp
