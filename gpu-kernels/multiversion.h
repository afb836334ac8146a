// SPDX-License-Identifier: Apache-2.0
#pragma once

// Compiles the function that it precedes once for each of these instruction sets; the loader picks
// the best that the processor has. For plain loops that the compiler vectorises. The levels are
// named by features: with names such as "arch=haswell" GCC would ask for that maker's processors.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(WINDHOVER_SANITIZED)
#define WINDHOVER_MULTIVERSION \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define WINDHOVER_MULTIVERSION
#endif
