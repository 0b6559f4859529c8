/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sky_fixture.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180.0;

void sky_check_close(double a, double b, double tolerance, const char *what, const char *file,
                     int line) {
    if (fabs(a - b) <= tolerance)
        return;
    print_error("%s is %.17g, expected %.17g within %g\n", what, a, b, tolerance);
    _fail(file, line);
}

static int64_t find(const sky_header *h, const char *key) {
    char padded[48];
    snprintf(padded, sizeof padded, "%-8s", key);
    for (int64_t i = 0; i < h->n; i++) {
        if (memcmp(h->cards[i], padded, 8) == 0)
            return i;
    }
    return -1;
}

void sky_header_set(sky_header *h, const char *card) {
    char key[9] = "", line[128];
    sscanf(card, "%8[^ =]", key);
    int64_t i = find(h, key);
    if (i < 0)
        i = h->n++;
    assert_true(h->n <= SKY_FIXTURE_CARDS);
    snprintf(line, sizeof line, "%-80.80s", card);
    memcpy(h->cards[i], line, 80);
}

void sky_header_number(sky_header *h, const char *key, double value) {
    char card[81];
    snprintf(card, sizeof card, "%-8s= %.17g", key, value);
    sky_header_set(h, card);
}

void sky_header_remove(sky_header *h, const char *key) {
    const int64_t i = find(h, key);
    if (i >= 0) {
        memmove(h->cards[i], h->cards[i + 1], (size_t)(h->n - 1 - i) * 80);
        h->n--;
    }
}

sky_header sky_header_make(const char *type) {
    sky_header h = {.n = 0};
    char card[81];
    sky_header_set(&h, "SIMPLE  =                    T / a file");
    snprintf(card, sizeof card, "CTYPE1  = 'RA---%s' / axis 1", type);
    sky_header_set(&h, card);
    snprintf(card, sizeof card, "CTYPE2  = 'DEC--%s'", type);
    sky_header_set(&h, card);
    sky_header_set(&h, "CUNIT1  = 'deg     '");
    sky_header_number(&h, "CRVAL1", 150.1);
    sky_header_number(&h, "CRVAL2", 2.2);
    sky_header_number(&h, "CRPIX1", 1300.5);
    sky_header_number(&h, "CRPIX2", 1700.25);
    const double s = 0.26 / 3600.0, c = cos(20.0 * degree), d = sin(20.0 * degree);
    sky_header_number(&h, "CD1_1", -s * c);
    sky_header_number(&h, "CD1_2", s * d);
    sky_header_number(&h, "CD2_1", s * d);
    sky_header_number(&h, "CD2_2", s * c);
    return h;
}

void sky_header_add_tpv(sky_header *h) {
    char key[32];
    const double scale = 0.15; /* degrees to the corners */
    sky_header_number(h, "PV1_0", 1e-3);
    sky_header_number(h, "PV2_0", -2e-3);
    for (int i = 1; i <= 2; i++) {
        for (int m = 1; m < 40; m++) {
            const int power = m < 4    ? 1
                              : m < 7  ? 2
                              : m < 12 ? 3
                              : m < 17 ? 4
                              : m < 24 ? 5
                              : m < 31 ? 6
                                       : 7;
            double c = 0.004 * sin(3.7 * m + i) * pow(scale, 1 - power) / power;
            if (m == 3)
                c *= 1e-3; /* r has no derivative at the reference point */
            snprintf(key, sizeof key, "PV%d_%d", i, m);
            sky_header_number(h, key, m == 1 ? 1.01 + c : c);
        }
    }
}

void sky_header_add_sip(sky_header *h) {
    char key[32];
    for (int i = 0; i < 2; i++) {
        snprintf(key, sizeof key, "%c_ORDER", "AB"[i]);
        sky_header_number(h, key, 4);
        for (int p = 0; p <= 4; p++) {
            for (int q = p < 2 ? 2 - p : 0; p + q <= 4; q++) {
                snprintf(key, sizeof key, "%c_%d_%d", "AB"[i], p, q);
                sky_header_number(h, key, 8.0 * sin(2.3 * p + 5.1 * q + i) * pow(2000.0, -(p + q)));
            }
        }
    }
}

sky_map *sky_fixture_map(const sky_header *h) {
    shear_error err = {0};
    sky_map *map = NULL;
    if (sky_map_new(&map, h->cards[0], h->n, "file 'f.fits', HDU 1", &err) != SHEAR_OK)
        fail_msg("refused: %s", err.message);
    assert_non_null(map);
    return map;
}

void sky_fixture_refuse(const sky_header *h, int code, ...) {
    shear_error err = {0};
    sky_map *map = NULL;
    assert_int_equal(sky_map_new(&map, h->cards[0], h->n, "file 'f.fits', HDU 1", &err), code);
    assert_null(map);
    assert_non_null(strstr(err.message, "file 'f.fits', HDU 1: "));
    va_list words;
    va_start(words, code);
    for (const char *w = va_arg(words, const char *); w != NULL; w = va_arg(words, const char *)) {
        if (strstr(err.message, w) == NULL && strstr(err.advice, w) == NULL)
            fail_msg("'%s' is not in '%s' (%s)", w, err.message, err.advice);
    }
    va_end(words);
}

