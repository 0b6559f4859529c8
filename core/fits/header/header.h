/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fits/header/header.h: the structural keywords of one header. */
#ifndef SHEAR_FITS_HEADER_HEADER_H
#define SHEAR_FITS_HEADER_HEADER_H

#include "fits/header/hdu_index.h"

/* One header while it is being read. */
typedef struct sf_header {
    sf_hdu hdu;
    char label[SF_NAME];    /* EXTNAME, known as soon as its block is: for messages */
    char xtension[SF_NAME]; /* "" in the primary header */
    bool groups;
    unsigned seen;        /* a bit for each keyword that was there */
    int cards;            /* taken in so far */
    int64_t axes_seen;    /* NAXISn cards */
    int64_t further_axes; /* product of NAXIS4 and beyond; -1 = overflow */
} sf_header;

void sf_header_init(sf_header *h, int number);

/* Look for the name in a block of cards, before they are taken in one by one. */
void sf_header_find_label(sf_header *h, const char *block);

/* Take in the next card. SHEAR_E_FORMAT for a structural keyword that is ill-typed, given twice, or
 * not where FITS wants it. */
int sf_header_card(sf_header *h, const char *card, const char *file, shear_error *err);

/* After END: check, and fill in kind and data_bytes. SHEAR_E_FORMAT. */
int sf_header_end(sf_header *h, const char *file, shear_error *err);

/* "GALAXY", or "3 (from 0)" where it has no name; into `out`. */
const char *sf_header_label(const sf_header *h, char out[SF_NAME]);

#endif
