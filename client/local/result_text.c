/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/result_text.h"

#include "local/estimators.h"
#include "local/report_text.h"
#include "sheard/advice.h"
#include "sheard/no_shear.h"
#include "terminal/human.h"
#include "terminal/message.h"
#include "terminal/text_line.h"

/* Print one line per estimator, and which one is more precise. */
static void print_estimators(const sheard_report_estimators *e, FILE *out) {
    char g1[96];
    char g2[96];
    char words[160];
    for (int i = 0; i < e->n; i++) {
        const shear_result *r = &e->of[i];
        text_line(out, shear_estimator_name(r->estimator), "g1 %s, g2 %s",
                  human_value(r->g1, r->g1_err, g1, sizeof g1),
                  human_value(r->g2, r->g2_err, g2, sizeof g2));
    }
    if (e->n > 0)
        text_line(out, "precision", "%s", estimators_words(e, words, sizeof words));
}

void result_text_print(const measure_group *g, const char *report, FILE *out) {
    const measure_input *first = measure_group_first(g);
    sheard_cause cause = {.words = NULL};
    char name[256];
    fprintf(out, "field %s\n", message_clean(g->field, name, sizeof name));
    if (g->n_measured > 1) {
        text_line(out, "files", "%zu", g->n_measured);
    } else {
        text_line(out, "file", "%s", message_clean(first->path, name, sizeof name));
    }
    if (!g->result.valid && !sheard_cause_of(&g->result, &first->report.plan, &cause))
        cause.words = sheard_no_shear_brief(&g->result);
    report_text_print(report, cause.words, true, out);
    if (g->result.valid)
        print_estimators(&g->estimators, out);
    text_line(out, "rate", "%.0f stamps/s (%.2f s)", (double)g->result.n_stamps / g->seconds,
              g->seconds);
}
