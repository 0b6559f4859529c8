/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The figure for a result catalog. */
#include "plot/plot.h"

#include "base/cleanup.h"
#include "plot/text.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 1280, HEIGHT = 840, BINS = 48, MAX_BARS = SHEAR_N_FLAGS + 1 };

/* The numbers of one column, without flagged rows. */
typedef struct column_values {
    size_t n;
    double *values;
} column_values;

/* Return the weighted mean of D, the unit of N_i. */
static double mean_d(const shear_catalog_table *t) {
    double sum_w = 0.0;
    double sum_d = 0.0;
    for (int64_t i = 0; i < t->n; i++) {
        const shear_row *row = &t->rows[i];
        if (row->flags == 0) {
            const double w = isnan(row->weight) ? 1.0 : row->weight; /* no column WEIGHT */
            sum_w += w;
            sum_d += w * row->d;
        }
    }
    return sum_d / sum_w;
}

/* Set the column to the finite values of a double of each row, given its offset, over `unit`. */
static void collect(column_values *c, const shear_catalog_table *t, size_t member, double unit) {
    c->n = 0;
    for (int64_t i = 0; i < t->n; i++) {
        const double value = *(const double *)(const void *)((const char *)&t->rows[i] + member);
        if (t->rows[i].flags == 0 && isfinite(value))
            c->values[c->n++] = value / unit;
    }
}

/* Draw empty axes that contain the reason. */
static void draw_nothing(shear_figure *f, shear_rect cell, const char *title, const char *why) {
    const shear_axes axes = {
        .cell = cell, .title = title, .x = {.bare = true}, .y = {.bare = true}};
    shear_axes_begin(f, &axes);
    shear_axes_text(f, 0.5, 0.5, true, why, &(shear_text_style){.align = 0.5});
    shear_axes_end(f);
}

/* Return the number of bins: about the square root of the number of values. */
static int bins_for(size_t n) {
    return (int)fmin(fmax(2.0 * sqrt((double)n), 8.0), BINS);
}

static void mark_shear(shear_figure *f, const shear_catalog_table *t, bool second) {
    const double g = second ? t->result.g2 : t->result.g1;
    const double error = second ? t->result.g2_err : t->result.g1_err;
    const shear_colour colour = shear_palette(SHEAR_VERMILION);
    shear_axes_vband(f, g - error, g + error, &(shear_style){.colour = colour, .fill = 0.3});
    shear_axes_vline(f, g, &(shear_style){.colour = colour, .label = "measured"});
    if (t->has_truth) {
        const double truth = second ? t->sim_g2 : t->sim_g1;
        shear_axes_vline(f, truth, &(shear_style){.dash = SHEAR_DASHED, .label = "truth"});
    }
}

/* Write "g_1 = -0.0285 +- 0.0008" into `title`. */
static void shear_title(char title[PLOT_CELL], const shear_result *r, bool second) {
    plot_print(title, PLOT_CELL, "g_{%d} = %.5f \xc2\xb1 %.5f", second ? 2 : 1,
               second ? r->g2 : r->g1, second ? r->g2_err : r->g1_err);
}

/* Set the range to five robust sigmas around the median, limited to the values: a few outliers must
 * not compress the rest. */
static int robust_range(shear_range *r, const column_values *c, shear_error *err) {
    shear_range inner;
    const int code = shear_range_percentile(&inner, c->values, c->n, 15.87, 84.13, err);
    const shear_range all = shear_range_of(c->values, c->n);
    const double middle = 0.5 * (inner.lo + inner.hi);
    const double sigma = 0.5 * (inner.hi - inner.lo);
    r->lo = fmax(middle - 5.0 * sigma, all.lo);
    r->hi = fmin(middle + 5.0 * sigma, all.hi);
    *r = shear_range_pad(*r, 0.02);
    return code;
}

/* Begin axes and draw the histogram of the column over `r`; the y axis extends to `head` times the
 * highest bar. */
