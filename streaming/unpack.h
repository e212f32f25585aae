// SPDX-License-Identifier: MIT
/// Compressed files and pipes as files that can be read at any place.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>

#include "hewer/mesh_source.h"
#include "ooc/file.h"

namespace hewer::streaming {

constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();

/// Decompresses a gzip file (all of its members) to a temporary file, through zlib; ends when there
/// are `wanted_bytes`. One thread.
/// Memory: 1.1 MiB. Throws: FormatError (damaged, cut short: path and byte), OutOfDiskBudget,
/// IoError, Cancelled.
std::unique_ptr<ooc::InputFile> unpack_gzip(const ooc::InputFile& file, const OpenOptions& options,
                                            const Hooks& hooks, std::uint64_t wanted_bytes = kAll);

/// The same for Zstandard (all of its frames), through libzstd. Memory: 1.1 MiB and the window that
/// a frame asks for, 8 MiB most often; OutOfMemoryBudget names it if the limit is too small.
std::unique_ptr<ooc::InputFile> unpack_zstd(const ooc::InputFile& file, const OpenOptions& options,
                                            const Hooks& hooks, std::uint64_t wanted_bytes = kAll);

/// Reads a pipe, or whatever else cannot be read at any place, to a temporary file.
/// @param path  as it can be opened; "-": standard input.
std::unique_ptr<ooc::InputFile> spool_pipe(const std::filesystem::path& path,
                                           const OpenOptions& options, const Hooks& hooks);

/// Whether `path` is such a thing: "-", a pipe, a socket or a device. A regular file behind
/// standard input is none: open it as /dev/stdin.
bool is_pipe(const std::filesystem::path& path);

}  // namespace hewer::streaming
