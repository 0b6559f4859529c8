/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report.h: how an experiment ends. */
#ifndef VALIDATION_REPORT_H
#define VALIDATION_REPORT_H

#include "engine/cache.h"
#include "engine/jackknife.h"
#include "engine/statistics.h"
#include "report/table.h"
#include "shear_figures/figure.h"

/* Print the table, save table and figure (OUT/NAME.ecsv, OUT/NAME.png), say where they are, with
 * the run time of all pieces as meta data. Frees neither. */
int report_save(const struct request *r, const struct ledger *ledger, struct table *table,
                shear_figure *figure, shear_error *err);
/* A further figure OUT/NAME-suffix.png. */
int report_picture(const struct request *r, const char *suffix, shear_figure *figure,
                   shear_error *err);

/* Are the shears of so many series the true one, all together, with the jackknife's covariance of
 * them all (verdict_of_covariance)? */
int report_test(const struct tally *t, int n, const int *series, const double truth[2],
                struct verdict *out, shear_error *err);
/* A verdict as text, "chi2 = 12.3 for 14 (p = 0.58)". Returns buf. */
char *report_verdict(const struct verdict *v, char *buf, size_t size);

#endif
