/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/wcs/sky_polynomial.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <wcslib/dis.h>

enum { PRIOR = 1, SEQUENT = 2, KEYS = 256 };

/* Return the distortion of *lin, of a kind that wcslib knows, with room for KEYS keys. */
static struct disprm *attach(struct linprm *lin, int place, const char *kind) {
    struct disprm *d = calloc(1, sizeof *d);
    if (d == NULL)
        return NULL;
    d->flag = -1;
    if (lindist(place, lin, d, KEYS) != 0 || d->dp == NULL || d->dtype == NULL)
        return NULL;
    for (int i = 0; i < 2; i++)
        snprintf(d->dtype[i], sizeof d->dtype[i], "%s", kind);
    return d;
}

static void add_integer(struct disprm *d, const char *keyword, const char *field, int axis,
                        int value) {
    dpfill(&d->dp[d->ndp++], keyword, field, axis, 0, value, 0.0);
}

/* Zeros, and what is absent, are left out. */
static void add_number(struct disprm *d, const char *keyword, const char *field, int axis,
                       double value) {
    if (!isnan(value) && value != 0.0)
        dpfill(&d->dp[d->ndp++], keyword, field, axis, 1, 0, value);
}

static void add_sip(struct disprm *d, const sky_keywords *k, int i) {
    char field[32];
    add_integer(d, "DP", "NAXES", i + 1, 2);
    add_number(d, "DP", "OFFSET.1", i + 1, k->crpix[0]);
    add_number(d, "DP", "OFFSET.2", i + 1, k->crpix[1]);
    for (int p = 0; p < SKY_POWERS; p++) {
        for (int q = 0; q < SKY_POWERS; q++) {
            snprintf(field, sizeof field, "SIP.FWD.%d_%d", p, q);
            add_number(d, "DP", field, i + 1, k->sip[i][p][q]);
        }
    }
}

/* PVi_m belongs to the axis i, whose own coordinate is x in the polynomial. PVi_1 is 1 if it is
 * absent. */
static void add_tpv(struct disprm *d, const sky_keywords *k, int i) {
    char field[32];
    add_integer(d, "DQ", "NAXES", i + 1, 2);
    add_integer(d, "DQ", "AXIS.1", i + 1, i + 1);
    add_integer(d, "DQ", "AXIS.2", i + 1, 2 - i);
    for (int m = 0; m < SKY_PV; m++) {
        snprintf(field, sizeof field, "TPV.%d", m);
        add_number(d, "DQ", field, i + 1, m == 1 && isnan(k->pv[i][m]) ? 1.0 : k->pv[i][m]);
    }
}

bool sky_polynomial_attach(struct linprm *lin, const sky_keywords *k) {
    const bool tpv = strcmp(k->projection, "TPV") == 0;
    if (!k->has_sip && !tpv)
        return true;
    struct disprm *d = k->has_sip ? attach(lin, PRIOR, "SIP") : attach(lin, SEQUENT, "TPV");
    if (d == NULL)
        return false;
    for (int i = 0; i < 2; i++) {
        if (k->has_sip) {
            add_sip(d, k, i);
        } else {
            add_tpv(d, k, i);
        }
    }
    return true;
}
