/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stamps that are sharper than their PSF: D of point sources in closed form, its error from noise,
 * and the counts of a field. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "shear/sums.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 64, PSF = 33 };
static const double R_PSF = 1.5;

static gaussian round_gaussian(double r, double x) {
    return (gaussian){.amplitude = 1.0 / (r * r), .xx = r * r, .yy = r * r, .x0 = x, .y0 = x};
}

/* A Gaussian source of radius s behind a PSF of radius R_PSF, of which the plan has one that is
 * `broad` times as large. */
static void draw_source(pair *p, double s, double broad) {
    const gaussian source = round_gaussian(hypot(R_PSF, s), 31.4);
    const gaussian psf = round_gaussian(broad * R_PSF, 16.0);
    pair_init(p, SIDE, SIDE, PSF, PSF, 1);
    gaussian_draw(&source, SIDE, SIDE, 1, p->galaxy);
    gaussian_draw(&psf, PSF, PSF, 1, p->psf);
}

static shear_block_sums block_of(const shear_row *row) {
    shear_block_sums b;
    shear_block_sums_init(&b);
    shear_block_sums_add(&b, row);
    return b;
}

/* D/(M20 + M02) is (s^2 - delta)/(beta^2 + s^2 - delta), delta what the PSF's variance is too
 * large by: 0 for a point source and the right PSF. */
static void d_of_gaussians(void **state) {
    (void)state;
    static const double sizes[] = {0.0, 0.3, 0.7, 1.5};
    static const double broad[] = {0.9, 1.0, 1.02, 1.05, 1.1, 1.2};
    for (int i = 0; i < 24; i++) {
        pair p;
        shear_plan_info info;
        const double s2 = sizes[i % 4] * sizes[i % 4];
        const double delta = R_PSF * R_PSF * (broad[i / 4] * broad[i / 4] - 1.0);
        draw_source(&p, sizes[i % 4], broad[i / 4]);
        const shear_row row = pair_measure_info(&p, &info);
        const double beta2 = info.beta_px * info.beta_px;
        const double part = (s2 - delta) / (beta2 + s2 - delta);
        assert_near(row.d / (row.m20 + row.m02), part, 1e-6, 1.0, "D over M20 + M02");
        assert_true(row.d_err == 0.0); /* there is no noise */
        const shear_block_sums b = block_of(&row);
        assert_true(b.hi[SHEAR_S_BRIGHT] == 1.0);
        assert_true(b.hi[SHEAR_S_SHARP] == (part < -0.02 ? 1.0 : 0.0));
        pair_deinit(&p);
    }
}

static double gauss(uint64_t *seed) {
    const double u = 1.0 - uniform(seed);
    return sqrt(-2.0 * log(u)) * cos(2.0 * M_PI * uniform(seed));
}

/* Measure n times the pair's galaxy in new white noise. */
static void measure_in_noise(const pair *p, double noise, shear_row *rows, int n) {
    static double galaxy[SIDE * SIDE];
    static double beside[SIDE * SIDE];
    const shear_plan_request request = {
        .settings = &p->settings, .geometry = p->geometry, .psf = p->psf};
    const shear_stamps stamps = {
        .count = 1, .nx = SIDE, .ny = SIDE, .galaxy = galaxy, .noise = beside};
    uint64_t seed = 17;
    shear_plan *plan = NULL;
    shear_workspace *ws = NULL;
    assert_int_equal(shear_plan_new(&plan, &request, NULL), SHEAR_OK);
    assert_int_equal(shear_workspace_new(&ws, plan, NULL), SHEAR_OK);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < SIDE * SIDE; j++) {
            galaxy[j] = p->galaxy[j] + noise * gauss(&seed);
            beside[j] = noise * gauss(&seed);
        }
        assert_int_equal(shear_measure(plan, ws, &stamps, 0, &rows[i], NULL), SHEAR_OK);
    }
    shear_workspace_free(ws);
    shear_plan_free(plan);
}

/* Return the scatter of D of a point source in white noise, over d_err's mean. */
static double scatter(const char *filter, const char *beta_ratio) {
    enum { N = 600 };
    static shear_row rows[N];
    double sum = 0.0;
    double square = 0.0;
    double err = 0.0;
    pair p;
    draw_source(&p, 0.0, 1.0);
    pair_set(&p, "filter", filter);
    pair_set(&p, "beta-ratio", beta_ratio);
    measure_in_noise(&p, 2e-3, rows, N);
    for (int i = 0; i < N; i++) {
        sum += rows[i].d;
        square += rows[i].d * rows[i].d;
        err += rows[i].d_err;
    }
    pair_deinit(&p);
    return sqrt(square / N - sum / N * (sum / N)) / (err / N);
}

static void d_err_is_the_scatter(void **state) {
    (void)state;
    assert_near(scatter("none", "2"), 1.0, 0.12, 1.0, "without a filter");
    assert_near(scatter("edge", "2"), 1.0, 0.15, 1.0, "with a filter");
    assert_near(scatter("none", "1.6"), 1.0, 0.12, 1.0, "another beta");
}

