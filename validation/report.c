/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report.h"

#include "experiment.h"

#include <math.h>

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
    table_print(table, stdout);
    int code = table_save(table, r, err);
    if (code == SHEAR_OK) {
        printf("wrote %s\n", request_path(r, NULL, "ecsv", path, sizeof path));
        code = report_picture(r, NULL, figure, err);
    }
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
