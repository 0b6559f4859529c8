/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `efficiency` (beyond the paper): the ratio of means and PDF symmetrization. Their
 * errors are compared with the Cramer-Rao bound, and their bias is measured at low signal-to-noise.
 */
#include "engine/must.h"
#include "experiments/efficiency_fields.h"
#include "experiments/list.h"
#include "report/run.h"

#include <math.h>

static const parameter parameters[] = {
    {"ranges", "1,3,10,30,100", 1, 1e6, MAX_VALUES, "largest flux over the smallest"},
    {"slope", "2.5", 0, 10, 1, "of the fluxes' power law, dn/dF ~ F^-slope"},
    {"snr", "10", 0.1, 1e6, 1, "signal-to-noise of the faintest, where there is noise"},
    {"bias-snr", "5,7,10,20,40", 0.1, 1e6, MAX_VALUES, "of equal galaxies, for the bias"},
    {0}};

static int64_t stamps(const options *o) {
    return 2 * (int64_t)efficiency_fields_count(o) * o->groups;
}

/* ---- table ---- */

static const column columns[] = {
    {"flux_range", TABLE_NUMBER, 0, .help = "largest flux over the smallest"},
    {"snr", TABLE_NUMBER, 0, .help = "signal-to-noise of the faintest; nan = no noise"},
    {"estimator", TABLE_TEXT, 0, .help = "mean, pdf-sym, or pdf-sym-cross"},
    {"error", TABLE_NUMBER, 4, .help = "scatter of the fields times sqrt(galaxies)",
     .with_error = true},
    {"quoted", TABLE_NUMBER, 4, .help = "mean quoted error times sqrt(galaxies)"},
    {"pull_width", TABLE_NUMBER, 3, .help = "width of (measured - true) / error"},
    {"over_bound", TABLE_NUMBER, 3,
     .help = "quoted error over the bound of one component; nan with noise"},
    {"m", TABLE_NUMBER, 5, .help = "multiplicative bias, from opposite shears", .with_error = true},
    {"failed", TABLE_INTEGER, 0, .help = "fields without a shear"},
    {0}};

enum { N_PANELS = 3 }; /* errors without and with noise, bias */

typedef struct summary {
    curve curves[N_PANELS][N_ESTIMATORS];
    double line, plane; /* bounds */
    double worst;       /* largest error of pdf-sym over that of the mean */
    double broad;       /* error over the bound, without noise, for the broadest range */
} summary;

static void add_row(table *t, const brightness_cases *cases, int c, int estimator,
                    const efficiency_outcome *o, summary *s) {
    const bool noiseless = isnan(cases->snr[c]);
    table_numbers(t, cases->c[c].range, cases->snr[c]);
    table_texts(t, shear_estimator_name((enum shear_estimator)estimator));
    table_numbers(t, o->error.width, o->error.width_err, o->quoted, o->pull_width,
                  noiseless ? o->quoted / s->line : NAN, o->m.mean, o->m.mean_err, o->failed);
    if (c < 2 * cases->n_ranges) {
        curve_add(&s->curves[c % 2][estimator], cases->c[c].range, o->quoted, o->error.width_err);
    } else {
        curve_add(&s->curves[2][estimator], cases->snr[c], 100.0 * o->m.mean,
                  100.0 * o->m.mean_err);
    }
}

static void add_case(table *t, const efficiency_fields *f, int c, summary *s) {
    const efficiency_outcome mean = efficiency_fields_outcome(f, c, MEAN);
    const efficiency_outcome pdf = efficiency_fields_outcome(f, c, SYMMETRY);
    add_row(t, &f->cases, c, MEAN, &mean, s);
    add_row(t, &f->cases, c, SYMMETRY, &pdf, s);
    if (!isnan(f->cases.snr[c])) {
        const efficiency_outcome crossed = efficiency_fields_outcome(f, c, CROSSED);
        add_row(t, &f->cases, c, CROSSED, &crossed, s);
    }
    s->worst = fmax(s->worst, pdf.quoted / mean.quoted);
    s->broad = c == 2 * f->cases.n_ranges - 2 ? pdf.quoted / s->line : s->broad;
}