static void begin_histogram(shear_figure *f, shear_axes axes, const column_values *c, shear_range r,
                            double head, int hue) {
    double counts[BINS];
    const int bins = bins_for(c->n);
    const size_t beyond = shear_histogram(counts, bins, r, c->values, c->n);
    const double top = shear_range_of(counts, (size_t)bins).hi;
    axes.x.range = r;
    axes.y.range = (shear_range){0.0, head * fmax(top, 1.0)};
    axes.y.label = "stamps";
    shear_axes_begin(f, &axes);
    shear_axes_histogram(f, bins, r, counts,
                         &(shear_style){.colour = shear_palette((int)hue), .fill = 0.2});
    if (beyond > 0) {
        char text[32];
        snprintf(text, sizeof text, "%zu beyond", beyond);
        shear_axes_text(f, 0.96, 0.83, true, text, &(shear_text_style){.size = 10.5, .align = 1.0});
    }
}

static int draw_terms(shear_figure *f, shear_rect cell, const shear_catalog_table *t, bool second,
                      column_values *c, shear_error *err) {
    char title[PLOT_CELL];
    char label[PLOT_CELL];
    shear_range r;
    collect(c, t, second ? offsetof(shear_row, n2) : offsetof(shear_row, n1), mean_d(t));
    TRY(robust_range(&r, c, err));
    snprintf(label, sizeof label,
             "N_{%d} / \xe2\x9f\xa8"
             "D\xe2\x9f\xa9",
             second ? 2 : 1);
    shear_title(title, &t->result, second);
    begin_histogram(f, (shear_axes){.cell = cell, .title = title, .x = {.label = label}}, c, r,
                    1.35, SHEAR_BLUE);
    mark_shear(f, t, second);
    shear_axes_end(f);
    return SHEAR_OK;
}

/* Return half the span of both axes, the same so that the ellipse keeps its shape; it includes two
 * sigma and the truth. */
static double plane_reach(const shear_catalog_table *t) {
    const shear_result *r = &t->result;
    double reach = 2.0 * fmax(r->g1_err, r->g2_err);
    if (t->has_truth)
        reach = fmax(reach, fmax(fabs(t->sim_g1 - r->g1), fabs(t->sim_g2 - r->g2)));
    return reach > 0.0 ? 1.7 * reach : 1e-4;
}

static void draw_plane(shear_figure *f, shear_rect cell, const shear_catalog_table *t) {
    const shear_result *r = &t->result;
    const double cov[3] = {r->g1_err * r->g1_err, r->cov12, r->g2_err * r->g2_err};
    const double reach = plane_reach(t);
    const shear_colour blue = shear_palette(SHEAR_BLUE);
    const shear_axes axes = {.cell = cell,
                             .title = "shear of the field",
                             .equal = true,
                             .x = {.range = {r->g1 - reach, r->g1 + reach}, .label = "g_{1}"},
                             .y = {.range = {r->g2 - reach, r->g2 + reach}, .label = "g_{2}"}};
    shear_axes_begin(f, &axes);
    shear_axes_ellipse(f, r->g1, r->g2, cov, 2.0,
                       &(shear_style){.colour = blue, .fill = 0.12, .label = "2\xcf\x83"});
    shear_axes_ellipse(f, r->g1, r->g2, cov, 1.0,
                       &(shear_style){.colour = blue, .fill = 0.30, .label = "1\xcf\x83"});
    shear_axes_points(f, 1, &r->g1, &r->g2, NULL, NULL,
                      &(shear_style){.colour = blue, .size = 5.0, .label = "measured"});
    if (t->has_truth) {
        shear_axes_points(f, 1, &t->sim_g1, &t->sim_g2, NULL, NULL,
                          &(shear_style){.colour = shear_palette(SHEAR_VERMILION),
                                         .marker = SHEAR_CROSS,
                                         .size = 10.0,
                                         .width = 2.0,
                                         .label = "truth"});
    }
    shear_axes_end(f);
}

