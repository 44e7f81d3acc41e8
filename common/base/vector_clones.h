// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks a function with loops that gcc vectorises: it is also compiled for AVX2 and AVX-512, and the best version for
/// the processor is chosen when the program starts. The function's result must not depend on the order of
/// floating-point operations. Sanitizers do not support this choice, and clang 14 lacks it; there, only the plain
/// function exists.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define CYCLORAMA_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define CYCLORAMA_VECTOR_CLONES
#endif
