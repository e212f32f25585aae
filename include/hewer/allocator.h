// SPDX-License-Identifier: MIT
/// What the C library's allocator may keep of freed memory, in a process of yours.
#pragma once

#include <cstdint>

namespace hewer {

/// The memory limit counts resident pages, and left alone glibc learns to keep ever larger pieces
/// on every thread's heap: call this once, before the first simplify() or measure(), in a process
/// whose memory is limited. It changes mallopt() for the whole process, so the library never calls
/// it by itself; the program does.
///
/// `memory_bytes` and `n_threads` as in SimplifyOptions. Each thread's heap keeps at most 512 KiB
/// to 8 MiB of what is freed, all of them together a 128th of the limit; what is larger than half
/// of that goes back to the system at once. Where page faults are dear, keeping 8 MiB instead of
/// 512 KiB saves a sixth of the time of the default method (12 M triangles to 200 k).
void tune_allocator(std::uint64_t memory_bytes = 0, unsigned n_threads = 0);

}  // namespace hewer