static void tabulate(table *t, const efficiency_fields *f, summary *s) {
    const shape_counts counts = efficiency_fields_shapes(f);
    s->line = shape_bound_line(&counts);
    s->plane = shape_bound_plane(&counts);
    table_columns(t, columns);
    for (int c = 0; c < f->cases.n; c++)
        add_case(t, f, c, s);
    table_meta(t, "bound_one_component", "%.5f", s->line);
    table_meta(t, "bound_both_components", "%.5f", s->plane);
    table_meta(t, TABLE_CONCLUSION,
               "Cramer-Rao bound for one galaxy %.4f (both components together: %.4f); pdf-sym "
               "without noise at the broadest fluxes: %.3f times that; its error is at most "
               "%.3f times that of the ratio of means",
               s->line, s->plane, s->broad, s->worst);
}

static void draw(run *r, summary *s) {
    static const enum shear_hue hues[N_ESTIMATORS] = {SHEAR_BLUE, SHEAR_VERMILION, SHEAR_GREEN};
    static const enum shear_marker markers[N_ESTIMATORS] = {SHEAR_SQUARE, SHEAR_DISC,
                                                            SHEAR_TRIANGLE};
    static const char *const titles[N_PANELS] = {"without noise; dotted: Cramer-Rao bound",
                                                 "with noise", "bias of equal galaxies"};
    const double truths[N_PANELS] = {s->line, NAN, 0.0};
    const panels p =
        run_panels(r, NULL, 760, 840, (shear_grid){.rows = N_PANELS, .columns = 1, .gap_y = 8});
    for (int i = 0; i < N_PANELS; i++) {
        const bool of_error = i < 2;
        for (int k = 0; k < N_ESTIMATORS; k++) {
            s->curves[i][k].hue = hues[k];
            s->curves[i][k].marker = markers[k];
            s->curves[i][k].label = shear_estimator_name((enum shear_estimator)k);
        }
        panels_draw(&p, i,
                    &(chart){titles[i], of_error ? "largest over smallest flux" : "signal-to-noise",
                             of_error ? "error of one galaxy" : "m, percent", .log_x = true,
                             .legend = of_error ? SHEAR_TOP_LEFT : SHEAR_BOTTOM_RIGHT,
                             .truth = truths[i], .spread = 0.01,
                             .n_curves = i == 0 ? 2 : N_ESTIMATORS, .curves = s->curves[i]});
    }
}

static void run_efficiency(run *r) {
    efficiency_fields f;
    static summary s;
    efficiency_fields_init(&f, r->options, r->cache);
    tabulate(r->table, &f, &s);
    draw(r, &s);
    efficiency_fields_deinit(&f);
}

const experiment experiment_efficiency = {
    "efficiency",
    "beyond the paper: the ratio of means against PDF symmetrization",
    "Irregular galaxies, each at many fluxes, in many fields (--groups) of equal size. The\n"
    "error of one galaxy by the ratio of means and by PDF symmetrization, over power laws of\n"
    "flux from equal galaxies to a broad range, with and without white noise, beside the\n"
    "Cramer-Rao bound of the galaxies' shapes; and the bias of both against the\n"
    "signal-to-noise of equal galaxies, with the same galaxies and noise at opposite shears.",
    .defaults = "size=48 shear=0.03,-0.03 rotate=1 galaxy=irregular r-gal=5 r-psf=1.5 steps=300 "
                "step-size=0.6 galaxies=400000 groups=40 interpolation=none filter=none",
    .fixed = "white photons photon-snr noise-ratio estimator rotate",
    .parameters = parameters,
    .stamps = stamps,
    .run = run_efficiency};