/* The number of a keyword, or `absent`. */
static double number(const sky_header *h, const char *key, double absent) {
    const int64_t i = find(h, key);
    char value[71] = "";
    if (i < 0)
        return absent;
    memcpy(value, h->cards[i] + 10, 70);
    return strtod(value, NULL);
}

/* The number of a keyword such as CD1_2. */
static double indexed(const sky_header *h, const char *root, int i, int j, double absent) {
    char key[32];
    snprintf(key, sizeof key, "%s%d_%d", root, i, j);
    return number(h, key, absent);
}

static bool type_has(const sky_header *h, const char *word) {
    const int64_t i = find(h, "CTYPE1");
    char card[81] = "";
    memcpy(card, h->cards[i], 80);
    return strstr(card, word) != NULL;
}

/* The terms of TPV in their order. */
static double tpv(const sky_header *h, int axis, double x, double y) {
    double sum = indexed(h, "PV", axis, 0, 0.0);
    int m = 1;
    for (int power = 1; power <= 7; power++) {
        for (int q = 0; q <= power; q++, m++)
            sum += indexed(h, "PV", axis, m, m == 1 ? 1.0 : 0.0) * pow(x, power - q) * pow(y, q);
        if (power % 2 == 1)
            sum += indexed(h, "PV", axis, m++, 0.0) * pow(hypot(x, y), power);
    }
    return sum;
}

static double sip(const sky_header *h, char letter, double x, double y) {
    double sum = 0.0;
    for (int p = 0; p < 10; p++) {
        for (int q = 0; p + q < 10; q++)
            sum += indexed(h, letter == 'A' ? "A_" : "B_", p, q, 0.0) * pow(x, p) * pow(y, q);
    }
    return sum;
}

/* Compute the unit vectors to a place, and to its East and North. */
static void vectors(double ra, double dec, double r[3], double east[3], double north[3]) {
    const double a = ra * degree, d = dec * degree;
    const double all[3][3] = {{cos(d) * cos(a), cos(d) * sin(a), sin(d)},
                              {-sin(a), cos(a), 0.0},
                              {-sin(d) * cos(a), -sin(d) * sin(a), cos(d)}};
    memcpy(r, all[0], sizeof all[0]);
    memcpy(east, all[1], sizeof all[1]);
    memcpy(north, all[2], sizeof all[2]);
}

/* Compute the unit vector to a pixel. */
static void look(const sky_header *h, double x, double y, double r[3]) {
    double p = x - number(h, "CRPIX1", 0.0), q = y - number(h, "CRPIX2", 0.0);
    if (type_has(h, "-SIP")) {
        const double f = sip(h, 'A', p, q), g = sip(h, 'B', p, q);
        p += f;
        q += g;
    }
    double w[2], crval[2] = {number(h, "CRVAL1", 0.0), number(h, "CRVAL2", 0.0)};
    for (int i = 0; i < 2; i++)
        w[i] = indexed(h, "CD", i + 1, 1, 0.0) * p + indexed(h, "CD", i + 1, 2, 0.0) * q;
    if (!type_has(h, "-SIP") && find(h, "PV1_1") >= 0) {
        const double f = tpv(h, 1, w[0], w[1]), g = tpv(h, 2, w[1], w[0]);
        w[0] = f;
        w[1] = g;
    }
    const int lng = type_has(h, "DEC--") ? 1 : 0;
    double r0[3], east[3], north[3], norm = 0.0;
    vectors(crval[lng], crval[1 - lng], r0, east, north);
    for (int i = 0; i < 3; i++) {
        r[i] = r0[i] + w[lng] * degree * east[i] + w[1 - lng] * degree * north[i];
        norm += r[i] * r[i];
    }
    for (int i = 0; i < 3; i++)
        r[i] /= sqrt(norm);
}

void sky_oracle(const sky_header *h, double x, double y, double *ra, double *dec) {
    double r[3];
    look(h, x, y, r);
    *ra = atan2(r[1], r[0]) / degree;
    if (*ra < 0.0)
        *ra += 360.0;
    *dec = atan2(r[2], hypot(r[0], r[1])) / degree;
}

double sky_distance(double ra, double dec, double ra0, double dec0) {
    double r[3], r0[3], e[3], n[3], sum = 0.0;
    vectors(ra, dec, r, e, n);
    vectors(ra0, dec0, r0, e, n);
    for (int i = 0; i < 3; i++)
        sum += (r[i] - r0[i]) * (r[i] - r0[i]);
    return 2.0 * asin(0.5 * sqrt(sum)) / degree;
}

void sky_oracle_jacobian(const sky_header *h, double x, double y, double j[4]) {
    const double arcsec = 3600.0 / degree, step = 0.25;
    double ra, dec, r[3], east[3], north[3], a[3], b[3];
    sky_oracle(h, x, y, &ra, &dec);
    vectors(ra, dec, r, east, north);
    for (int axis = 0; axis < 2; axis++) {
        const double dx = axis == 0 ? step : 0.0, dy = step - dx;
        look(h, x + dx, y + dy, a);
        look(h, x - dx, y - dy, b);
        j[axis] = j[2 + axis] = 0.0;
        for (int i = 0; i < 3; i++) {
            j[axis] -= (a[i] - b[i]) * east[i] / (2.0 * step) * arcsec;
            j[2 + axis] += (a[i] - b[i]) * north[i] / (2.0 * step) * arcsec;
        }
    }
}
