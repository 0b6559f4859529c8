/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plot.h: the figures of `shearctl plot`. */
#pragma once

#include "base/cleanup.h"
#include "shear/catalog.h"
#include "shear/field.h"
#include "shear/settings.h"
#include "shear_figures/figure.h"

CLEANUP_DEFINE(shear_figure, shear_figure_free)

enum { PLOT_MAX_STAMPS = 12, PLOT_DEFAULT_STAMPS = 4 };

typedef struct plot_options {
    int64_t stamp; /* index of the one stamp to show; -1: n_stamps usable ones, evenly spaced */
    int64_t n_stamps;
    const char *chip;               /* of an exposure: EXTNAME, or number from 1; NULL: the first */
    const shear_settings *settings; /* of the measurement that the sheet shows */
} plot_options;

/* Draw the sheet of a field file: its stamps step by step, its PSF, the plan. *figure is to be
 * freed by the caller, NULL on error. */
int plot_sheet(shear_figure **figure, shear_field *field, const plot_options *options,
               shear_error *err);

/* Draw a chip of an exposure: its pixels, galaxies and PSF. *figure is to be freed by the caller,
 * NULL on error. */
int plot_chip(shear_figure **figure, shear_field *field, const plot_options *options,
              shear_error *err);

/* Draw a result catalog: distributions, the shear with its errors, flags. *figure is to be freed by
 * the caller, NULL on error. */
int plot_catalog(shear_figure **figure, const shear_catalog_table *table, shear_error *err);
