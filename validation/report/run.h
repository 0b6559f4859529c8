/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run.h: one run of an experiment, and its output: a table and figures. */
#pragma once

#include "engine/cache.h"
#include "report/chart.h"
#include "report/table.h"

enum { RUN_MAX_FIGURES = 4 };

typedef struct run {
    const options *options;
    cache *cache;
    table *table;
    int n_figures;
    const char *suffixes[RUN_MAX_FIGURES];
    shear_figure *figures[RUN_MAX_FIGURES];
} run;

/* Open the cache and begin a table. */
void run_begin(run *r, const options *o);

/* Create the figure OUT/NAME.png (suffix NULL) or OUT/NAME-suffix.png, owned by the run. */
shear_figure *run_figure(run *r, const char *suffix, int width, int height);

/* A figure of panels: the grid without its area, and a margin around all. */
typedef struct panels {
    shear_figure *figure;
    shear_grid grid;
} panels;
panels run_panels(run *r, const char *suffix, int width, int height, shear_grid grid);
/* Return cell i, row by row from the top left. */
shear_rect panels_cell(const panels *p, int i);
void panels_draw(const panels *p, int i, const chart *c);

/* Print the table, save it and the figures in the order of their creation, with the run time of all
 * chunks as metadata, and print their paths. Then close and free everything. */
void run_end(run *r);
