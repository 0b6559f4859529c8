/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Experiment `survey` (beyond the paper): the shear of imperfect data with the default settings. */
#include "base/text.h"
#include "engine/must.h"
#include "engine/trial.h"
#include "experiments/list.h"
#include "report/chart.h"
#include "report/run.h"

#include <math.h>
#include <stdlib.h>

enum { N_WAYS = 2, COLUMNS = 3 }; /* the mean and pdf-sym; columns of the figure */

static const parameter parameters[] = {
    {"snrs", "100,30,15,10", 1, 1e6, TRIAL_MAX_LEVELS,
     "signal-to-noise of the galaxies, as in GREAT3"},
    {"rows", "0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25", 0, 99,
     MAX_VALUES, "which rows of the table"},
    {"least", "256", 64, 1e9, 1, "stamps of a row that has fewer, at least"},
    {0}};

static trial trial_of(const options *o, const flaw *f) {
    const parameter_values *snrs = options_list(o, "snrs");
    const double fewer =
        fmax((double)o->galaxies / (f->fewer > 1 ? f->fewer : 1), options_number(o, "least"));
    trial t = trial_of_options(o, 4);
    t.flaw = f;
    t.stamps = (int64_t)(fewer / 64.0) * 64;
    t.groups = f->fewer > 4 && o->groups > 8 ? 8 : o->groups;
    t.n_levels = snrs->n;
    t.n_ways = N_WAYS;
    for (int i = 0; i < snrs->n; i++)
        t.levels[i] = (trial_level){.snr = snrs->v[i], .range = 1.0};
    for (int i = 0; i < N_WAYS; i++) {
        t.ways[i] = o->settings;
        t.ways[i].estimator = i == 0 ? SHEAR_ESTIMATOR_MEAN : SHEAR_ESTIMATOR_PDF_SYM;
    }
    return t;
}

static int64_t stamps(const options *o) {
    const parameter_values *rows = options_list(o, "rows");
    int64_t total = 0;
    for (int i = 0; i < rows->n; i++) {
        if (rows->v[i] >= flaw_count())
            must_fail(SHEAR_E_SETTING, NULL, "option '--rows': there is no row %g", rows->v[i]);
        total += 2 * trial_of(o, &flaws[(int)rows->v[i]]).stamps;
    }
    return total;
}

/* A row of the table of flaws, and its results. */
typedef struct flaw_row {
    const flaw *flaw;
    trial_outcome *out; /* [snrs][N_WAYS] */
} flaw_row;

/* ---- requirements ---- */

static bool wish_is_met(const flaw *f, double snr, const trial_outcome *o) {
    switch (f->wish) {
    case WISH_TOLD:
        return o->told > TOLD_NOTHING || (f->wish_snr > 0.0 && snr > f->wish_snr);
    case WISH_FLAGS:
        return o->flagged == o->spoilt;
    case WISH_NO_EDGE:
        return o->edge == 0.0;
    case WISH_QUIET:
        return o->told == TOLD_NOTHING;
    default:
        return true;
    }
}

/* false for NaN */
static bool bias_is_small(const flaw *f, const trial_outcome *o) {
    return f->aim_m == 0.0 || fabs(o->m) < 1e-3 * f->aim_m + 2.0 * o->m_err;
}

static bool is_met(const flaw *f, double snr, const trial_outcome *o) {
    return wish_is_met(f, snr, o) && bias_is_small(f, o);
}

static char *aim_text(const flaw *f, char *buf, size_t size) {
    static const char *const wishes[] = {"", "told", "flagged", "no advice for edge", "quiet"};
    char bias[32] = "";
    char to[24] = "";
    if (f->aim_m > 0.0)
        snprintf(bias, sizeof bias, "m within %g%s", f->aim_m, f->wish != WISH_NOTHING ? ", " : "");
    if (f->wish_snr > 0.0)
        snprintf(to, sizeof to, " to S/N %g", f->wish_snr);
    snprintf(buf, size, "%s%s%s", bias, wishes[f->wish], to);
    return buf;
}

/* ---- table ---- */

static const column columns[] = {
    {"case", TABLE_TEXT, 0, .help = "what is wrong with the data"},
    {"label", TABLE_TEXT, 0, .help = "the same in words"},
    {"snr", TABLE_NUMBER, 0, .help = "signal-to-noise of the galaxies"},
    {"estimator", TABLE_TEXT, 0, .help = "mean or pdf-sym"},
    {"m", TABLE_NUMBER, 4, .help = "multiplicative bias along the shear", .with_error = true},
    {"c#", TABLE_NUMBER, 5, .help = "additive bias", .with_error = true},
    {"level", TABLE_NUMBER, 4, .help = "noise under the galaxies over the noise stamps'",
     .with_error = true},
    {"stamps", TABLE_INTEGER, 0, .help = "that were measured, of both signs"},
    {"flagged", TABLE_INTEGER, 0, .help = "that were left out"},
    {"spoilt", TABLE_INTEGER, 0, .help = "that should be"},
    {"told", TABLE_TEXT, 0, .help = "refused, no shear, flagged, warned, or no"},
    {"aim", TABLE_TEXT, 0, .help = "m in 10^-3, beside two errors"},
    {"met", TABLE_TEXT, 0, .help = "yes or no"},
    {0}};