/* Write the flag's name with spaces into `name`. */
static void flag_words(char name[PLOT_CELL], int bit) {
    snprintf(name, PLOT_CELL, "%s", shear_flag_name(bit));
    for (char *p = name; *p != '\0'; p++) {
        if (*p == '_')
            *p = ' ';
    }
}

typedef struct flag_bars {
    int n;
    int64_t counts[MAX_BARS];
    char words[MAX_BARS][PLOT_CELL];
    const char *names[MAX_BARS];
} flag_bars;

/* Collect the bars from the bottom up: the flags that occur, then the used stamps. */
static void collect_bars(flag_bars *b, const shear_catalog_table *t) {
    int64_t counts[SHEAR_N_FLAGS + 1] = {0}; /* the last: no flag */
    for (int64_t i = 0; i < t->n; i++) {
        for (int bit = 0; bit < SHEAR_N_FLAGS; bit++)
            counts[bit] += t->rows[i].flags >> bit & 1;
        counts[SHEAR_N_FLAGS] += t->rows[i].flags == 0;
    }
    b->n = 0;
    for (int bit = SHEAR_N_FLAGS - 1; bit >= 0; bit--) {
        if (counts[bit] > 0) {
            flag_words(b->words[b->n], bit);
            b->counts[b->n++] = counts[bit];
        }
    }
    snprintf(b->words[b->n], PLOT_CELL, "used");
    b->counts[b->n++] = counts[SHEAR_N_FLAGS];
    for (int i = 0; i < b->n; i++)
        b->names[i] = b->words[i];
}

static void draw_flags(shear_figure *f, shear_rect cell, const shear_catalog_table *t) {
    flag_bars b;
    collect_bars(&b, t);
    const double most = fmax((double)t->n, 1.0);
    const shear_axes axes = {
        .cell = cell,
        .title = b.n > 1 ? "stamps used, and left out by flag" : "stamps: all are used",
        .x = {.range = {0.0, 1.2 * most}, .label = "stamps"},
        .y = {.range = {fmin(-0.7, b.n - 4.3), b.n - 0.3}, .n_names = b.n, .names = b.names}};
    shear_axes_begin(f, &axes);
    for (int i = 0; i < b.n; i++) {
        char text[32];
        const int hue = i == b.n - 1 ? SHEAR_BLUE : SHEAR_VERMILION;
        shear_axes_bar(f, true, i, 0.56, 0.0, (double)b.counts[i],
                       &(shear_style){.colour = shear_palette((int)hue), .fill = 0.7});
        snprintf(text, sizeof text, "%" PRId64, b.counts[i]);
        shear_axes_text(f, (double)b.counts[i] + 0.015 * most, i, false, text,
                        &(shear_text_style){.size = 10.5});
    }
    shear_axes_end(f);
}

static int draw_snr(shear_figure *f, shear_rect cell, const shear_catalog_table *t,
                    column_values *c, shear_error *err) {
    const shear_axes axes = {.cell = cell,
                             .title = "signal to noise of the stamps",
                             .x = {.label = "S/N = flux / \xcf\x83(flux)"}};
    char text[PLOT_CELL];
    shear_range r;
    shear_range median;
    collect(c, t, offsetof(shear_row, snr), 1.0);
    if (c->n == 0) {
        draw_nothing(f, cell, axes.title, "no noise: it has no S/N");
        return SHEAR_OK;
    }
    TRY(shear_range_percentile(&median, c->values, c->n, 50.0, 50.0, err));
    TRY(robust_range(&r, c, err));
    if (shear_range_of(c->values, c->n).lo >= 0.0) {
        r.lo = fmax(r.lo, 0.0); /* no values are below */
    }
    begin_histogram(f, axes, c, r, 1.25, SHEAR_GREEN);
    plot_print(text, sizeof text, "median %.3g", median.lo);
    shear_axes_vline(f, median.lo, &(shear_style){.dash = SHEAR_DASHED, .label = text});
    shear_axes_end(f);
    return SHEAR_OK;
}

