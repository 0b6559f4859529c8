/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/result_text.h"

#include "local/estimators.h"
#include "local/method_text.h"
#include "local/quality_text.h"
#include "local/value_text.h"
#include "sheard/advice.h"
#include "sheard/no_shear.h"
#include "terminal/message.h"
#include "terminal/text_line.h"

#include <math.h>
#include <string.h>

/* Write "1.6 px", or "1.5 to 1.7 px" if files differ, into buf. `member` is the offset of a double
 * in shear_plan_info. Returns buf. */
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
    return value_text_length(low, high, buf, size);
}

static void print_component(const char *name, double g, double error, bool has_truth, double truth,
                            FILE *out) {
    char value[96];
    value_text(g, error, value, sizeof value);
    if (has_truth) {
        text_line(out, name, "%s   truth %+.*f   pull %+.2f", value, value_text_decimals(error),
                  truth, (g - truth) / error);
    } else {
        text_line(out, name, "%s", value);
    }
}

static void print_shear(const measure_group *g, FILE *out) {
    const shear_result *r = &g->result;
    double true_g1 = 0.0;
    double true_g2 = 0.0;
    const bool has_truth = measure_group_truth(g, &true_g1, &true_g2);
    print_component("g1", r->g1, r->g1_err, has_truth, true_g1, out);
    print_component("g2", r->g2, r->g2_err, has_truth, true_g2, out);
    text_line(out, "cov12", "%.3g (correlation %+.2f)", r->cov12,
              r->cov12 / (r->g1_err * r->g2_err));
    text_line(out, "estimator", "%s", shear_estimator_name(r->estimator));
    if (r->jackknife != 0) {
        text_line(out, "errors", "jackknife over %d groups of blocks", r->jackknife);
    } else {
        text_line(out, "errors", "%s", value_text_error_method(shear_error_method(r)));
    }
}

/* Print one line per estimator, and which one is more precise. */
static void print_estimators(const sheard_report_estimators *e, FILE *out) {
    char g1[96];
    char g2[96];
    char words[160];
    for (int i = 0; i < e->n; i++) {
        const shear_result *r = &e->of[i];
        text_line(out, shear_estimator_name(r->estimator), "g1 %s, g2 %s",
                  value_text(r->g1, r->g1_err, g1, sizeof g1),
                  value_text(r->g2, r->g2_err, g2, sizeof g2));
    }
    if (e->n > 0)
        text_line(out, "precision", "%s", estimators_words(e, words, sizeof words));
}

static size_t count_measured(const measure_group *g) {
    size_t n = 0;
    for (size_t i = 0; i < g->n; i++)
        n += g->inputs[i]->measured;
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

/* Print why there is no shear. */
static void print_no_shear(const measure_group *g, FILE *out) {
    sheard_cause cause = {.words = sheard_no_shear_brief(&g->result)};
    sheard_cause_of(&g->result, &measure_group_first(g)->report.plan, &cause);
    text_line(out, "g1", "not measured");
    text_line(out, "g2", "not measured");
    text_line(out, "reason", "%s", cause.words);
}

void result_text_print(const measure_group *g, const shear_settings *settings, FILE *out) {
    const measure_input *first = measure_group_first(g);
    const measure_input *top = measure_group_top(g);
    const size_t n = count_measured(g);
    char name[256];
    fprintf(out, "field %s\n", message_clean(g->field, name, sizeof name));
    if (n > 1) {
        text_line(out, "files", "%zu", n);
    } else {
        text_line(out, "file", "%s", message_clean(first->path, name, sizeof name));
    }
    value_text_print_stamps(g->result.n_used, g->result.n_stamps, g->result.flagged, out);
    print_method(g, settings, out);
    if (g->result.valid) {
        quality_lines q = quality_text_of(&g->result, &first->report.plan);
        q.top_file = n > 1 && top != NULL ? top->path : NULL;
        quality_text_print(&q, out);
        print_shear(g, out);
        print_estimators(&g->estimators, out);
    } else {
        print_no_shear(g, out);
    }
    text_line(out, "rate", "%.0f stamps/s (%.2f s)", (double)g->result.n_stamps / g->seconds,
              g->seconds);
}
