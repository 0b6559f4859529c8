/* SPDX-License-Identifier: GPL-3.0-or-later */
/* random.h: Philox4x64-10 (Random123) as a generator for GSL's distributions.
 *
 * The key (seed, stream) and one half of the counter, (index, item), identify a sequence; the other
 * half counts the numbers drawn. Sequences of different identity are independent, and starting one
 * takes no time. So every galaxy, stamp and pixel has its own sequence, independent of threads. */
#pragma once

#include <gsl/gsl_rng.h>
#include <stdint.h>

/* The purpose of a sequence. The meaning of a seed depends on these numbers: never renumber. */
enum random_stream {
    RANDOM_GALAXY = 1, /* index = galaxy */
    RANDOM_SHIFT,      /* index = stamp, or galaxy if shared */
    RANDOM_PSF_ANGLE,  /* index = PSF */
    RANDOM_SOURCES,    /* astronomical noise of the galaxy stamp; index = stamp from here on */
    RANDOM_SOURCES_N,  /* ... of the noise stamp; the same below */
    RANDOM_WHITE,
    RANDOM_WHITE_N,
    RANDOM_PHOTONS, /* item = pixel */
    RANDOM_PHOTONS_N,
    RANDOM_EXPOSURE_PLACE, /* index = chip and object, as the next two */
    RANDOM_EXPOSURE_GALAXY,
    RANDOM_EXPOSURE_STAR,
    RANDOM_EXPOSURE_NOISE, /* index = chip from here on; item = row */
    RANDOM_EXPOSURE_COLUMNS,
    RANDOM_EXPOSURE_COSMICS
};

typedef struct random_state {
    uint64_t seed, stream, index, item;
    uint64_t block;  /* the next block of the sequence */
    uint64_t out[4]; /* the current block */
    int next;        /* first unused number of out; 4: none */
} random_state;

/* A generator on the caller's stack. `rng` points into the struct: do not copy it. */
typedef struct random_sequence {
    gsl_rng rng;
    random_state state;
} random_sequence;

/* Start the sequence (seed, stream, index, item). */
void random_begin(random_sequence *r, uint64_t seed, int stream, uint64_t index, uint64_t item);
/* Start another item of the same (seed, stream, index). */
void random_item(random_sequence *r, uint64_t item);
