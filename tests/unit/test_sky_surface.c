/* SPDX-License-Identifier: GPL-3.0-or-later */
/* TNX and ZPX: polynomials of all kinds against sums of this file; how their text may lie in cards;
 * texts that are wrong. */
#include "sky_fixture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum kind { CHEBYSHEV = 1, LEGENDRE, MONOMIAL };
enum cross { NO_CROSS = 0, FULL_CROSS, HALF_CROSS };

typedef struct surface {
    int kind, nx, ny, cross;
} surface;

/* The polynomial's range, degrees; and its coefficients, of which some are 0. */
static const double range[4] = {-0.3, 0.2, -0.1, 0.4};

static double coefficient(int axis, int m, int n) {
    const double size = 2e-3 * pow(1.0 + m + n, -3.0);
    return (m + 2 * n + axis) % 4 == 0 ? 0.0 : size * sin(1.0 + 3.0 * axis + 5.0 * m + 7.0 * n);
}

static int is_in(const surface *s, int m, int n) {
    const int most = s->nx > s->ny ? s->nx : s->ny;
    return s->cross == FULL_CROSS || (s->cross == HALF_CROSS && m + n < most) || m == 0 || n == 0;
}

/* Put the text into cards of 68 characters; blanks at their ends may be `trimmed`. */
static void set_text(sky_header *h, int axis, const char *text, int trimmed) {
    char card[128], piece[69];
    for (int i = 0; 68 * i < (int)strlen(text); i++) {
        snprintf(piece, sizeof piece, "%.68s", text + (ptrdiff_t)68 * i);
        for (size_t n = strlen(piece); trimmed && n > 0 && piece[n - 1] == ' '; n--)
            piece[n - 1] = '\0';
        snprintf(card, sizeof card, "WAT%d_%03d= '%s'", axis + 1, i + 1, piece);
        sky_header_set(h, card);
    }
}

static void set_surface(sky_header *h, int axis, const surface *s, const char *type, int trimmed) {
    char text[6000];
    int n = snprintf(text, sizeof text, "wtype=%s axtype=%s %scor = \"%d. %d. %d. %d. ", type,
                     axis == 0 ? "ra" : "dec", axis == 0 ? "lng" : "lat", s->kind, s->nx, s->ny,
                     s->cross);
    for (int i = 0; i < 4; i++)
        n += snprintf(text + n, sizeof text - (size_t)n, "%.16g ", range[i]);
    for (int j = 0; j < s->ny; j++) {
        for (int i = 0; i < s->nx; i++) {
            if (is_in(s, i, j))
                n += snprintf(text + n, sizeof text - (size_t)n, "%.16g ", coefficient(axis, i, j));
        }
    }
    snprintf(text + n, sizeof text - (size_t)n, "\" ");
    set_text(h, axis, text, trimmed);
}

/* The polynomial of degree n, in the variable that it is a polynomial of. */
static double value(int kind, int n, double x) {
    if (kind == MONOMIAL)
        return pow(x, n);
    if (kind == CHEBYSHEV)
        return fabs(x) <= 1.0 ? cos(n * acos(x))
                              : pow(x < 0.0 ? -1.0 : 1.0, n) * cosh(n * acosh(fabs(x)));
    double before = 0.0, now = 1.0;
    for (int k = 1; k <= n; k++) {
        const double next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
        before = now;
        now = next;
    }
    return now;
}

static double correction(const surface *s, int axis, double x, double y) {
    double sum = 0.0;
    if (s->kind != MONOMIAL) {
        x = (2.0 * x - range[1] - range[0]) / (range[1] - range[0]);
        y = (2.0 * y - range[3] - range[2]) / (range[3] - range[2]);
    }
    for (int m = 0; m < s->nx; m++) {
        for (int n = 0; n < s->ny; n++) {
            if (is_in(s, m, n))
                sum += coefficient(axis, m, n) * value(s->kind, m, x) * value(s->kind, n, y);
        }
    }
    return sum;
}

/* The place of a pixel of the chip: that of the pixel of the plain TAN where the corrected
 * coordinates lie. */
static void place(const surface s[2], double x, double y, double *ra, double *dec) {
    const sky_header plain = sky_header_make("TAN");
    const double scale = 0.26 / 3600.0, c = cos(20.0 * acos(-1.0) / 180.0), d = sqrt(1.0 - c * c);
    const double p = (x - 1300.5) * scale, q = (y - 1700.25) * scale;
    const double xi = -c * p + d * q, eta = d * p + c * q;
    const double a = xi + correction(&s[0], 0, xi, eta), b = eta + correction(&s[1], 1, xi, eta);
    sky_oracle(&plain, 1300.5 + (-c * a + d * b) / scale, 1700.25 + (d * a + c * b) / scale, ra,
               dec);
}