static void add_component(plot_table *table, const char *key, double g, double error,
                          bool has_truth, double truth) {
    plot_table_add(table, key, "%.5f \xc2\xb1 %.5f", g, error);
    if (has_truth)
        plot_table_add(table, "", "truth %.5f, pull %+.2f", truth, (g - truth) / error);
}

static void draw_summary(shear_figure *f, shear_rect cell, const shear_catalog_table *t) {
    const shear_result *r = &t->result;
    plot_table table = {0};
    plot_table_add(&table, "field", "%s", t->field);
    plot_table_add(&table, "stamps", "%" PRId64 ", %" PRId64 " used", r->n_stamps, r->n_used);
    if (r->valid) {
        add_component(&table, "g_{1}", r->g1, r->g1_err, t->has_truth, t->sim_g1);
        add_component(&table, "g_{2}", r->g2, r->g2_err, t->has_truth, t->sim_g2);
        plot_table_add(&table, "correlation", "%.2f", r->cov12 / (r->g1_err * r->g2_err));
        if (r->jackknife != 0) {
            plot_table_add(&table, "errors", "jackknife, %d groups", r->jackknife);
        } else {
            plot_table_add(&table, "errors", "%s", shear_error_method(r));
        }
        plot_table_add(&table, "estimator", "%s", shear_estimator_name(r->estimator));
    }
    if (isfinite(t->r_psf_px))
        plot_table_add(&table, "R_{PSF}", "%.3f px", t->r_psf_px);
    if (isfinite(t->beta_px))
        plot_table_add(&table, "\xce\xb2", "%.3f px", t->beta_px);
    cell.x += 24.0;
    plot_table_draw(&table, f, cell, "Result");
}

/* Draw the panels that need a shear, or the reason why there is none. */
static int draw_shear(shear_figure *f, const shear_grid *grid, const shear_catalog_table *t,
                      column_values *c, shear_error *err) {
    static const char *const titles[] = {"first component", "second component",
                                         "shear of the field"};
    if (!t->result.valid) {
        for (int i = 0; i < 3; i++) {
            draw_nothing(f, shear_grid_cell(grid, 0, i, 1, 1), titles[i],
                         "fewer than two usable stamps: no shear");
        }
        return SHEAR_OK;
    }
    for (int i = 0; i < 2; i++)
        TRY(draw_terms(f, shear_grid_cell(grid, 0, i, 1, 1), t, i == 1, c, err));
    draw_plane(f, shear_grid_cell(grid, 0, 2, 1, 1), t);
    return SHEAR_OK;
}

static int draw_panels(shear_figure *f, const shear_catalog_table *t, column_values *c,
                       shear_error *err) {
    const shear_grid grid = {.area = {14.0, 12.0, WIDTH - 28.0, HEIGHT - 24.0},
                             .rows = 2,
                             .columns = 3,
                             .gap_x = 18.0,
                             .gap_y = 22.0};
    TRY(draw_shear(f, &grid, t, c, err));
    draw_flags(f, shear_grid_cell(&grid, 1, 0, 1, 1), t);
    draw_summary(f, shear_grid_cell(&grid, 1, 2, 1, 1), t);
    return draw_snr(f, shear_grid_cell(&grid, 1, 1, 1, 1), t, c, err);
}

int plot_catalog(shear_figure **figure, const shear_catalog_table *table, shear_error *err) {
    const size_t n = table->n > 0 ? (size_t)table->n : 1;
    CLEANUP(release_free) double *values = calloc(n, sizeof *values);
    CLEANUP(shear_figure_release) shear_figure *f = NULL;
    column_values column = {.values = values};
    *figure = NULL;
    if (values == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "no memory for %" PRId64 " rows", table->n);
    TRY(shear_figure_new(&f, WIDTH, HEIGHT, err));
    int code = draw_panels(f, table, &column, err);
    *figure = code == SHEAR_OK ? CLEANUP_TAKE(f) : NULL;
    return code;
}
