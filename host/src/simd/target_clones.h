// Compiling a function once for each instruction set.
#pragma once

// Chosen when the program starts. The bytes do not change: none of these sets brings fused multiply-add to
// the compiler's mind (-ffp-contract=off), and lanes do not mix. Sanitizers run before the choice can be
// made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define VKMESH_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define VKMESH_CLONES
#endif

// The same with all that it calls inlined, which is what a loop of large functions needs to fill vector
// registers.
#if defined(__GNUC__)
#define VKMESH_FLAT_CLONES __attribute__((flatten)) VKMESH_CLONES
#else
#define VKMESH_FLAT_CLONES VKMESH_CLONES
#endif
