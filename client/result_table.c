/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "result_table.h"

#include "message.h"
#include "quality_text.h"
#include "shear_text.h"
#include "sheard/no_shear.h"

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

char *result_table_value(double value, double error, char *buf, size_t size) {
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
static char *range(const struct measure_group *g, size_t member, char *buf, size_t size) {
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

void result_table_method(const shear_plan_info *plan, const char *r_psf, const char *beta,
                         FILE *out) {
    fprintf(out, "  %-10s interpolation %s", "method",
            shear_interpolation_name(plan->interpolation));
    if (plan->interpolation != SHEAR_INTERP_NONE) {
        fprintf(out, " to %d x", plan->oversample);
    }
    fprintf(out, ", R_PSF %s, beta %s, filter %s", r_psf, beta, shear_filter_name(plan->filter));
    if (plan->filter != SHEAR_FILTER_NONE) {
        if (plan->filter_per_stamp) {
            fputs(" (core by R_GAL", out);
        } else {
            fprintf(out, " (core %.4g px", plan->core_px);
        }
        fprintf(out, ", width %.4g px)", plan->width_px);
    }
    fputc('\n', out);
}

static void print_component(const char *name, double g, double error, bool has_truth, double truth,
                            FILE *out) {
    char value[96];
    char line[256];
    result_table_value(g, error, value, sizeof value);
    if (has_truth) {
        snprintf(line, sizeof line, "%s   truth %+.*f   pull %+.2f", value, decimals_of(error),
                 truth, (g - truth) / error);
        row(out, name, line);
    } else {
        row(out, name, value);
    }
}

static void print_shear(const struct measure_group *g, FILE *out) {
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
    if (r->jackknife) {
        snprintf(line, sizeof line, "jackknife over %d groups of blocks", r->jackknife);
        row(out, "errors", line);
    } else {
        row(out, "errors", shear_text_method(shear_error_method(r)));
    }
}

/* Both estimators, a line each, and which of them is more precise. */
static void print_estimators(const shear_report_estimators *e, FILE *out) {
    for (int i = 0; i < e->n; i++) {
        const shear_result *r = &e->of[i];
        char g1[96];
        char g2[96];
        char line[256];
        snprintf(line, sizeof line, "g1 %s, g2 %s",
                 result_table_value(r->g1, r->g1_err, g1, sizeof g1),
                 result_table_value(r->g2, r->g2_err, g2, sizeof g2));
        row(out, shear_estimator_name(r->estimator), line);
    }
    if (e->n > 0) {
        char words[160];
        row(out, "precision", estimators_words(e, words, sizeof words));
    }
}

static void print_quality(const shear_result *r, FILE *out) {
    const struct quality q = {.noise_level = r->noise_level,
                              .noise_level_err = r->noise_level_err,
                              .noise_effect = r->noise_effect,
                              .noise_share = r->noise_share,
                              .n_eff = r->n_eff,
                              .top_share = r->top_share,
                              .n_used = r->n_used,
                              .top_stamp = r->top_stamp};
    if (r->valid) {
        quality_text_print(&q, out);
    }
}

static size_t count_measured(const struct measure_group *g) {
    size_t n = 0;
    for (size_t i = 0; i < g->n; i++) {
        n += g->inputs[i]->measured;
    }
    return n;
}

void result_table_print(const struct measure_group *g, FILE *out) {
    const struct measure_input *first = measure_group_first(g);
    char name[256];
    char line[128];
    char r_psf[64];
    char beta[64];
    fprintf(out, "field %s\n", message_clean(g->field, name, sizeof name));
    if (count_measured(g) > 1) {
        snprintf(line, sizeof line, "%zu", count_measured(g));
        row(out, "files", line);
    } else {
        row(out, "file", message_clean(first->path, name, sizeof name));
    }
    print_stamps(&g->result, out);
    result_table_method(&first->report.plan,
                        range(g, offsetof(shear_plan_info, r_psf_px), r_psf, sizeof r_psf),
                        range(g, offsetof(shear_plan_info, beta_px), beta, sizeof beta), out);
    print_quality(&g->result, out);
    if (g->result.valid) {
        print_shear(g, out);
        print_estimators(&g->estimators, out);
    } else {
        row(out, "g1", "not measured");
        row(out, "g2", "not measured");
        row(out, "reason", shear_no_shear_brief(&g->result));
    }
    snprintf(line, sizeof line, "%.0f stamps/s (%.2f s)", (double)g->result.n_stamps / g->seconds,
             g->seconds);
    row(out, "rate", line);
}
