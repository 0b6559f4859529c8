/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Positions and Jacobians against formulas: TAN, TPV and SIP, axes exchanged, poles, RA 0; and what
 * has no place. */
#include "base/thread.h"
#include "sky_fixture.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { N = 400 };

/* Positions over the chip, and a little beyond. */
static void positions(double x[N], double y[N]) {
    for (int i = 0; i < N; i++) {
        x[i] = -20.0 + 2060.0 * (i % 20) / 19.0;
        y[i] = -20.0 + 4060.0 * (double)(i / 20) / 19.0;
    }
}

/* The map agrees with the formulas, there and back; and so do its Jacobians. */
static void check(const sky_header *h) {
    double x[N], y[N], ra[N], dec[N], xx[N], yy[N];
    sky_map *map = sky_fixture_map(h);
    positions(x, y);
    sky_map_to_sky(map, N, x, y, ra, dec);
    sky_map_to_pixel(map, N, ra, dec, xx, yy);
    for (int i = 0; i < N; i++) {
        double a, d, j[4], jj[4];
        sky_oracle(h, x[i], y[i], &a, &d);
        assert_true(ra[i] >= 0.0 && ra[i] < 360.0);
        assert_true(sky_distance(ra[i], dec[i], a, d) < 1e-12);
        assert_true(fabs(xx[i] - x[i]) < 1e-7 && fabs(yy[i] - y[i]) < 1e-7);
        assert_true(sky_map_jacobian(map, x[i], y[i], j));
        sky_oracle_jacobian(h, x[i], y[i], jj);
        for (int k = 0; k < 4; k++)
            assert_close(j[k], jj[k], 2e-8);
    }
    sky_map_free(map);
}

static void tan_by_formula(void **state) {
    (void)state;
    const sky_header h = sky_header_make("TAN");
    check(&h);
    /* at the reference pixel, the Jacobian is CD itself, and u is minus xi */
    sky_map *map = sky_fixture_map(&h);
    double j[4];
    const double s = 0.26, c = cos(20.0 * acos(-1.0) / 180.0), d = sqrt(1.0 - c * c);
    assert_true(sky_map_jacobian(map, 1300.5, 1700.25, j));
    assert_close(j[0], s * c, 1e-9);
    assert_close(j[1], -s * d, 1e-9);
    assert_close(j[2], s * d, 1e-9);
    assert_close(j[3], s * c, 1e-9);
    sky_map_free(map);
}

static void tpv_by_formula(void **state) {
    (void)state;
    sky_header h = sky_header_make("TPV");
    sky_header_add_tpv(&h);
    check(&h);
    /* SCAMP calls it TAN */
    sky_header_set(&h, "CTYPE1  = 'RA---TAN'");
    sky_header_set(&h, "CTYPE2  = 'DEC--TAN'");
    check(&h);
}

static void sip_by_formula(void **state) {
    (void)state;
    sky_header h = sky_header_make("TAN-SIP");
    sky_header_add_sip(&h);
    check(&h);
    /* coefficients of both kinds: SIP counts, as CTYPE says */
    sky_header_add_tpv(&h);
    check(&h);
}

static void axes_may_be_exchanged(void **state) {
    (void)state;
    for (int distorted = 0; distorted < 2; distorted++) {
        sky_header h = sky_header_make("TPV");
        sky_header_set(&h, "CTYPE1  = 'DEC--TPV'");
        sky_header_set(&h, "CTYPE2  = 'RA---TPV'");
        sky_header_number(&h, "CRVAL1", -42.0);
        sky_header_number(&h, "CRVAL2", 200.0);
        if (distorted)
            sky_header_add_tpv(&h);
        check(&h);
    }
}

/* RA runs over 360 degrees, and around a pole, within the chip. */
static void no_place_is_special(void **state) {
    (void)state;
    const double places[][2] = {{0.01, 10.0},    {359.99, -10.0}, {33.0, 89.99},
                                {250.0, -89.99}, {-10.0, 45.0},   {360.0, 45.0}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        for (int distorted = 0; distorted < 2; distorted++) {
            sky_header h = sky_header_make("TPV");
            sky_header_number(&h, "CRVAL1", places[i][0]);
            sky_header_number(&h, "CRVAL2", places[i][1]);
            if (distorted)
                sky_header_add_tpv(&h);
            check(&h);
        }
    }
}