/* Without the noise's correction, or where noise has much to say, no stamp is bright. */
static void faint_stamps_do_not_count(void **state) {
    (void)state;
    static const shear_row bright = {
        .m20 = 1.0, .m02 = 1.0, .d = -0.2, .d_err = 0.01, .noise_d = -0.01, .weight = 1.0};
    shear_row row = bright;
    assert_true(block_of(&row).hi[SHEAR_S_SHARP] == 1.0);
    row.d_err = NAN;
    assert_true(block_of(&row).hi[SHEAR_S_BRIGHT] == 0.0);
    row.d_err = 0.041;
    assert_true(block_of(&row).hi[SHEAR_S_BRIGHT] == 0.0);
    row = bright;
    row.noise_d = -0.05;
    assert_true(block_of(&row).hi[SHEAR_S_BRIGHT] == 0.0);
    row = bright;
    row.weight = 0.0;
    assert_true(block_of(&row).hi[SHEAR_S_SHARP] == 0.0);
    row = bright;
    row.flags = SHEAR_FLAG_MASKED;
    assert_true(block_of(&row).hi[SHEAR_S_SHARP] == 0.0);
    row = bright;
    row.d = -0.069; /* -0.04 by 3 errors, but for 0.001 */
    assert_true(block_of(&row).hi[SHEAR_S_SHARP] == 0.0);
    row.m20 = -1.0;
    assert_true(block_of(&row).hi[SHEAR_S_BRIGHT] == 0.0);
}

static int64_t triples(int64_t n) {
    return n * (n - 1) * (n - 2) / 6;
}

/* The counts are those of the rows, also as text, and after a part is taken away again. */
static void counts_of_a_field(void **state) {
    (void)state;
    shear_field_sums *f = NULL;
    shear_field_sums *part = NULL;
    shear_field_sums *again = NULL;
    char *text = NULL;
    int64_t expected[4] = {0};
    shear_result r;
    assert_int_equal(shear_field_sums_new(&f, NULL), SHEAR_OK);
    assert_int_equal(shear_field_sums_new(&part, NULL), SHEAR_OK);
    for (int k = 0; k < 12; k++) {
        shear_block_sums b;
        shear_block_sums_init(&b);
        for (int i = 0; i < SHEAR_BLOCK; i++) {
            const shear_row row = {.m20 = 1.0,
                                   .m02 = 1.0,
                                   .d = i < k ? -0.5 : 1.5,
                                   .d_err = i < k + 3 ? 1e-3 : 1.0,
                                   .weight = 1.0,
                                   .stamp = i};
            shear_block_sums_add(&b, &row);
        }
        shear_field_sums_add(f, &b);
        shear_field_sums_add(part, &b);
        expected[0] += k + 3;
        expected[1] += k;
        expected[2] += triples(k + 3);
        expected[3] += triples(k);
    }
    shear_field_sums_join(f, part);
    shear_field_sums_subtract(f, part);
    assert_int_equal(shear_field_sums_format(f, &text, NULL), SHEAR_OK);
    assert_int_equal(shear_field_sums_parse(&again, text, NULL), SHEAR_OK);
    shear_field_result(again, &r);
    assert_int_equal(r.n_bright, expected[0]);
    assert_int_equal(r.n_sharp, expected[1]);
    assert_int_equal(r.bright_triples, expected[2]);
    assert_int_equal(r.sharp_triples, expected[3]);
    assert_near(r.resolution, r.sum_d / (2.0 * 12.0 * SHEAR_BLOCK), 1e-14, 1.0, "resolution");
    free(text);
    shear_field_sums_free(f);
    shear_field_sums_free(part);
    shear_field_sums_free(again);
}

/* Write the text without its last four terms, as it was before there were such counts. */
static void leave_out_counts(const char *text, char *out, size_t size) {
    enum { AT = 2 + 2 + 1 + SHEAR_N_FLAGS, OLD = SHEAR_N_TERMS - 4 };
    size_t used = 0;
    for (int word = 0; *text != '\0'; word++) {
        const size_t n = strcspn(text, " ");
        if (word == AT) {
            used += (size_t)snprintf(out + used, size - used, "%d ", OLD);
        } else if (word <= AT + OLD || word > AT + SHEAR_N_TERMS) {
            used += (size_t)snprintf(out + used, size - used, "%.*s ", (int)n, text);
        }
        text += n + (text[n] == ' ' ? 1 : 0);
    }
    out[used - 1] = '\0';
}

/* Sums that a service has stored earlier have no such counts, and all the rest. */
static void earlier_sums(void **state) {
    (void)state;
    static char old[1 << 16];
    shear_field_sums *f = NULL;
    shear_field_sums *again = NULL;
    char *text = NULL;
    shear_result before;
    shear_result after;
    const shear_row row = {
        .n1 = 0.1, .m20 = 1.0, .m02 = 1.0, .d = -0.5, .d_err = 1e-3, .weight = 1.0};
    assert_int_equal(shear_field_sums_new(&f, NULL), SHEAR_OK);
    for (int i = 0; i < 2; i++) {
        const shear_block_sums b = block_of(&row);
        shear_field_sums_add(f, &b);
    }
    shear_field_result(f, &before);
    assert_int_equal(before.n_sharp, 2);
    assert_int_equal(shear_field_sums_format(f, &text, NULL), SHEAR_OK);
    leave_out_counts(text, old, sizeof old);
    assert_int_equal(shear_field_sums_parse(&again, old, NULL), SHEAR_OK);
    shear_field_result(again, &after);
    assert_int_equal(after.n_bright + after.n_sharp + after.sharp_triples, 0);
    assert_true(after.n_used == 2 && after.sum_d == before.sum_d);
    assert_true(after.resolution == before.resolution);
    free(text);
    shear_field_sums_free(f);
    shear_field_sums_free(again);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(d_of_gaussians),
        cmocka_unit_test(d_err_is_the_scatter),
        cmocka_unit_test(faint_stamps_do_not_count),
        cmocka_unit_test(counts_of_a_field),
        cmocka_unit_test(earlier_sums),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
