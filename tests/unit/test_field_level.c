/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The noise level from a field's sums, its part in the error, which stamp counts most, and why
 * there is no shear. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "shear/symmetry.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 320 };

/* Rows of galaxies with noise `level` times as strong as in their noise stamps. */
static void draw_rows(shear_row *rows, int n, double level, uint64_t seed) {
    for (int i = 0; i < n; i++) {
        const double e1 = 0.02 + 0.3 * (uniform(&seed) - 0.5);
        const double e2 = -0.03 + 0.3 * (uniform(&seed) - 0.5);
        const double galaxy_noise = level * (3.0 + uniform(&seed));
        const double noise = 3.0 + uniform(&seed);
        shear_row *r = &rows[i];
        *r = (shear_row){.noise_d = noise,
                         .noise_n1 = 0.4 * noise * (uniform(&seed) - 0.4),
                         .noise_n2 = 0.3 * (uniform(&seed) - 0.5),
                         .high_galaxy = galaxy_noise * (1.0 + 0.1 * uniform(&seed)),
                         .high_noise = noise * (1.0 + 0.1 * uniform(&seed)),
                         .weight = 0.5 + uniform(&seed),
                         .stamp = i};
        r->corner_galaxy = 0.4 * r->high_galaxy;
        r->corner_noise = 0.4 * r->high_noise;
        r->d = 1.0 + 0.2 * uniform(&seed) + galaxy_noise - noise;
        r->n1 = e1 + 0.2 * (uniform(&seed) - 0.5);
        r->n2 = e2;
        r->m20 = r->m02 = r->d;
    }
}

static shear_field_sums *sums_of(const shear_row *rows, int n) {
    shear_field_sums *f = NULL;
    assert_int_equal(shear_field_sums_new(&f, NULL), SHEAR_OK);
    for (int from = 0; from < n; from += SHEAR_BLOCK) {
        shear_block_sums b;
        shear_block_sums_init(&b);
        for (int i = from; i < n && i < from + SHEAR_BLOCK; i++)
            shear_block_sums_add(&b, &rows[i]);
        shear_field_sums_add(f, &b);
    }
    return f;
}

static shear_result result_of(const shear_row *rows, int n) {
    shear_result r;
    shear_field_sums *f = sums_of(rows, n);
    shear_field_result(f, &r);
    shear_field_sums_free(f);
    return r;
}

/* g and alpha as written down, with the weight of stamp `one` changed by a factor. */
typedef struct plain {
    long double g1, g2, level;
} plain;
static plain plain_of(const shear_row *rows, int n, int one, long double factor) {
    long double t[8] = {0};
    for (int i = 0; i < n; i++) {
        const shear_row *r = &rows[i];
        const long double w = (i == one ? factor : 1.0L) * r->weight;
        const long double x[8] = {r->n1,       r->n2,      r->d,           r->noise_n1,
                                  r->noise_n2, r->noise_d, r->high_galaxy, r->high_noise};
        for (int k = 0; k < 8; k++)
            t[k] += w * x[k];
    }
    const long double a = t[6] / t[7];
    const long double d = t[2] + t[5] - a * t[5];
    return (plain){
        .g1 = (t[0] + t[3] - a * t[3]) / d, .g2 = (t[1] + t[4] - a * t[4]) / d, .level = a};
}

/* The delta method is the infinitesimal jackknife: the squares of what a little more weight of one
 * stamp changes, summed. */
