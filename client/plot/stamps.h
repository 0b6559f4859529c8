/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stamps.h: the stamps of a sheet: their selection, and the intermediate results of each. */
#pragma once

#include "plot/plot.h"
#include "shear/plan.h"

/* A field file opened for measuring single stamps. */
typedef struct stamp_reader {
    shear_field *field; /* borrowed */
    const shear_field_info *info;
    shear_plan *plan;
    const shear_plan_info *chosen; /* the plan's parameters */
    shear_workspace *ws;
    shear_block *block; /* of one stamp pair, the one that was read last */
} stamp_reader;

/* Prepare to read stamps of `field`, which must outlive the reader. Returns SHEAR_OK or an error
 * code. */
int stamp_reader_init(stamp_reader *b, shear_field *field, const shear_settings *settings,
                      shear_error *err);
void stamp_reader_deinit(stamp_reader *b);

/* Set the indices of the stamps that the options select, and *n to their number, at least 1. If no
 * stamp of the file is usable, one unusable stamp is selected. */
int stamp_reader_choose(stamp_reader *b, const plot_options *options,
                        int64_t index[PLOT_MAX_STAMPS], int *n, shear_error *err);

/* One stamp. Pointers into the reader's block are valid until the next stamp is read. */
typedef struct sheet_stamp {
    int64_t index;
    shear_row row;
    const double *galaxy, *noise; /* [ny][nx] */
    bool measured;                /* row.flags is 0, and `steps` is valid */
    shear_inspection steps;
} sheet_stamp;
int stamp_reader_read(stamp_reader *b, int64_t index, sheet_stamp *stamp, shear_error *err);
void sheet_stamp_deinit(sheet_stamp *stamp);

/* The PSF of a stamp. */
typedef struct sheet_psf {
    int nx, ny;
    double step;    /* between samples: pixels, or radians per pixel */
    bool power;     /* the samples are |W|^2, at modes */
    double *pixels; /* [ny][nx], owned */
} sheet_psf;
/* Make the PSF of the stamp that was read last. Call sheet_psf_deinit after an error, too. */
int stamp_reader_psf(sheet_psf *psf, const stamp_reader *b, shear_error *err);
void sheet_psf_deinit(sheet_psf *psf);
