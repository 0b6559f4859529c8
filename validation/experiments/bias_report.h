/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bias_report.h: the cases of the experiment `bias`, its table and figure. */
#ifndef VALIDATION_BIAS_REPORT_H
#define VALIDATION_BIAS_REPORT_H

#include "engine/bias_fit.h"
#include "engine/cache.h"

enum { BIAS_MAX_CASES = 48 };
enum bias_noise { BIAS_CLEAN = 0, BIAS_WHITE, BIAS_SOURCES };

typedef struct bias_case {
    int kind;   /* enum shear_mock_galaxy */
    int psf;    /* enum shear_mock_psf */
    int noise;  /* enum bias_noise */
    int way;    /* 0: no interpolation; 1: Log-Bicubic and Log-Spline */
    bool large; /* of the shears that test the higher orders */
} bias_case;

/* The ledger's name of a case. Returns buf. */
char *bias_case_name(const bias_case *b, char *buf, size_t size);

int bias_measure(const struct request *r, struct ledger *ledger, const bias_case *b,
                 struct tally **tally, shear_error *err);
/* Which series of its tally show which shear; `method` 0 or 1 where it has two. */
shear_set bias_shears(const struct request *r, const bias_case *b, int method);

/* Measure all cases, table, figure. */
int bias_report(const struct request *r, struct ledger *ledger, const bias_case *cases, int n,
                shear_error *err);

#endif