static void test_errors_contain_the_level(void **state) {
    (void)state;
    static const double levels[] = {1.0, 1.04, 0.5, 3.0};
    for (int k = 0; k < 4; k++) {
        shear_row rows[N];
        draw_rows(rows, N, levels[k], 3);
        const shear_result r = result_of(rows, N);
        const plain g = plain_of(rows, N, -1, 1.0L);
        const long double h = 1e-6L;
        long double s[4] = {0};
        for (int i = 0; i < N; i++) {
            const plain up = plain_of(rows, N, i, 1.0L + h);
            const plain down = plain_of(rows, N, i, 1.0L - h);
            const long double d1 = (up.g1 - down.g1) / (2.0L * h);
            const long double d2 = (up.g2 - down.g2) / (2.0L * h);
            const long double da = (up.level - down.level) / (2.0L * h);
            s[0] += d1 * d1;
            s[1] += d2 * d2;
            s[2] += d1 * d2;
            s[3] += da * da;
        }
        assert_true(r.valid);
        assert_near(r.g1, (double)g.g1, 1e-13, 1.0, "g1");
        assert_near(r.g2, (double)g.g2, 1e-13, 1.0, "g2");
        assert_near(r.noise_level, (double)g.level, 1e-13, 1.0, "level");
        assert_near(r.g1_err * r.g1_err, (double)s[0], 1e-8, (double)s[0], "var g1");
        assert_near(r.g2_err * r.g2_err, (double)s[1], 1e-8, (double)s[1], "var g2");
        assert_near(r.cov12, (double)s[2], 1e-8, (double)s[0], "cov12");
        assert_near(r.noise_level_err, (double)sqrtl(s[3]), 1e-8, (double)sqrtl(s[3]), "level");
        assert_true(fabs(r.noise_level - levels[k]) < 5.0 * r.noise_level_err);
        assert_near(r.noise_shape, 0.0, 1e-12, 1.0, "shape"); /* corners like the rest */
    }
}

/* Without power at high k the level is not known, and nothing is changed by it. */
static void test_unknown_level(void **state) {
    (void)state;
    shear_row rows[N];
    draw_rows(rows, N, 1.5, 4);
    for (int i = 0; i < N; i++) {
        rows[i].high_galaxy = rows[i].high_noise = 0.0;
        rows[i].corner_galaxy = rows[i].corner_noise = 0.0;
    }
    const shear_result r = result_of(rows, N);
    long double n1 = 0.0L;
    long double d = 0.0L;
    for (int i = 0; i < N; i++) {
        n1 += (long double)rows[i].weight * rows[i].n1;
        d += (long double)rows[i].weight * rows[i].d;
    }
    assert_near(r.g1, (double)(n1 / d), 1e-14, 1.0, "g1");
    assert_true(isnan(r.noise_level) && isnan(r.noise_level_err) && isnan(r.noise_effect));
}

/* Whether there is a signal does not depend on how strong the noise stamps' noise is beside the
 * galaxies': the level tells what that is. */
static void test_signal_at_the_level(void **state) {
    (void)state;
    static const double factors[] = {1.0, 1e-12, 1e3};
    double signal[3];
    for (int k = 0; k < 3; k++) {
        shear_row rows[N];
        draw_rows(rows, N, 1.0, 4);
        for (int i = 0; i < N; i++) {
            shear_row *r = &rows[i];
            r->d += (1.0 - factors[k]) * r->noise_d;
            r->n1 += (1.0 - factors[k]) * r->noise_n1;
            r->n2 += (1.0 - factors[k]) * r->noise_n2;
            r->noise_d *= factors[k];
            r->noise_n1 *= factors[k];
            r->noise_n2 *= factors[k];
            r->high_noise *= factors[k];
            r->corner_noise *= factors[k];
        }
        const shear_result r = result_of(rows, N);
        assert_true(r.valid);
        signal[k] = r.signal;
    }
    assert_near(signal[1], signal[0], 1e-9, signal[0], "weak noise stamps");
    assert_near(signal[2], signal[0], 1e-9, signal[0], "strong noise stamps");
}

/* Stamps of no weight change nothing, and weights are no noise. */
static void test_signal_and_weights(void **state) {
    (void)state;
    shear_row rows[N];
    draw_rows(rows, N, 1.0, 4);
    const shear_result few = result_of(rows, N / 10);
    for (int i = N / 10; i < N; i++)
        rows[i].weight = 0.0;
    const shear_result all = result_of(rows, N);
    assert_near(all.signal, few.signal, 1e-9, few.signal, "no weight");
    draw_rows(rows, N, 1.0, 4);
    const shear_result uneven = result_of(rows, N);
    for (int i = 0; i < N; i++)
        rows[i].weight = 1.0;
    assert_near(uneven.signal, result_of(rows, N).signal, 0.1, uneven.signal, "weights");
}

