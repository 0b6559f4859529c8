/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The points of mock galaxies: profile, inclination, random walk, rotation, lensing, seeds. */
#include "test_mock_fixture.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Zhang (2010), eq. (10), once more, with r in units of R_G. */
struct profile {
    double bulge_fraction, disk_scale, bulge_ratio;
    double total;
};

/* r f(r) dr with r = t^4: smooth, which the bulge's fourth root is not. */
static double ring(double t, void *context) {
    const struct profile *p = context;
    double r = t * t * t * t;
    double disk = r / p->disk_scale;
    double f = exp(-disk) + p->bulge_fraction * exp(-t * pow(p->bulge_ratio / p->disk_scale, 0.25));
    return 4.0 * t * t * t * r * f;
}

static double inner(double r, struct profile *p) {
    double value = 0.0;
    double error = 0.0;
    size_t n = 0;
    gsl_function f = {ring, p};
    gsl_integration_qng(&f, 0.0, pow(r, 0.25), 1e-9, 1e-6, &value, &error, &n);
    return value;
}

static double radial_cdf(double r, void *context) {
    struct profile *p = context;
    return inner(r, p) / p->total;
}

/* The radii of the points of `n` galaxies over R_G; *count points. */
static double *radii_of(const shear_mock *m, int n, size_t *count) {
    const shear_mock_spec *s = shear_mock_get_spec(m);
    int most = shear_mock_get_info(m)->max_points;
    double *x = doubles((size_t)most);
    double *y = doubles((size_t)most);
    double *r = doubles((size_t)most * (size_t)n);
    *count = 0;
    for (int i = 0; i < n; i++) {
        int points = shear_mock_points(m, i, x, y);
        for (int k = 0; k < points; k++)
            r[(*count)++] = hypot(x[k], y[k]) / s->r_gal_px;
    }
    free(x);
    free(y);
    return r;
}

static void check_profile(const char *fraction, const char *scale, const char *ratio) {
    shear_mock *m = MOCK("inclination", "0,0", "bulge-fraction", fraction, "disk-scale", scale,
                         "bulge-ratio", ratio);
    struct profile p = {atof(fraction), atof(scale), atof(ratio), 0.0};
    size_t n = 0;
    double *r = radii_of(m, 60, &n);
    assert_int_equal(n, 60 * 600);
    p.total = inner(1.0, &p);
    assert_true(ks_of(r, n, radial_cdf, &p) < 1.95); /* one in a thousand */
    /* ... and it can tell: another disk is excluded. */
    p.disk_scale *= 1.3;
    p.total = inner(1.0, &p);
    assert_true(ks_of(r, n, radial_cdf, &p) > 2.5);
    assert_true(r[n - 1] <= 1.0);
    free(r);
    shear_mock_free(m);
}

static void test_radial_profile(void **state) {
    (void)state;
    check_profile("0.3333333333333333", "1", "3"); /* the paper's */
    check_profile("0", "0.25", "3");               /* a pure disk */
    check_profile("5", "0.5", "10");               /* mostly bulge */
}

typedef struct second_moments {
    double xx, yy, xy;
} second_moments;

static second_moments second_moments_of(const shear_mock *m, int64_t galaxy) {
    second_moments q = {0};
    int most = shear_mock_get_info(m)->max_points;
    double *x = doubles((size_t)most);
    double *y = doubles((size_t)most);
    int n = shear_mock_points(m, galaxy, x, y);
    for (int k = 0; k < n; k++) {
        q.xx += x[k] * x[k] / n;
        q.yy += y[k] * y[k] / n;
        q.xy += x[k] * y[k] / n;
    }
    free(x);
    free(y);
    return q;
}

static void test_edge_on_is_a_line(void **state) {
    (void)state;
    shear_mock *m = MOCK("inclination", "90,90");
    for (int i = 0; i < 5; i++) {
        second_moments q = second_moments_of(m, i);
        assert_true(q.xx + q.yy > 1.0);
        assert_true(fabs(q.xx * q.yy - q.xy * q.xy) < 1e-12);
    }
    shear_mock_free(m);
}

/* Uniform angles: <(xx - yy)> = <xy> = 0, and the trace of an inclined disk is (1 + cos^2 i) / 2 of
 * a face-on one, with <cos^2 i> = 1/2 + sin(2 i_max) / (4 i_max) for i uniform in [0, i_max]. */
static void test_inclination_and_position_angle(void **state) {
    (void)state;
    enum { N = 600 };
    shear_mock *face = MOCK("inclination", "0,0", "points", "200");
    shear_mock *tilt = MOCK("inclination", "0,60", "points", "200");
    double trace0[N], trace[N], plus[N], cross[N];
    for (int i = 0; i < N; i++) {
        second_moments f = second_moments_of(face, i);
        second_moments t = second_moments_of(tilt, i);
        trace0[i] = f.xx + f.yy;
        trace[i] = t.xx + t.yy;
        plus[i] = t.xx - t.yy;
        cross[i] = 2.0 * t.xy;
    }
    double i_max = M_PI / 3.0;
    double expected = mean_of(trace0, N) * (1.5 + sin(2.0 * i_max) / (4.0 * i_max)) / 2.0;
    double error = sqrt((variance_of(trace, N) + variance_of(trace0, N)) / N);
    assert_close(mean_of(trace, N), expected, 4.0 * error);
    assert_true(mean_of(trace, N) < 0.95 * mean_of(trace0, N));
    assert_close(mean_of(plus, N), 0.0, 4.0 * sqrt(variance_of(plus, N) / N));
    assert_close(mean_of(cross, N), 0.0, 4.0 * sqrt(variance_of(cross, N) / N));
    assert_close(variance_of(plus, N) / variance_of(cross, N), 1.0, 0.35);
    shear_mock_free(face);
    shear_mock_free(tilt);
}

