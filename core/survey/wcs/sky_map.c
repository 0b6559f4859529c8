/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/wcs/sky_map.h"

#include "base/cleanup.h"
#include "survey/wcs/sky_keywords.h"
#include "survey/wcs/sky_polynomial.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <wcslib/wcs.h>

enum { BLOCK = 32 }; /* positions that are converted at once */

static const double radian = 0.017453292519943295769;
static const double arcsec = 3600.0 / radian; /* per radian */

struct sky_map {
    struct wcsprm wcs;
    int lng, lat; /* axes */
};

void sky_map_free(sky_map *map) {
    if (map == NULL)
        return;
    wcsfree(&map->wcs);
    free(map);
}

CLEANUP_DEFINE(sky_map, sky_map_free)

/* Copy a matrix; what is absent is `diagonal` on the diagonal, else 0. Return whether an element is
 * there. */
static bool copy_matrix(double out[4], const double in[2][2], double diagonal) {
    bool found = false;
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            out[2 * i + j] = i == j ? diagonal : 0.0;
            if (isnan(in[i][j]))
                continue;
            out[2 * i + j] = in[i][j];
            found = true;
        }
    }
    return found;
}

static void set_linear(struct wcsprm *w, const sky_keywords *k) {
    enum { HAS_PC = 1, HAS_CD = 2, HAS_CROTA = 4 }; /* bits of altlin */
    if (copy_matrix(w->pc, k->pc, 1.0))
        w->altlin |= HAS_PC;
    if (copy_matrix(w->cd, k->cd, 0.0))
        w->altlin |= HAS_CD;
    for (int i = 0; i < 2; i++) {
        w->crpix[i] = k->crpix[i];
        if (!isnan(k->cdelt[i]))
            w->cdelt[i] = k->cdelt[i];
        if (!isnan(k->crota[i])) {
            w->crota[i] = k->crota[i];
            w->altlin |= HAS_CROTA;
        }
    }
}

/* A polynomial is told apart from the projection: TPV is TAN then. */
static void set_celestial(struct wcsprm *w, const sky_keywords *k) {
    const bool tpv = strcmp(k->type.projection, "TPV") == 0;
    for (int i = 0; i < 2; i++) {
        snprintf(w->ctype[i], sizeof w->ctype[i], "%s%s", i == k->type.lng ? "RA---" : "DEC--",
                 tpv ? "TAN" : k->type.projection);
        snprintf(w->cunit[i], sizeof w->cunit[i], "deg");
        w->crval[i] = k->crval[i];
    }
    if (!isnan(k->lonpole))
        w->lonpole = k->lonpole;
    if (!isnan(k->latpole))
        w->latpole = k->latpole;
    for (int i = 0; i < 2 && !tpv; i++) {
        for (int m = 0; m < SKY_PV; m++) {
            if (!isnan(k->pv[i][m]))
                w->pv[w->npv++] = (struct pvcard){.i = i + 1, .m = m, .value = k->pv[i][m]};
        }
    }
}

/* Return whether the linear part, as wcsset left it, takes a square to a line. */
static bool is_singular(const struct wcsprm *w) {
    const double a = w->pc[0] * w->cdelt[0], b = w->pc[1] * w->cdelt[0];
    const double c = w->pc[2] * w->cdelt[1], d = w->pc[3] * w->cdelt[1];
    return !(fabs(a * d - b * c) > 1e-12 * (a * a + b * b + c * c + d * d));
}

static int set_up(sky_map *map, const sky_keywords *k, const char *where, shear_error *err) {
    struct wcsprm *w = &map->wcs;
    w->flag = -1;
    if (wcsinit(1, 2, w, 2 * SKY_PV, 0, 0) != 0)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    set_linear(w, k);
    set_celestial(w, k);
    if (!sky_polynomial_attach(&w->lin, k))
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    int status = wcsset(w);
    if (status == 0 && is_singular(w))
        status = WCSERR_SINGULAR_MTX;
    if (status == WCSERR_MEMORY)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    if (status != 0) {
        return shear_fail(err, SHEAR_E_FORMAT, "correct its coordinates, or use --frame pixel",
                          "%s: wcslib refuses its coordinates (CTYPE1 '%.24s'): %s", where,
                          k->type.text[0], wcs_errmsg[status]);
    }
    map->lng = w->lng;
    map->lat = w->lat;
    return SHEAR_OK;
}

