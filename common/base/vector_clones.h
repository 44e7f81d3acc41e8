// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Before a function whose loops gcc vectorises: compiled also for AVX2 and AVX-512, the best that the processor has is
/// chosen when the program starts. Nothing in them may depend on the order of floating-point operations. Sanitizers
/// cannot bear the choosing, and clang 14 has it not; there it is the plain function.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define CYCLORAMA_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define CYCLORAMA_VECTOR_CLONES
#endif
