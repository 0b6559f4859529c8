/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/report_text.h"

#include "local/method_text.h"
#include "local/quality_text.h"
#include "local/value_text.h"
#include "sheard/no_shear.h"
#include "sheard/report_summary.h"
#include "terminal/text_line.h"

#include <inttypes.h>
#include <math.h>

static void print_component(const char *name, double g, double error, double truth, double pull,
                            bool own, FILE *out) {
    char value[96];
    value_text(g, error, value, sizeof value);
    if (!isfinite(g)) {
        text_line(out, name, "not measured");
    } else if (isfinite(truth) && own) {
        text_line(out, name, "%s   truth %+.*f   pull %+.2f", value, value_text_decimals(error),
                  truth, pull);
    } else if (isfinite(truth)) {
        text_line(out, name, "%s   truth %+.6g   pull %+.2f", value, truth, pull);
    } else {
        text_line(out, name, "%s", value);
    }
}

static void print_summary(const sheard_report_summary *s, const char *reason, bool own, FILE *out) {
    value_text_print_stamps(s->n_used, s->n_stamps, s->flagged, out);
    if (s->interpolation[0] != '\0')
        method_text_print(s, method_text_artefacts(s->flagged), out);
    if (isfinite(s->g1))
        quality_text_print(s, out);
    print_component("g1", s->g1, s->g1_err, s->true_g1, s->pull_g1, own, out);
    print_component("g2", s->g2, s->g2_err, s->true_g2, s->pull_g2, own, out);
    if (reason != NULL) {
        text_line(out, "reason", "%s", reason);
    } else if (s->no_shear[0] != '\0') {
        const char *words = sheard_no_shear_words(sheard_no_shear_of(s->no_shear));
        text_line(out, "reason", "%s", words != NULL ? words : s->no_shear);
    }
    if (isfinite(s->cov12)) {
        text_line(out, "cov12", "%.3g (correlation %+.2f)", s->cov12,
                  s->cov12 / (s->g1_err * s->g2_err));
    }
    if (isfinite(s->g1) && s->estimator[0] != '\0')
        text_line(out, "estimator", "%s", s->estimator);
    if (isfinite(s->g1) && s->jackknife > 0) {
        text_line(out, "errors", "jackknife over %" PRId64 " groups of blocks", s->jackknife);
    } else if (isfinite(s->g1)) {
        text_line(out, "errors", "%s", value_text_error_method(s->error_method));
    }
    for (int64_t i = 0; i < s->n_warnings && !own; i++)
        text_line(out, "warning", "%s", s->warnings[i]);
}

void report_text_print(const char *report, const char *reason, bool own, FILE *out) {
    sheard_report_summary summary;
    shear_error err = {0};
    if (report == NULL)
        return;
    if (sheard_report_summary_parse(&summary, report, &err) != 0) {
        text_line(out, "result", "cannot be shown: %s", err.message);
        return;
    }
    print_summary(&summary, reason, own, out);
    sheard_report_summary_deinit(&summary);
}
