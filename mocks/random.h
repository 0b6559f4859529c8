/* SPDX-License-Identifier: GPL-3.0-or-later */
/* random.h: Philox4x64-10 (Random123) as a generator for GSL's distributions.
 *
 * A sequence is named by (seed, stream) = the key and (index, item) = half of the counter; the
 * other half counts the draws. Sequences with different names are independent, and starting one
 * costs nothing, so that every galaxy, stamp or pixel has its own, whoever computes it.
 */
#ifndef MOCKS_RANDOM_H
#define MOCKS_RANDOM_H

#include <gsl/gsl_rng.h>
#include <stdint.h>

/* What a sequence is for. The numbers are part of what a seed means: never renumber. */
enum random_stream {
    RANDOM_GALAXY = 1, /* index = galaxy */
    RANDOM_SHIFT,      /* index = stamp, or galaxy where shared */
    RANDOM_PSF_ANGLE,  /* index = PSF */
    RANDOM_SOURCES,    /* astronomical noise of the galaxy stamp; index = stamp from here on */
    RANDOM_SOURCES_N,  /* ... of the noise stamp; likewise below */
    RANDOM_WHITE,
    RANDOM_WHITE_N,
    RANDOM_PHOTONS, /* item = pixel */
    RANDOM_PHOTONS_N
};

typedef struct random_state {
    uint64_t seed, stream, index, item;
    uint64_t block;  /* the next block of the sequence */
    uint64_t out[4]; /* the present one */
    int next;        /* first unused number of out; 4 = none */
} random_state;

/* A generator on the caller's stack: `rng` points into the struct, so do not copy it. */
typedef struct random_sequence {
    gsl_rng rng;
    random_state state;
} random_sequence;

/* Begin the sequence (seed, stream, index, item). */
void random_begin(random_sequence *r, uint64_t seed, int stream, uint64_t index, uint64_t item);
/* Begin another item of the same (seed, stream, index). */
void random_item(random_sequence *r, uint64_t item);

#endif
