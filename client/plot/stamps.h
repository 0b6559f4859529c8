/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stamps.h: the stamps of a sheet: which ones, and each with the steps of its measurement. */
#ifndef CLIENT_PLOT_STAMPS_H
#define CLIENT_PLOT_STAMPS_H

#include "plot/plot.h"
#include "shear/plan.h"

/* A field file opened for measuring one stamp after the other. */
typedef struct stamp_reader {
    shear_field *field; /* borrowed */
    const shear_field_info *info;
    shear_plan *plan;
    const shear_plan_info *chosen; /* what the plan decided */
    shear_workspace *ws;
    shear_block *block; /* of one stamp pair: the one that was read last */
} stamp_reader;

int stamp_reader_init(stamp_reader *b, shear_field *field, const shear_settings *settings,
                      shear_error *err);
void stamp_reader_deinit(stamp_reader *b);

/* The stamps that the options ask for; *n becomes their number, at least 1. If none of the file is
 * usable, one that is not. */
int stamp_reader_choose(stamp_reader *b, const plot_options *options,
                        int64_t index[PLOT_MAX_STAMPS], int *n, shear_error *err);

/* One stamp. Views go into the reader's block and are good until the next is read. */
typedef struct sheet_stamp {
    int64_t index;
    shear_row row;
    const double *galaxy, *noise; /* [ny][nx] */
    bool measured;                /* row.flags is 0, and `steps` is there */
    shear_inspection steps;
} sheet_stamp;
int stamp_reader_read(stamp_reader *b, int64_t index, sheet_stamp *stamp, shear_error *err);
void sheet_stamp_deinit(sheet_stamp *stamp);

/* The PSF of the stamp that was read last: [psf_ny][psf_nx] in *psf, the caller's to free. */
int stamp_reader_psf(double **psf, const stamp_reader *b, shear_error *err);

#endif
