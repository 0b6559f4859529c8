/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/run.h"

#include "engine/must.h"

#include <assert.h>
#include <omp.h>
#include <stdio.h>

static const double margin = 8.0; /* around the panels, pixels */

void run_begin(run *r, const options *o) {
    const experiment *e = o->experiment;
    const int64_t stamps = e->stamps != NULL ? e->stamps(o) : o->galaxies;
    *r = (run){.options = o, .cache = cache_open(o, stamps), .table = table_new(o)};
}

shear_figure *run_figure(run *r, const char *suffix, int width, int height) {
    assert(r->n_figures < RUN_MAX_FIGURES);
    r->suffixes[r->n_figures] = suffix;
    must(shear_figure_new(&r->figures[r->n_figures], width, height, &must_error));
    return r->figures[r->n_figures++];
}

panels run_panels(run *r, const char *suffix, int width, int height, shear_grid grid) {
    grid.area = (shear_rect){margin, margin, width - 2.0 * margin, height - 2.0 * margin};
    return (panels){run_figure(r, suffix, width, height), grid};
}

shear_rect panels_cell(const panels *p, int i) {
    return shear_grid_cell(&p->grid, i / p->grid.columns, i % p->grid.columns, 1, 1);
}

void panels_draw(const panels *p, int i, const chart *c) {
    chart_draw(p->figure, panels_cell(p, i), c);
}

void run_end(run *r) {
    char path[OPTIONS_PATH];
    const options *o = r->options;
    table_meta(r->table, "seconds", "%.0f", cache_seconds(r->cache));
    table_meta(r->table, "threads", "%d", o->threads > 0 ? o->threads : omp_get_max_threads());
    table_print(r->table, stdout);
    table_save(r->table, o);
    printf("wrote %s\n", options_path(o, NULL, "ecsv", path));
    for (int i = 0; i < r->n_figures; i++) {
        options_path(o, r->suffixes[i], "png", path);
        must(shear_figure_save(r->figures[i], path, true, &must_error));
        printf("wrote %s\n", path);
        shear_figure_free(r->figures[i]);
    }
    table_free(r->table);
    cache_close(r->cache);
}
