/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/run.h"

#include "engine/experiment.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>

int report_picture(const struct request *r, const char *suffix, shear_figure *figure,
                   shear_error *err) {
    char path[700];
    int code =
        shear_figure_save(figure, request_path(r, suffix, "png", path, sizeof path), true, err);
    if (code == SHEAR_OK) {
        printf("wrote %s\n", path);
    }
    return code;
}

int report_save(const struct request *r, const struct ledger *ledger, struct table *table,
                shear_figure *figure, shear_error *err) {
    char path[700];
    table_meta(table, "seconds", "%.0f", ledger_seconds(ledger));
    table_meta(table, "threads", "%d", r->threads > 0 ? r->threads : omp_get_max_threads());
    table_print(table, stdout);
    int code = table_save(table, r, err);
    if (code == SHEAR_OK) {
        printf("wrote %s\n", request_path(r, NULL, "ecsv", path, sizeof path));
        code = report_picture(r, NULL, figure, err);
    }
    return code;
}

struct test {
    int n;
    const int *series;
    const double *truth;
};

static void deviations(const struct total *totals, const void *context, double *out) {
    const struct test *test = context;
    for (int i = 0; i < test->n; i++) {
        const struct total *total = &totals[test->series[i]];
        out[2 * i] = total->n1 / total->d - test->truth[0];
        out[2 * i + 1] = total->n2 / total->d - test->truth[1];
    }
}

int report_test(const struct tally *t, int n, const int *series, const double truth[2],
                struct verdict *out, shear_error *err) {
    const struct test test = {n, series, truth};
    size_t size = 2 * (size_t)n;
    double *d = calloc(size * (size + 1), sizeof *d);
    if (d == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a covariance");
    }
    int code = tally_jackknife(t, deviations, &test, 2 * n, d, d + size, err);
    code = code != SHEAR_OK ? code : verdict_of_covariance(d, d + size, 2 * n, t->groups, out, err);
    free(d);
    return code;
}

char *report_verdict(const struct verdict *v, char *buf, size_t size) {
    if (isnan(v->p)) {
        snprintf(buf, size, "chi2 = %.1f for %d (too few groups for a probability)", v->chi2,
                 v->dof);
    } else {
        snprintf(buf, size, "chi2 = %.1f for %d (p = %.2g)", v->chi2, v->dof, v->p);
    }
    return buf;
}
