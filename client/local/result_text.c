/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/result_text.h"

#include "local/method_text.h"
#include "local/quality_text.h"
#include "remote/report_text.h"
#include "sheard/advice.h"
#include "sheard/no_shear.h"
#include "terminal/message.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Shears are compared at the level of 1e-5 even where one field tells less. */
enum { MIN_DECIMALS = 5, MAX_DECIMALS = 12 };

/* Decimals that show two digits of the error. */
static int decimals_of(double error) {
    if (!isfinite(error) || error <= 0.0) {
        return 6;
    }
    int decimals = 1 - (int)floor(log10(error));
    return decimals < MIN_DECIMALS   ? MIN_DECIMALS
           : decimals > MAX_DECIMALS ? MAX_DECIMALS
                                     : decimals;
}

char *value_text(double value, double error, char *buf, size_t size) {
    int decimals = decimals_of(error);
    snprintf(buf, size, "%+.*f +- %.*f", decimals, value, decimals, error);
    return buf;
}

static void row(FILE *out, const char *name, const char *text) {
    fprintf(out, "  %-10s %s\n", name, text);
}

/* "400 of 403 used (2 galaxy_not_finite, 1 masked)"; a stamp may carry several flags. */
static void print_stamps(const shear_result *r, FILE *out) {
    fprintf(out, "  %-10s %" PRId64 " of %" PRId64 " used", "stamps", r->n_used, r->n_stamps);
    const char *before = " (";
    for (int bit = 0; bit < SHEAR_N_FLAGS; bit++) {
        if (r->flagged[bit] > 0) {
            fprintf(out, "%s%" PRId64 " %s", before, r->flagged[bit], shear_flag_name(bit));
            before = ", ";
        }
    }
    fprintf(out, "%s\n", before[0] == ',' ? ")" : "");
}

/* "1.6 px", or "1.5 to 1.7 px" where the files differ. `member` is the offset of a double in
 * shear_plan_info. */
static char *range(const measure_group *g, size_t member, char *buf, size_t size) {
    double low = INFINITY;
    double high = -INFINITY;
    for (size_t i = 0; i < g->n; i++) {
        if (g->inputs[i]->measured) {
            double value = 0.0;
            memcpy(&value, (const char *)&g->inputs[i]->report.plan + member, sizeof value);
            low = fmin(low, value);
            high = fmax(high, value);
        }
    }
    if (high > low) {
        snprintf(buf, size, "%.4g to %.4g px", low, high);
    } else {
        snprintf(buf, size, "%.4g px", low);
    }
    return buf;
}

static void print_component(const char *name, double g, double error, bool has_truth, double truth,
                            FILE *out) {
    char value[96];
    char line[256];
    value_text(g, error, value, sizeof value);
    if (has_truth) {
        snprintf(line, sizeof line, "%s   truth %+.*f   pull %+.2f", value, decimals_of(error),
                 truth, (g - truth) / error);
        row(out, name, line);
    } else {
        row(out, name, value);
    }
}

static void print_shear(const measure_group *g, FILE *out) {
    const shear_result *r = &g->result;
    double true_g1 = 0.0;
    double true_g2 = 0.0;
    char line[128];
    bool has_truth = measure_group_truth(g, &true_g1, &true_g2);
    print_component("g1", r->g1, r->g1_err, has_truth, true_g1, out);
    print_component("g2", r->g2, r->g2_err, has_truth, true_g2, out);
    snprintf(line, sizeof line, "%.3g (correlation %+.2f)", r->cov12,
             r->cov12 / (r->g1_err * r->g2_err));
    row(out, "cov12", line);
    row(out, "estimator", shear_estimator_name(r->estimator));
    if (r->jackknife != 0) {
        snprintf(line, sizeof line, "jackknife over %d groups of blocks", r->jackknife);
        row(out, "errors", line);
    } else {
        row(out, "errors", shear_text_method(shear_error_method(r)));
    }
}

/* Both estimators, a line each, and which of them is more precise. */
static void print_estimators(const sheard_report_estimators *e, FILE *out) {
    for (int i = 0; i < e->n; i++) {
        const shear_result *r = &e->of[i];
        char g1[96];
        char g2[96];
        char line[256];
        snprintf(line, sizeof line, "g1 %s, g2 %s",
                 value_text(r->g1, r->g1_err, g1, sizeof g1),
                 value_text(r->g2, r->g2_err, g2, sizeof g2));
        row(out, shear_estimator_name(r->estimator), line);
    }
    if (e->n > 0) {
        char words[160];
        row(out, "precision", estimators_words(e, words, sizeof words));
    }
}

static size_t count_measured(const measure_group *g) {
    size_t n = 0;
    for (size_t i = 0; i < g->n; i++) {
        n += g->inputs[i]->measured;
    }
    return n;
}

static void print_method(const measure_group *g, const shear_settings *settings, FILE *out) {
    char r_psf[64];
    char beta[64];
    char core[64];
    method_lines m =
        method_text_of(&measure_group_first(g)->report.plan, settings,
                       range(g, offsetof(shear_plan_info, r_psf_px), r_psf, sizeof r_psf),
                       range(g, offsetof(shear_plan_info, beta_px), beta, sizeof beta),
                       range(g, offsetof(shear_plan_info, core_px), core, sizeof core));
    m.artefacts = method_text_artefacts(g->result.flagged);
    method_text_print(&m, out);
}

void result_text_print(const measure_group *g, const shear_settings *settings, FILE *out) {
    const measure_input *first = measure_group_first(g);
    const measure_input *top = measure_group_top(g);
    char name[256];
    char line[128];
    fprintf(out, "field %s\n", message_clean(g->field, name, sizeof name));
    if (count_measured(g) > 1) {
        snprintf(line, sizeof line, "%zu", count_measured(g));
        row(out, "files", line);
    } else {
        row(out, "file", message_clean(first->path, name, sizeof name));
    }
    print_stamps(&g->result, out);
    print_method(g, settings, out);
    if (g->result.valid) {
        quality_lines q = quality_text_of(&g->result, &first->report.plan);
        q.top_file = count_measured(g) > 1 && top != NULL ? top->path : NULL;
        quality_text_print(&q, out);
        print_shear(g, out);
        print_estimators(&g->estimators, out);
    } else {
        row(out, "g1", "not measured");
        row(out, "g2", "not measured");
        sheard_cause cause = {.words = sheard_no_shear_brief(&g->result)};
        sheard_cause_of(&g->result, &first->report.plan, &cause);
        row(out, "reason", cause.words);
    }
    snprintf(line, sizeof line, "%.0f stamps/s (%.2f s)", (double)g->result.n_stamps / g->seconds,
             g->seconds);
    row(out, "rate", line);
}
