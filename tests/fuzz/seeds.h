/* SPDX-License-Identifier: GPL-3.0-or-later */
/* seeds.h: small good files of every kind, to be spoiled: fields (seeds.c), or the images of
 * exposures (exposure_seeds.c). */
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct fuzz_bytes {
    unsigned char *data; /* malloc'd */
    size_t size;
} fuzz_bytes;

enum { FUZZ_SEEDS = 18 };

/* "rice16", "lossy+front" ... */
const char *fuzz_seed_name(int i);
/* Needs fixture_setup(). */
fuzz_bytes fuzz_seed(int i);
/* Return whether a file can be read; print why not. */
bool fuzz_seed_is_good(const char *path);
