/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/wcs/sky_polynomial.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <wcslib/dis.h>

enum { PRIOR = 1, SEQUENT = 2, KEYS = 256 };

/* Return the distortion of *lin, with room for KEYS keys. */
static struct disprm *attach(struct linprm *lin, int place) {
    struct disprm *d = calloc(1, sizeof *d);
    if (d == NULL)
        return NULL;
    d->flag = -1;
    return lindist(place, lin, d, KEYS) == 0 && d->dp != NULL && d->dtype != NULL ? d : NULL;
}

/* Begin the keys of axis i, with a kind that wcslib knows. */
static void begin_axis(struct disprm *d, const char *keyword, const char *kind, int i) {
    snprintf(d->dtype[i], sizeof d->dtype[i], "%s", kind);
    dpfill(&d->dp[d->ndp++], keyword, "NAXES", i + 1, 0, 2, 0.0);
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
    begin_axis(d, "DP", "SIP", i);
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
    begin_axis(d, "DQ", "TPV", i);
    add_integer(d, "DQ", "AXIS.1", i + 1, i + 1);
    add_integer(d, "DQ", "AXIS.2", i + 1, 2 - i);
    for (int m = 0; m < SKY_PV; m++) {
        snprintf(field, sizeof field, "TPV.%d", m);
        add_number(d, "DQ", field, i + 1, m == 1 && isnan(k->pv[i][m]) ? 1.0 : k->pv[i][m]);
    }
}

/* x is xi and y is eta, on either axis. */
static void add_surface(struct disprm *d, const sky_keywords *k, int i) {
    static const char *const names[] = {"", "CHBY", "LEGR", "MONO"};
    const sky_surface *const s = &k->surface[i];
    char field[32];
    if (s->kind == SKY_SURFACE_NONE)
        return;
    begin_axis(d, "DQ", "WAT", i);
    add_integer(d, "DQ", "AXIS.1", i + 1, k->type.lng + 1);
    add_integer(d, "DQ", "AXIS.2", i + 1, 2 - k->type.lng);
    add_integer(d, "DQ", "WAT.POLY", i + 1, (int)s->kind);
    add_number(d, "DQ", "WAT.XMIN", i + 1, s->low[0]);
    add_number(d, "DQ", "WAT.XMAX", i + 1, s->high[0]);
    add_number(d, "DQ", "WAT.YMIN", i + 1, s->low[1]);
    add_number(d, "DQ", "WAT.YMAX", i + 1, s->high[1]);
    for (int m = 0; m < SKY_SURFACE_ORDER; m++) {
        for (int n = 0; n < SKY_SURFACE_ORDER; n++) {
            snprintf(field, sizeof field, "WAT.%s.%d_%d", names[s->kind], m, n);
            add_number(d, "DQ", field, i + 1, s->c[m][n]);
        }
    }
}

bool sky_polynomial_attach(struct linprm *lin, const sky_keywords *k) {
    void (*add)(struct disprm *, const sky_keywords *, int) =
        k->type.has_sip                          ? add_sip
        : strcmp(k->type.projection, "TPV") == 0 ? add_tpv
        : k->surface[0].kind != SKY_SURFACE_NONE || k->surface[1].kind != SKY_SURFACE_NONE
            ? add_surface
            : NULL;
    if (add == NULL)
        return true;
    struct disprm *d = attach(lin, k->type.has_sip ? PRIOR : SEQUENT);
    if (d == NULL)
        return false;
    for (int i = 0; i < 2; i++)
        add(d, k, i);
    return true;
}