/* One stamp alone has no error. */
static void test_one_stamp_is_no_field(void **state) {
    (void)state;
    shear_row rows[N];
    draw_rows(rows, N, 1.0, 4);
    for (int i = 0; i < N; i++) {
        rows[i].weight = i == 7 ? 2.0 : 0.0;
        rows[i].noise_d = 0.01 * rows[i].d;
    }
    const shear_result r = result_of(rows, N);
    assert_int_equal(r.why, SHEAR_NO_SIGNAL);
    assert_false(r.valid);
    assert_int_equal(r.top_stamp, 7);
    rows[8].weight = 1e-9; /* its part of the error would drown in rounding */
    assert_int_equal(result_of(rows, N).why, SHEAR_NO_SIGNAL);
    rows[8].weight = 1e-3;
    assert_int_equal(result_of(rows, N).why, SHEAR_HAS_SHEAR);
}

/* The stamp that counts most is a part of what the stamps have, also where most of that is noise of
 * another level. */
static void test_influence_of_equal_stamps(void **state) {
    (void)state;
    static const double factors[] = {1e-6, 1.0, 1e4};
    for (int k = 0; k < 3; k++) {
        shear_row rows[N];
        for (int i = 0; i < N; i++) {
            rows[i] = (shear_row){.d = 4.0 - 3.0 * factors[k],
                                  .n1 = i % 2 == 0 ? 0.1 : -0.1,
                                  .n2 = i % 2 == 0 ? 0.1 : -0.1,
                                  .m20 = 1.0,
                                  .m02 = 1.0,
                                  .noise_d = 3.0 * factors[k],
                                  .high_galaxy = 3.0,
                                  .high_noise = 3.0 * factors[k],
                                  .weight = 1.0,
                                  .stamp = i};
        }
        const shear_result r = result_of(rows, N);
        assert_near(r.sum_d, N, 1e-9, N, "sum");
        assert_near(r.n_eff, N, 1e-6, N, "n_eff");
        assert_near(r.top_share, 1.0 / N, 1e-6, 1.0, "share");
    }
}

/* Corners that have another level than the rest are told, with an error. */
static void test_shape(void **state) {
    (void)state;
    shear_row rows[N];
    draw_rows(rows, N, 1.0, 5);
    for (int i = 0; i < N; i++) {
        rows[i].high_galaxy -= 0.5 * rows[i].corner_galaxy;
        rows[i].corner_galaxy *= 0.5;
    }
    const shear_result r = result_of(rows, N);
    assert_true(fabs(r.noise_shape + 0.5) < 5.0 * r.noise_shape_err && r.noise_shape_err < 0.1);
}

static void test_why_there_is_no_shear(void **state) {
    (void)state;
    shear_row rows[N];
    draw_rows(rows, N, 1.0, 6);
    shear_result r = result_of(rows, N);
    assert_int_equal(r.why, SHEAR_HAS_SHEAR);
    assert_true(r.signal > 5.0 && r.n_eff > 50.0 && r.n_eff <= N);
    assert_int_equal(result_of(rows, 1).why, SHEAR_NO_STAMPS);
    for (int i = 0; i < N; i++) { /* nothing but noise, or less than the PSF alone would have */
        rows[i].d -= 1.1;
    }
    assert_int_equal(result_of(rows, N).why, SHEAR_NO_SIGNAL);
    for (int i = 0; i < N; i++)
        rows[i].d -= 1.1;
    assert_int_equal(result_of(rows, N).why, SHEAR_TOO_NARROW);
    for (int i = 0; i < N; i++)
        rows[i].m20 = rows[i].m02 = -1.0;
    r = result_of(rows, N);
    assert_int_equal(r.why, SHEAR_SWAPPED);
    assert_false(r.valid);
    assert_true(isnan(r.g1) && isnan(r.g1_err) && isnan(r.delta_g1_err));
    for (int i = 0; i < N; i++) {
        rows[i].n1 = rows[i].n2 = 0.0;
        rows[i].d = 1e-12 * rows[i].noise_d;
    }
    assert_int_equal(result_of(rows, N).why, SHEAR_NO_DIFFERENCE);
    for (int i = 0; i < N; i++)
        rows[i].weight = 0.0;
    assert_int_equal(result_of(rows, N).why, SHEAR_NO_WEIGHT);
}

/* With a filter stamps that are the same differ by their levels, as faint galaxies in the very
 * noise of the noise stamps do: but those have flux. */
