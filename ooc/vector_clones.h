// SPDX-License-Identifier: MIT
/// Kernels for wider vectors than the least machine has.
#pragma once

/// A function so marked is compiled for AVX2 too and chosen at start-up; what it inlines is
/// compiled with it. Without fused multiply-add both give the same bits. Sanitizers do not get
/// along with such choices.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define HEWER_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define HEWER_VECTOR_CLONES
#endif

/// For what a marked function calls: else it would be compiled for the least machine.
#define HEWER_INLINE inline __attribute__((always_inline))
