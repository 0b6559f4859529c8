/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/header.h: parse the structural keywords of one header. */
#pragma once

#include "fits/header/hdu_index.h"

/* One header while it is being read. */
typedef struct sf_header {
    sf_hdu hdu;
    char label[SF_NAME];    /* EXTNAME, known as soon as its block has been read: for messages */
    char xtension[SF_NAME]; /* "" in the primary header */
    bool groups;
    unsigned seen;        /* one bit per keyword of the table that has been read */
    int cards;            /* cards read so far */
    int64_t axes_seen;    /* NAXISn cards read so far */
    int64_t further_axes; /* product of NAXIS4 and beyond; -1 = overflow */
} sf_header;

void sf_header_init(sf_header *h, int number);

/* Find EXTNAME in a block of cards, before they are parsed one by one. */
void sf_header_find_label(sf_header *h, const char *block);

/* Parse the next card. SHEAR_E_FORMAT for a structural keyword that has the wrong type, is
 * repeated, or is not where FITS requires it. */
int sf_header_card(sf_header *h, const char *card, const char *file, shear_error *err);

/* Check the header after END, and fill in kind and data_bytes. SHEAR_E_FORMAT. */
int sf_header_end(sf_header *h, const char *file, shear_error *err);

/* Format the HDU's label into `out`: "GALAXY", or "3 (from 0)" if it has no name. Return out. */
const char *sf_header_label(const sf_header *h, char out[SF_NAME]);
