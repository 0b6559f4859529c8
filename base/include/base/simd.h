/* SPDX-License-Identifier: GPL-3.0-or-later */
/* base/simd.h: compile hot loops for several instruction sets.
 *
 * SHEAR_SIMD before a function compiles it for plain x86-64, AVX2 and AVX-512. The loader chooses
 * one (ifunc), so that a package for the baseline uses what the machine has. It is empty on other
 * machines and under sanitizers. */
#pragma once

#include <math.h>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__) &&    \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SHEAR_SIMD                                                                                 \
    __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4"),                   \
                   optimize("fp-contract=off")))
#else
#define SHEAR_SIMD
#endif

/* For a function that must be inlined into the clones that call it: on its own it would be compiled
 * for the baseline. */
#if defined(__GNUC__)
#define SHEAR_INLINE inline __attribute__((always_inline))
#else
#define SHEAR_INLINE inline
#endif

/* glibc has vector versions of exp and log (libmvec, within 4 units in the last place), but
 * declares them only under -ffast-math. Declared here, they are used by `omp simd` loops in IEEE
 * arithmetic, too. */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(_OPENMP) && !defined(__clang__)
#pragma omp declare simd notinbranch
extern double exp(double x);
#pragma omp declare simd notinbranch
extern double log(double x);
#endif
