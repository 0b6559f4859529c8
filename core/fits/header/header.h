/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/header.h: parse the structural keywords of one header. */
#pragma once

#include "fits/header/file.h"

/* One header while it is being read. */
typedef struct sf_header {
    sf_hdu hdu;
    const char *file;    /* for messages */
    char label[SF_NAME]; /* for messages: EXTNAME as soon as its block is read, else the number */
    bool named;          /* `label` is EXTNAME */
    char xtension[SF_NAME]; /* "" in the primary header */
    bool groups;
    bool ended;           /* END has been read */
    unsigned seen;        /* one bit per keyword of the table that has been read */
    int cards;            /* cards read so far */
    int64_t axes_seen;    /* NAXISn cards read so far */
    int64_t further_axes; /* product of NAXIS4 and beyond; -1 = overflow */
} sf_header;

/* Begin the header of HDU `number` of the file called `file`. */
void sf_header_init(sf_header *h, int number, const char *file);

/* Parse the next block of cards. SHEAR_E_FORMAT for a structural keyword that has the wrong type,
 * is repeated, or is not where FITS requires it. */
int sf_header_block(sf_header *h, const char *block, shear_error *err);

/* Check the header after END, and fill in kind and data_bytes. SHEAR_E_FORMAT. */
int sf_header_end(sf_header *h, shear_error *err);

/* Return whether FITS has pixels of this BITPIX. */
bool sf_bitpix_is_sound(int64_t bitpix);

/* Return the hash of a header whose blocks before this one have the hash `before`; 0: there is none
 * before. */
uint64_t sf_header_hash(uint64_t before, const char *block);