static void test_the_same_noise_is_not_the_same_stamps(void **state) {
    (void)state;
    shear_row rows[N];
    draw_rows(rows, N, 1.0, 8);
    for (int i = 0; i < N; i++) {
        rows[i].d = 0.1 * rows[i].noise_d;
        rows[i].n1 = 0.02 * rows[i].d;
        rows[i].n2 = 0.0;
        rows[i].high_galaxy = rows[i].high_noise * (1.0 + 1e-6);
        rows[i].border_var_noise = 1.0;
        rows[i].flux = 1e-9;
    }
    assert_int_equal(result_of(rows, N).why, SHEAR_NO_DIFFERENCE);
    for (int i = 0; i < N; i++)
        rows[i].flux = 1.0;
    assert_int_equal(result_of(rows, N).why, SHEAR_HAS_SHEAR);
}

/* The stamp that counts most, through sums in any order and text; and when it leaves. */
static void test_influence(void **state) {
    (void)state;
    shear_row rows[N];
    draw_rows(rows, N, 1.0, 7);
    rows[77].n2 = -5000.0;
    shear_field_sums *first = sums_of(rows, N / 2);
    shear_field_sums *second = sums_of(rows + N / 2, N / 2);
    char *text = NULL;
    shear_field_sums_join(second, first);
    assert_int_equal(shear_field_sums_format(second, &text, NULL), SHEAR_OK);
    shear_field_sums *read = NULL;
    assert_int_equal(shear_field_sums_parse(&read, text, NULL), SHEAR_OK);
    shear_result r;
    shear_field_result(read, &r);
    assert_int_equal(r.top_stamp, 77);
    assert_near(r.top_share, 5000.0 * rows[77].weight / r.sum_d, 1e-12, 10.0, "share");
    shear_field_sums_subtract(read, first);
    shear_field_result(read, &r);
    assert_true(isnan(r.top_share));
    shear_field_sums_set_top(read, (shear_influence){.size = 2.0, .stamp = 200});
    shear_field_result(read, &r);
    assert_true(r.top_stamp == 200 && r.top_share == 2.0 / r.sum_d);
    free(text);
    shear_field_sums_free(first);
    shear_field_sums_free(second);
    shear_field_sums_free(read);
}

/* Sums as version 0.1 wrote them: words of the present text, in its order. */
static void test_old_text(void **state) {
    (void)state;
    static const int triangle[] = {0, 2, 1, 3, 4, 5}; /* N1N1 N2N2 N1N2 N1D N2D DD of N1, N2, D */
    shear_row rows[N];
    draw_rows(rows, N, 1.0, 8);
    shear_field_sums *f = sums_of(rows, N);
    char *text = NULL;
    char *word[200];
    int n = 0;
    assert_int_equal(shear_field_sums_format(f, &text, NULL), SHEAR_OK);
    for (char *rest = text; rest != NULL && n < 200;)
        word[n++] = strsep(&rest, " ");
    char **terms = word + 5 + SHEAR_N_FLAGS + 1;
    char old[32768] = "shear-sums 1 320 320 0 0 0 0 0 0 0 0";
    for (int i = 0; i < 4; i++)
        strcat(strcat(old, " "), terms[SHEAR_S_W + i]);
    for (int i = 0; i < 6; i++)
        strcat(strcat(old, " "), terms[SHEAR_S_PRODUCT + triangle[i]]);
    for (int i = SHEAR_S_FLUX; i <= SHEAR_S_BORDER_NOISE; i++)
        strcat(strcat(old, " "), terms[i]);
    shear_field_sums *read = NULL;
    assert_int_equal(shear_field_sums_parse(&read, old, NULL), SHEAR_OK);
    shear_result r;
    shear_result without;
    shear_field_result(read, &r);
    for (int i = 0; i < N; i++) {
        rows[i].noise_n1 = rows[i].noise_n2 = rows[i].noise_d = 0.0;
        rows[i].high_galaxy = rows[i].high_noise = 0.0;
    }
    without = result_of(rows, N);
    assert_true(r.g1 == without.g1 && r.g2 == without.g2 && r.g1_err == without.g1_err);
    assert_true(r.cov12 == without.cov12 && isnan(r.noise_level) && isnan(r.top_share));
    free(text);
    shear_field_sums_free(f);
    shear_field_sums_free(read);
}