static void add_row(table *t, const flaw *f, double snr, int way, const trial_outcome *o) {
    char aim[80];
    char told[48];
    table_texts(t, f->name, f->label);
    table_numbers(t, snr);
    table_texts(t, way != 0 ? "pdf-sym" : "mean");
    table_numbers(t, o->m, o->m_err, o->c[0], o->c_err[0], o->c[1], o->c_err[1]);
    table_numbers(t, o->level, o->level_err, o->used, o->flagged, o->spoilt);
    table_texts(t, trial_told_text(o, told, sizeof told), aim_text(f, aim, sizeof aim),
                is_met(f, snr, o) ? "yes" : "no");
}

/* Add a conclusion for a row of the table of flaws: the signal-to-noise at which it meets the
 * requirement. Returns whether there is any. */
static bool conclude(table *t, const parameter_values *snrs, const flaw_row *row) {
    const flaw *f = row->flaw;
    const trial_outcome *loudest = &row->out[0];
    char text[N_WAYS][160] = {""};
    char aim[80];
    char told[48];
    bool all = true;
    for (int way = 0; way < N_WAYS; way++) {
        for (int i = 0; i < snrs->n; i++) {
            const trial_outcome *o = &row->out[i * N_WAYS + way];
            const bool good = is_met(f, snrs->v[i], o);
            all = all && good;
            loudest = o->told > loudest->told ? o : loudest;
            text_append(text[way], sizeof text[way], "%s%.1f +- %.1f%s", i != 0 ? ", " : "",
                        1e3 * o->m, 1e3 * o->m_err, good ? "" : "!");
        }
    }
    table_meta(t, TABLE_CONCLUSION, "%s (%s): %s; mean %s; pdf-sym %s; told: %s", f->label,
               aim_text(f, aim, sizeof aim), all ? "met" : "not met", text[0], text[1],
               trial_told_text(loudest, told, sizeof told));
    return all;
}

static void tabulate(table *t, const parameter_values *snrs, const flaw_row *rows, int n) {
    int met = 0;
    table_columns(t, columns);
    for (int row = 0; row < n; row++) {
        for (int i = 0; i < snrs->n * N_WAYS; i++)
            add_row(t, rows[row].flaw, snrs->v[i / N_WAYS], i % N_WAYS, &rows[row].out[i]);
    }
    for (int row = 0; row < n; row++)
        met += conclude(t, snrs, &rows[row]);
    table_meta(t, "met", "%d", met);
    table_meta(t, "cases", "%d", n);
}

/* ---- figure: m against signal-to-noise, a panel per row with a limit on m ---- */

static void draw_panel(shear_figure *f, shear_rect cell, const parameter_values *snrs,
                       const flaw_row *row, bool first) {
    curve curves[N_WAYS] = {
        {.hue = SHEAR_BLUE, .marker = SHEAR_SQUARE, .label = first ? "mean" : NULL},
        {.hue = SHEAR_VERMILION, .marker = SHEAR_DISC, .label = first ? "pdf-sym" : NULL}};
    for (int i = 0; i < snrs->n * N_WAYS; i++) {
        curve_add(&curves[i % N_WAYS], snrs->v[i / N_WAYS], 1e3 * row->out[i].m,
                  1e3 * row->out[i].m_err);
    }
    chart_draw(f, cell,
               &(chart){row->flaw->label, "S/N", "m, 10^{-3}", .log_x = true,
                        .legend = SHEAR_TOP_RIGHT, .truth = 0.0, .headroom = first ? 0.6 : 0.0,
                        .spread = 0.02, .n_curves = N_WAYS, .curves = curves});
}

static void draw(run *r, const parameter_values *snrs, const flaw_row *rows, int n) {
    const flaw_row *shown[MAX_VALUES];
    int n_shown = 0;
    for (int i = 0; i < n; i++) {
        if (rows[i].flaw->aim_m > 0.0)
            shown[n_shown++] = &rows[i];
    }
    const int lines = n_shown > 0 ? (n_shown + COLUMNS - 1) / COLUMNS : 1;
    const panels p =
        run_panels(r, NULL, 1100, 220 * lines + 16,
                   (shear_grid){.rows = lines, .columns = COLUMNS, .gap_x = 10, .gap_y = 6});
    for (int i = 0; i < n_shown; i++)
        draw_panel(p.figure, panels_cell(&p, i), snrs, shown[i], i == 0);
}

static void run_survey(run *r) {
    const parameter_values *which = options_list(r->options, "rows");
    const parameter_values *snrs = options_list(r->options, "snrs");
    flaw_row rows[MAX_VALUES];
    for (int i = 0; i < which->n; i++) {
        const flaw *f = &flaws[(int)which->v[i]];
        const trial t = trial_of(r->options, f);
        rows[i] = (flaw_row){f, trial_run(&t, r->cache, f->name)};
    }
    tabulate(r->table, snrs, rows, which->n);
    draw(r, snrs, rows, which->n);
    for (int i = 0; i < which->n; i++)
        free(rows[i].out);
}

const experiment experiment_survey = {
    "survey",
    "beyond the paper: the shear of imperfect data by the default settings",
    "Galaxies of disk and bulge behind a Moffat PSF (or one of a space telescope), in fours\n"
    "at +g and -g in the same noise, under what real data have: noise that the noise stamps\n"
    "do not show, source photons, a sky, artefacts, a PSF that is not what it should be,\n"
    "files made wrongly. m and c by the default settings for the mean and for pdf-sym, and\n"
    "whether the library refused, flagged or warned; each row beside what is asked of it.",
    .defaults = "preset=default shear=0.03,-0.02 galaxies=20000 groups=40",
    .fixed = trial_fixed,
    .parameters = parameters,
    .stamps = stamps,
    .run = run_survey};