/* Each joint is one step from the one before, or from the origin, when the walk was sent back:
 * exactly as often as joints are missing (but for a last step that was). */
static void check_walk(const shear_mock *m, int64_t galaxy) {
    const shear_mock_spec *s = shear_mock_get_spec(m);
    double *x = doubles((size_t)s->steps);
    double *y = doubles((size_t)s->steps);
    int n = shear_mock_points(m, galaxy, x, y);
    int returns = 0;
    double px = 0.0;
    double py = 0.0;
    for (int k = 0; k < n; k++) {
        bool on = fabs(hypot(x[k] - px, y[k] - py) - s->step_px) < 1e-12;
        bool back = fabs(hypot(x[k], y[k]) - s->step_px) < 1e-12;
        assert_true(on || back);
        assert_true(hypot(x[k], y[k]) <= s->r_gal_px);
        returns += !on;
        px = x[k];
        py = y[k];
    }
    assert_in_range(s->steps - n, returns, returns + 1);
    assert_true(n > s->steps / 2);
    assert_true(returns > 0);
    free(x);
    free(y);
}

static void test_random_walk(void **state) {
    (void)state;
    shear_mock *m =
        MOCK("galaxy", "irregular", "steps", "1000", "step-size", "0.375", "r-gal", "3");
    for (int i = 0; i < 20; i++)
        check_walk(m, i);
    shear_mock_free(m);
}

/* Without a bound <r^2> after n steps is n step^2; the mean over k = 1..n is (n + 1) / 2 step^2. */
static void test_random_walk_is_diffusive(void **state) {
    (void)state;
    enum { N = 400 };
    shear_mock *m = MOCK("galaxy", "irregular", "steps", "100", "step-size", "0.1", "r-gal", "20");
    double r2[N];
    for (int i = 0; i < N; i++) {
        second_moments q = second_moments_of(m, i);
        r2[i] = q.xx + q.yy;
    }
    assert_close(mean_of(r2, N), 0.01 * 101.0 / 2.0, 4.0 * sqrt(variance_of(r2, N) / N));
    shear_mock_free(m);
}

/* Points of a stamp against the lensing law applied to the galaxy's points turned by `degrees`. */
static void check_image_points(const shear_mock *m, int64_t stamp, double degrees) {
    const shear_mock_spec *s = shear_mock_get_spec(m);
    double x[600], y[600], u[600], v[600];
    double a = degrees * M_PI / 180.0;
    int n = shear_mock_points(m, stamp / s->rotate, x, y);
    assert_int_equal(shear_mock_image_points(m, stamp, u, v), n);
    for (int k = 0; k < n; k++) {
        double p = cos(a) * x[k] - sin(a) * y[k];
        double q = sin(a) * x[k] + cos(a) * y[k];
        assert_close(u[k], (1.0 + s->g1) * p + s->g2 * q, 1e-13);
        assert_close(v[k], s->g2 * p + (1.0 - s->g1) * q, 1e-13);
    }
}

static void test_rotation_and_lensing(void **state) {
    (void)state;
    shear_mock *one = MOCK("rotate", "1", "shear", "0.1,-0.2");
    shear_mock *two = MOCK("rotate", "2", "shear", "0.1,-0.2");
    shear_mock *four = MOCK("rotate", "4", "shear", "0.1,-0.2");
    check_image_points(one, 3, 0.0);
    check_image_points(two, 6, 0.0);
    check_image_points(two, 7, 90.0);
    for (int i = 0; i < 4; i++)
        check_image_points(four, 8 + i, 45.0 * i);
    shear_mock_free(one);
    shear_mock_free(two);
    shear_mock_free(four);
}

static void check_seeds(const char *kind) {
    shear_mock *m = MOCK("galaxy", kind, "shear", "0.02,0.01", "seed", "5");
    shear_mock *same = MOCK("galaxy", kind, "shear", "-0.02,0", "seed", "5", "rotate", "4", "size",
                            "32", "white", "3", "r-psf", "1", "stamps", "7");
    shear_mock *other = MOCK("galaxy", kind, "shear", "0.02,0.01", "seed", "6");
    double x[1000], y[1000], u[1000], v[1000];
    int n = shear_mock_points(m, 3, x, y);
    size_t bytes = (size_t)n * sizeof *x;
    assert_int_equal(shear_mock_points(same, 3, u, v), n);
    assert_memory_equal(x, u, bytes);
    assert_memory_equal(y, v, bytes);
    shear_mock_points(other, 3, u, v);
    assert_true(x[0] != u[0] && x[1] != u[1]);
    shear_mock_points(m, 4, u, v);
    assert_true(x[0] != u[0] && x[1] != u[1]);
    shear_mock_free(m);
    shear_mock_free(same);
    shear_mock_free(other);
}

static void test_seeds(void **state) {
    (void)state;
    check_seeds("regular");
    check_seeds("irregular");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_radial_profile),
        cmocka_unit_test(test_edge_on_is_a_line),
        cmocka_unit_test(test_inclination_and_position_angle),
        cmocka_unit_test(test_random_walk),
        cmocka_unit_test(test_random_walk_is_diffusive),
        cmocka_unit_test(test_rotation_and_lensing),
        cmocka_unit_test(test_seeds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