/* A stamp's own excess of noise, in the noise's shape, does not touch the symmetric estimate. */
static void test_symmetry_loses_the_excess(void **state) {
    (void)state;
    static const double beta = 2.0;
    shear_row rows[N];
    shear_result r[2];
    draw_rows(rows, N, 1.0, 9);
    for (int with = 0; with < 2; with++) {
        shear_symmetry *terms = NULL;
        assert_int_equal(shear_symmetry_new(&terms, NULL), SHEAR_OK);
        uint64_t seed = 10;
        for (int i = 0; i < N; i++) {
            rows[i].noise_d = 6.0;
            rows[i].noise_n1 = 0.6;
            rows[i].noise_n2 = -0.3;
            rows[i].noise_u = 0.9;
            rows[i].noise_v = 0.0;
            rows[i].high_noise = 3.0;
            rows[i].high_galaxy = 3.0;
            const double excess = with * (uniform(&seed) + 0.5);
            rows[i].high_galaxy += excess;
            rows[i].d += 2.0 * excess;
            rows[i].n1 += 0.2 * excess;
            rows[i].n2 -= 0.1 * excess;
            rows[i].u -= 0.3 * excess / (0.5 * beta * beta);
            assert_int_equal(shear_symmetry_add(terms, &rows[i], beta, NULL), SHEAR_OK);
        }
        shear_field_sums *f = sums_of(rows, N);
        assert_int_equal(shear_estimate(SHEAR_ESTIMATOR_PDF_SYM, f, terms, &r[with], NULL),
                         SHEAR_OK);
        assert_true(r[with].valid);
        shear_field_sums_free(f);
        shear_symmetry_free(terms);
    }
    assert_near(r[1].g1, r[0].g1, 1e-3, r[0].g1_err, "g1");
    assert_near(r[1].g2, r[0].g2, 1e-3, r[0].g2_err, "g2");
}

/* Noise alone has a symmetry, too, about any g: it is no shear. */
static void test_noise_has_no_symmetry(void **state) {
    (void)state;
    static const double beta = 2.0;
    for (uint64_t seed = 1; seed <= 20; seed++) {
        shear_row rows[N];
        shear_result r;
        shear_symmetry *terms = NULL;
        uint64_t noise = 100 + seed;
        draw_rows(rows, N, 1.0, seed);
        assert_int_equal(shear_symmetry_new(&terms, NULL), SHEAR_OK);
        for (int i = 0; i < N; i++) {
            rows[i].noise_d = 3.0 + uniform(&noise);
            rows[i].high_noise = 3.0;
            rows[i].d = uniform(&noise) - uniform(&noise);
            rows[i].n1 = uniform(&noise) - uniform(&noise);
            rows[i].n2 = uniform(&noise) - uniform(&noise);
            rows[i].high_galaxy = 2.9 + 0.2 * uniform(&noise);
            assert_int_equal(shear_symmetry_add(terms, &rows[i], beta, NULL), SHEAR_OK);
        }
        shear_field_sums *f = sums_of(rows, N);
        assert_int_equal(shear_estimate(SHEAR_ESTIMATOR_PDF_SYM, f, terms, &r, NULL), SHEAR_OK);
        assert_false(r.valid);
        assert_int_equal(r.why, SHEAR_NO_SIGNAL);
        shear_field_sums_free(f);
        shear_symmetry_free(terms);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_errors_contain_the_level),
        cmocka_unit_test(test_unknown_level),
        cmocka_unit_test(test_signal_at_the_level),
        cmocka_unit_test(test_signal_and_weights),
        cmocka_unit_test(test_one_stamp_is_no_field),
        cmocka_unit_test(test_influence_of_equal_stamps),
        cmocka_unit_test(test_shape),
        cmocka_unit_test(test_why_there_is_no_shear),
        cmocka_unit_test(test_the_same_noise_is_not_the_same_stamps),
        cmocka_unit_test(test_influence),
        cmocka_unit_test(test_old_text),
        cmocka_unit_test(test_symmetry_loses_the_excess),
        cmocka_unit_test(test_noise_has_no_symmetry),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