static void check(const surface s[2], int trimmed) {
    sky_header h = sky_header_make("TNX");
    for (int axis = 0; axis < 2; axis++)
        set_surface(&h, axis, &s[axis], "tnx", trimmed);
    sky_map *map = sky_fixture_map(&h);
    for (int i = 0; i < 36; i++) {
        const double x = 400.0 * (i % 6), y = 800.0 * (double)(i / 6);
        double ra, dec, a, d, xx, yy;
        place(s, x, y, &a, &d);
        sky_map_to_sky(map, 1, &x, &y, &ra, &dec);
        assert_true(sky_distance(ra, dec, a, d) < 1e-12);
        sky_map_to_pixel(map, 1, &ra, &dec, &xx, &yy);
        assert_close(xx, x, 1e-7);
        assert_close(yy, y, 1e-7);
    }
    sky_map_free(map);
}

static void all_kinds(void **state) {
    (void)state;
    for (int kind = CHEBYSHEV; kind <= MONOMIAL; kind++) {
        for (int cross = NO_CROSS; cross <= HALF_CROSS; cross++) {
            const surface s[2] = {{kind, 4, 4, cross}, {kind, 2, 5, cross}};
            check(s, cross == FULL_CROSS);
        }
    }
    const surface mixed[2] = {{MONOMIAL, 1, 1, FULL_CROSS}, {CHEBYSHEV, 10, 10, HALF_CROSS}};
    check(mixed, 1);
}

/* ZPX with projp1 = 1, projp3 = 40: the radius is z + 40 z^3 at the distance z. */
static void zpx_by_formula(void **state) {
    (void)state;
    const double degree = acos(-1.0) / 180.0, scale = 0.26 / 3600.0;
    sky_header h = sky_header_make("ZPX");
    const sky_header plain = sky_header_make("TAN");
    set_text(&h, 0, "wtype=zpx axtype=ra projp1=1.0 projp3=40.", 0);
    set_text(&h, 1, "wtype=zpx axtype=dec projp1=1.0 projp3=40.", 0);
    sky_map *map = sky_fixture_map(&h);
    for (int i = 0; i < 50; i++) {
        const double x = 1300.5 + 900.0 * cos(i), y = 1700.25 + 60.0 * i * sin(i);
        const double radius = hypot(x - 1300.5, y - 1700.25) * scale * degree;
        double z = radius, ra, dec, a, d;
        for (int k = 0; k < 20; k++)
            z -= (z + 40.0 * z * z * z - radius) / (1.0 + 120.0 * z * z);
        const double part = tan(z) / radius; /* of the plain TAN's radius */
        sky_oracle(&plain, 1300.5 + (x - 1300.5) * part, 1700.25 + (y - 1700.25) * part, &a, &d);
        sky_map_to_sky(map, 1, &x, &y, &ra, &dec);
        assert_true(sky_distance(ra, dec, a, d) < 1e-11);
    }
    sky_map_free(map);
}

static void refuse(const char *text, const char *word) {
    const surface good = {MONOMIAL, 2, 2, FULL_CROSS};
    sky_header h = sky_header_make("TNX");
    set_surface(&h, 0, &good, "tnx", 0);
    set_text(&h, 1, text, 0);
    sky_fixture_refuse(&h, SHEAR_E_FORMAT, "WAT2_001", word, NULL);
}

static void what_is_wrong(void **state) {
    (void)state;
    refuse("", "missing");
    refuse("wtype=tnx latcor = 3. 2. 2. 1. 0 1 0 1 1 1 1 1", "quotes");
    refuse("wtype=tnx latcor = \"4. 2. 2. 1. 0 1 0 1 1 1 1 1\"", "kind");
    refuse("wtype=tnx latcor = \"3. 1000000000. 2. 1. 0 1 0 1 1 1 1 1\"", "orders");
    refuse("wtype=tnx latcor = \"3. -5. 2. 1. 0 1 0 1 1 1 1 1\"", "orders");
    refuse("wtype=tnx latcor = \"3. 2. 2. 7. 0 1 0 1 1 1 1 1\"", "cross");
    refuse("wtype=tnx latcor = \"1. 2. 2. 1. 5 5 0 1 1 1 1 1\"", "range");
    refuse("wtype=tnx latcor = \"3. 2. 2. 1. 0 1 0 1 1 nan 1 1\"", "coefficients");
    refuse("wtype=tnx latcor = \"3. 2. 2. 1. 0 1 0 1 1 1 1\"", "coefficients");
    refuse("wtype=tnx latcor = \"3. 10. 10. 1. 0 1 0 1 1", "coefficients");
    refuse("wtype=zpx projp99=5", "projp");
    refuse("wtype=zpx projp1=x", "projp");
    /* texts for which there were too few letters in wcslib's arrays */
    char text[1000] = "wtype=";
    memset(text + 6, 'a', 900);
    sky_header h = sky_header_make("TNX");
    set_text(&h, 0, text, 0);
    set_text(&h, 1, text, 0);
    sky_map_free(sky_fixture_map(&h));
    sky_header_set(&h, "WAT1_065= 'x'");
    sky_fixture_refuse(&h, SHEAR_E_FORMAT, "too many cards", NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_kinds),
        cmocka_unit_test(zpx_by_formula),
        cmocka_unit_test(what_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