int sky_map_new(sky_map **map, const char *cards, int64_t count, const char *where,
                shear_error *err) {
    sky_keywords k;
    bool celestial = false;
    *map = NULL;
    TRY(sky_keywords_read(&k, cards, count, where, &celestial, err));
    if (!celestial)
        return SHEAR_OK;
    CLEANUP(sky_map_release) sky_map *m = calloc(1, sizeof *m);
    if (m == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    TRY(set_up(m, &k, where, err));
    *map = CLEANUP_TAKE(m);
    return SHEAR_OK;
}

/* Pairs of numbers for wcslib, and what it returns. */
typedef struct block {
    double in[BLOCK][2], out[BLOCK][2], intermediate[BLOCK][2];
    double phi[BLOCK], theta[BLOCK];
    int status[BLOCK]; /* 0: the position has a place */
} block;

static void to_sky(sky_map *map, int n, block *b) {
    const int code = wcsp2s(&map->wcs, n, 2, &b->in[0][0], &b->intermediate[0][0], b->phi, b->theta,
                            &b->out[0][0], b->status);
    for (int i = 0; i < n && code != 0 && code != WCSERR_BAD_PIX; i++)
        b->status[i] = 1;
}

static void to_pixel(sky_map *map, int n, block *b) {
    const int code = wcss2p(&map->wcs, n, 2, &b->in[0][0], b->phi, b->theta, &b->intermediate[0][0],
                            &b->out[0][0], b->status);
    for (int i = 0; i < n && code != 0 && code != WCSERR_BAD_WORLD; i++)
        b->status[i] = 1;
}

/* Return whether wcslib can be given these: it is not made for NaN and huge numbers. */
static bool is_pixel(double x, double y) {
    return fabs(x) < 1e9 && fabs(y) < 1e9;
}

static bool is_angle(double ra, double dec) {
    return fabs(ra) <= 720.0 && fabs(dec) <= 90.0;
}

/* Convert up to BLOCK pixels. */
static void block_to_sky(sky_map *map, int n, const double *x, const double *y, double *ra,
                         double *dec) {
    block b = {.status = {0}};
    for (int i = 0; i < n; i++) {
        const bool good = is_pixel(x[i], y[i]);
        b.in[i][0] = good ? x[i] : map->wcs.crpix[0];
        b.in[i][1] = good ? y[i] : map->wcs.crpix[1];
    }
    to_sky(map, n, &b);
    for (int i = 0; i < n; i++) {
        const double lng = b.out[i][map->lng], lat = b.out[i][map->lat];
        const bool good = is_pixel(x[i], y[i]) && b.status[i] == 0 && is_angle(lng, lat);
        ra[i] = good ? lng - 360.0 * floor(lng / 360.0) : NAN;
        dec[i] = good ? lat : NAN;
    }
}

/* wcslib's inversion of a polynomial may end elsewhere and not say so: a pixel counts if it leads
 * back to its place within 1e-8 degrees. */
static void check_pixels(sky_map *map, int n, const double *ra, const double *dec, double *x,
                         double *y) {
    double back_ra[BLOCK], back_dec[BLOCK];
    block_to_sky(map, n, x, y, back_ra, back_dec);
    for (int i = 0; i < n; i++) {
        double u = NAN, v = NAN;
        if (!sky_map_tangent(back_ra[i], back_dec[i], ra[i], dec[i], &u, &v) ||
            !(hypot(u, v) < 3600.0 * 1e-8)) {
            x[i] = y[i] = NAN;
        }
    }
}

static void block_to_pixel(sky_map *map, int n, const double *ra, const double *dec, double *x,
                           double *y) {
    block b = {.status = {0}};
    for (int i = 0; i < n; i++) {
        const bool good = is_angle(ra[i], dec[i]);
        b.in[i][map->lng] = good ? ra[i] : map->wcs.crval[map->lng];
        b.in[i][map->lat] = good ? dec[i] : map->wcs.crval[map->lat];
    }
    to_pixel(map, n, &b);
    for (int i = 0; i < n; i++) {
        const bool good = is_angle(ra[i], dec[i]) && b.status[i] == 0;
        x[i] = good ? b.out[i][0] : NAN;
        y[i] = good ? b.out[i][1] : NAN;
    }
    check_pixels(map, n, ra, dec, x, y);
}

typedef void convert_block(sky_map *map, int n, const double *a, const double *b, double *c,
                           double *d);

static void convert(convert_block *f, sky_map *map, int64_t n, const double *a, const double *b,
                    double *c, double *d) {
    for (int64_t i = 0; i < n; i += BLOCK)
        f(map, n - i < BLOCK ? (int)(n - i) : BLOCK, a + i, b + i, c + i, d + i);
}

void sky_map_to_sky(sky_map *map, int64_t n, const double *x, const double *y, double *ra,
                    double *dec) {
    convert(block_to_sky, map, n, x, y, ra, dec);
}

void sky_map_to_pixel(sky_map *map, int64_t n, const double *ra, const double *dec, double *x,
                      double *y) {
    convert(block_to_pixel, map, n, ra, dec, x, y);
}

/* Gnomonic projection. Differences of angles are taken first, so that small offsets are exact:
 * cos d0 sin d - sin d0 cos d cos a = sin(d - d0) + 2 sin d0 cos d sin^2(a/2). */
bool sky_map_tangent(double ra, double dec, double ra0, double dec0, double *u, double *v) {
    const double a = remainder(ra - ra0, 360.0) * radian, d = dec * radian, d0 = dec0 * radian;
    const double apart = (dec - dec0) * radian, s = 2.0 * sin(0.5 * a) * sin(0.5 * a);
    const double depth = cos(apart) - cos(d0) * cos(d) * s; /* cosine of the distance */
    *u = -cos(d) * sin(a) / depth * arcsec;
    *v = (sin(apart) + sin(d0) * cos(d) * s) / depth * arcsec;
    return depth > 0.0 && isfinite(*u) && isfinite(*v);
}

bool sky_map_jacobian(sky_map *map, double x, double y, double j[4]) {
    /* central differences over a pixel: their error is the third derivative over 24 */
    const double px[5] = {x, x + 0.5, x - 0.5, x, x}, py[5] = {y, y, y, y + 0.5, y - 0.5};
    double ra[5], dec[5], u[5] = {0}, v[5] = {0};
    sky_map_to_sky(map, 5, px, py, ra, dec);
    for (int i = 1; i < 5; i++) {
        if (!sky_map_tangent(ra[i], dec[i], ra[0], dec[0], &u[i], &v[i]))
            return false;
    }
    j[0] = u[1] - u[2];
    j[1] = u[3] - u[4];
    j[2] = v[1] - v[2];
    j[3] = v[3] - v[4];
    const double det = j[0] * j[3] - j[1] * j[2];
    const double norm = j[0] * j[0] + j[1] * j[1] + j[2] * j[2] + j[3] * j[3];
    return fabs(det) > 1e-6 * norm; /* no instrument's pixels are as long as that */
}