/* CD, PC with CDELT, and CROTA2 with CDELT are the same map (CDELT1 is negative). */
static void forms_of_the_matrix_agree(void **state) {
    (void)state;
    const double s = 0.26 / 3600.0, angle = 20.0;
    sky_header cd = sky_header_make("TAN");
    sky_header pc = cd, crota = cd;
    const char *const keys[] = {"CD1_1", "CD1_2", "CD2_1", "CD2_2"};
    const double turn[2] = {cos(angle * acos(-1.0) / 180.0), sin(angle * acos(-1.0) / 180.0)};
    const double matrix[] = {turn[0], turn[1], -turn[1], turn[0]};
    for (int i = 0; i < 4; i++) {
        char key[32];
        sky_header_number(&cd, keys[i], matrix[i] * (i < 2 ? -s : s));
        sky_header_remove(&pc, keys[i]);
        sky_header_remove(&crota, keys[i]);
        snprintf(key, sizeof key, i % 2 == 0 ? "PC%d_%d" : "PC00%d00%d", i / 2 + 1, i % 2 + 1);
        sky_header_number(&pc, key, matrix[i]);
    }
    sky_header_number(&pc, "CDELT1", -s);
    sky_header_number(&pc, "CDELT2", s);
    sky_header_number(&crota, "CDELT1", -s);
    sky_header_number(&crota, "CDELT2", s);
    sky_header_number(&crota, "CROTA2", angle);
    /* old headers have CD with CDELT and CROTA2 that mean nothing */
    sky_header_number(&cd, "CDELT1", 77.0);
    sky_header_number(&cd, "CROTA2", 7.0);
    const sky_header *const all[] = {&cd, &pc, &crota};
    double x = 17.0, y = 3000.0, ra[3], dec[3];
    for (int i = 0; i < 3; i++) {
        sky_map *map = sky_fixture_map(all[i]);
        sky_map_to_sky(map, 1, &x, &y, &ra[i], &dec[i]);
        assert_true(sky_distance(ra[i], dec[i], ra[0], dec[0]) < 1e-12);
        sky_map_free(map);
    }
}

static void what_has_no_place_is_nan(void **state) {
    (void)state;
    const sky_header h = sky_header_make("TAN");
    sky_map *map = sky_fixture_map(&h);
    double x[] = {1.0, NAN, INFINITY, 1e300, 5.0, -1e10, 7.0};
    double y[] = {1.0, 1.0, 1.0, 1.0, NAN, 1.0, 7.0};
    double ra[7], dec[7], j[4];
    sky_map_to_sky(map, 7, x, y, ra, dec);
    for (int i = 0; i < 7; i++) {
        assert_true(isnan(ra[i]) == (i >= 1 && i <= 5) && isnan(ra[i]) == isnan(dec[i]));
        assert_true(sky_map_jacobian(map, x[i], y[i], j) == !isnan(ra[i]));
    }
    /* the other side of the sky, and what is no angle */
    double a[] = {150.1, 330.1, 150.1, NAN, 150.1, 1e300, 150.1 - 360.0};
    double d[] = {2.2, -2.2, 91.0, 2.2, INFINITY, 2.2, 2.2};
    double p[7], q[7];
    sky_map_to_pixel(map, 7, a, d, p, q);
    for (int i = 0; i < 7; i++)
        assert_true(isnan(p[i]) == (i >= 1 && i <= 5) && isnan(p[i]) == isnan(q[i]));
    assert_close(p[0], 1300.5, 1e-8);
    assert_close(p[6], 1300.5, 1e-8);
    sky_map_free(map);
}

/* Many positions at once are the same, to the bit, as each alone. */
static void blocks_do_not_matter(void **state) {
    (void)state;
    sky_header h = sky_header_make("TPV");
    sky_header_add_tpv(&h);
    sky_map *map = sky_fixture_map(&h);
    double x[N], y[N], ra[N], dec[N], xx[N], yy[N];
    positions(x, y);
    x[7] = NAN;
    sky_map_to_sky(map, N, x, y, ra, dec);
    sky_map_to_pixel(map, N, ra, dec, xx, yy);
    for (int i = 0; i < N; i++) {
        double a, d, p, q;
        sky_map_to_sky(map, 1, &x[i], &y[i], &a, &d);
        sky_map_to_pixel(map, 1, &a, &d, &p, &q);
        assert_memory_equal(&a, &ra[i], sizeof a);
        assert_memory_equal(&d, &dec[i], sizeof d);
        assert_memory_equal(&p, &xx[i], sizeof p);
        assert_memory_equal(&q, &yy[i], sizeof q);
    }
    sky_map_free(map);
}

static void tangent_by_formula(void **state) {
    (void)state;
    const double degree = acos(-1.0) / 180.0;
    double u, v;
    for (int i = 0; i < 1000; i++) {
        const double ra0 = 0.36 * i, dec0 = 89.0 * sin(i), ra = ra0 + 20.0 * sin(7.0 * i) + 360.0;
        const double dec = fmax(-89.0, fmin(89.0, dec0 + 20.0 * cos(11.0 * i)));
        const double a = (ra - ra0) * degree, d = dec * degree, d0 = dec0 * degree;
        const double depth = sin(d0) * sin(d) + cos(d0) * cos(d) * cos(a);
        assert_true(sky_map_tangent(ra, dec, ra0, dec0, &u, &v) == (depth > 0.0));
        if (depth <= 0.0)
            continue;
        const double unit = 3600.0 / degree / depth;
        assert_close(u, -cos(d) * sin(a) * unit, 1e-6);
        assert_close(v, (cos(d0) * sin(d) - sin(d0) * cos(d) * cos(a)) * unit, 1e-6);
    }
    /* a microarcsecond keeps its digits; u is to the West, also over RA 0 */
    assert_true(sky_map_tangent(1e-10 / 3.6, 0.0, 0.0, 0.0, &u, &v));
    assert_close(u, -1e-7, 1e-15);
    assert_true(sky_map_tangent(359.0, 10.0, 1.0, 10.0, &u, &v) && u > 0.0);
    assert_true(sky_map_tangent(10.0, 11.0, 10.0, 10.0, &u, &v) && v > 0.0);
    assert_false(sky_map_tangent(10.0, -80.0, 190.0, 80.0 - 1e-9, &u, &v));
    assert_false(sky_map_tangent(NAN, 0.0, 0.0, 0.0, &u, &v));
}

/* Threads make, use and free maps of their own at the same time. */
static void *make_and_use(void *argument) {
    bool *const same = argument;
    for (int round = 0; round < 60; round++) {
        sky_header h = sky_header_make(round % 2 == 0 ? "TPV" : "TAN-SIP");
        if (round % 2 == 0) {
            sky_header_add_tpv(&h);
        } else {
            sky_header_add_sip(&h);
        }
        shear_error err;
        sky_map *map = NULL;
        *same = *same && sky_map_new(&map, h.cards[0], h.n, "f", &err) == SHEAR_OK;
        for (int i = 0; *same && i < 40; i++) {
            const double x = 50.0 * i, y = 100.0 * i;
            double ra, dec, a, d;
            sky_map_to_sky(map, 1, &x, &y, &ra, &dec);
            sky_oracle(&h, x, y, &a, &d);
            *same = sky_distance(ra, dec, a, d) < 1e-12;
        }
        sky_map_free(map);
    }
    return NULL;
}

static void threads_do_not_meet(void **state) {
    (void)state;
    enum { THREADS = 4 };
    pthread_t threads[THREADS];
    bool same[THREADS];
    for (int i = 0; i < THREADS; i++) {
        same[i] = true;
        assert_int_equal(thread_start(&threads[i], make_and_use, &same[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        assert_true(same[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tan_by_formula),           cmocka_unit_test(tpv_by_formula),
        cmocka_unit_test(sip_by_formula),           cmocka_unit_test(axes_may_be_exchanged),
        cmocka_unit_test(no_place_is_special),      cmocka_unit_test(forms_of_the_matrix_agree),
        cmocka_unit_test(what_has_no_place_is_nan), cmocka_unit_test(blocks_do_not_matter),
        cmocka_unit_test(tangent_by_formula),       cmocka_unit_test(threads_do_not_meet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
