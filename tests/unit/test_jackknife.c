/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The jackknife against leaving out by hand, and against the delta method. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "shear/sums.h"

#include <math.h>
#include <string.h>

/* A standard normal number (Box and Muller). */
static double normal(uint64_t *state) {
    const double radius = sqrt(-2.0 * log(1.0 - uniform(state)));
    return radius * cos(2.0 * M_PI * uniform(state));
}

/* A full block of independent rows. */
static shear_block_sums draw_block(uint64_t *seed) {
    shear_block_sums b;
    shear_block_sums_init(&b);
    for (int i = 0; i < SHEAR_BLOCK; i++) {
        const double a = normal(seed);
        const shear_row row = {.n1 = 0.02 + 0.3 * a,
                               .n2 = -0.01 + 0.2 * normal(seed) + 0.1 * a,
                               .d = 1.0 + 0.3 * uniform(seed),
                               .weight = 1.0,
                               .flux = 1.0};
        shear_block_sums_add(&b, &row);
    }
    return b;
}

enum { BLOCKS = 203 };

static void field_of(const shear_block_sums *blocks, int n, shear_result *r) {
    shear_field_sums *f = NULL;
    assert_int_equal(shear_field_sums_new(&f, NULL), SHEAR_OK);
    for (int b = 0; b < n; b++)
        shear_field_sums_add(f, &blocks[b]);
    shear_field_result(f, r);
    shear_field_sums_free(f);
}

static shear_jackknife *jackknife_of(const shear_block_sums *blocks, int n, int groups) {
    shear_jackknife *j = NULL;
    assert_int_equal(shear_jackknife_new(&j, groups, NULL), SHEAR_OK);
    for (int b = 0; b < n; b++)
        assert_int_equal(shear_jackknife_add(j, &blocks[b], NULL), SHEAR_OK);
    return j;
}

/* Leave out group g of consecutive blocks [g n / G, (g+1) n / G), measure the rest, and take the
 * scatter. */
static void by_hand(const shear_block_sums *blocks, int n, int groups, shear_result *r) {
    double g1[BLOCKS];
    double g2[BLOCKS];
    double mean1 = 0.0;
    double mean2 = 0.0;
    for (int g = 0; g < groups; g++) {
        shear_block_sums rest[BLOCKS];
        int left = 0;
        for (int b = 0; b < n; b++) {
            if (b < g * n / groups || b >= (g + 1) * n / groups)
                rest[left++] = blocks[b];
        }
        shear_result of_rest;
        field_of(rest, left, &of_rest);
        g1[g] = of_rest.g1;
        g2[g] = of_rest.g2;
        mean1 += g1[g] / groups;
        mean2 += g2[g] / groups;
    }
    *r = (shear_result){0};
    for (int g = 0; g < groups; g++) {
        r->g1_err += (g1[g] - mean1) * (g1[g] - mean1) * (groups - 1) / groups;
        r->g2_err += (g2[g] - mean2) * (g2[g] - mean2) * (groups - 1) / groups;
        r->cov12 += (g1[g] - mean1) * (g2[g] - mean2) * (groups - 1) / groups;
    }
    r->g1_err = sqrt(r->g1_err);
    r->g2_err = sqrt(r->g2_err);
}

static void draw_blocks(shear_block_sums *blocks, int n, uint64_t seed) {
    for (int b = 0; b < n; b++)
        blocks[b] = draw_block(&seed);
}

static void test_by_hand(void **state) {
    (void)state;
    static shear_block_sums blocks[BLOCKS];
    static const int counts[][2] = {{2, 2},  {7, 2},       {7, 7},
                                    {50, 8}, {BLOCKS, 10}, {BLOCKS, BLOCKS}};
    draw_blocks(blocks, BLOCKS, 1);
    for (int i = 0; i < 6; i++) {
        shear_result r;
        shear_result expected;
        shear_jackknife *j = jackknife_of(blocks, counts[i][0], counts[i][1]);
        field_of(blocks, counts[i][0], &r);
        const double g1 = r.g1;
        by_hand(blocks, counts[i][0], counts[i][1], &expected);
        assert_int_equal(shear_jackknife_finish(j, &r, NULL), SHEAR_OK);
        /* Differences of numbers that agree to a part in the number of groups: 1e-16 times 200
         * times 10. */
        assert_near(r.g1_err, expected.g1_err, 1e-12, r.g1_err, "g1_err");
        assert_near(r.g2_err, expected.g2_err, 1e-12, r.g2_err, "g2_err");
        assert_near(r.cov12, expected.cov12, 1e-12, r.g1_err * r.g2_err, "cov12");
        assert_int_equal(r.jackknife, counts[i][1]);
        assert_true(r.g1 == g1);
        shear_jackknife_free(j);
    }
}

/* Independent stamps: both methods estimate the same error. With G groups its own scatter is
 * 1/sqrt(2 G) of it: 5 % for 203. */
static void test_agrees_with_delta(void **state) {
    (void)state;
    static shear_block_sums blocks[BLOCKS];
    for (uint64_t seed = 10; seed < 15; seed++) {
        shear_result r;
        draw_blocks(blocks, BLOCKS, seed);
        field_of(blocks, BLOCKS, &r);
        const shear_result delta = r;
        shear_jackknife *j = jackknife_of(blocks, BLOCKS, BLOCKS);
        assert_int_equal(shear_jackknife_finish(j, &r, NULL), SHEAR_OK);
        assert_near(r.g1_err, delta.g1_err, 0.18, delta.g1_err, "g1_err");
        assert_near(r.g2_err, delta.g2_err, 0.18, delta.g2_err, "g2_err");
        assert_near(r.cov12, delta.cov12, 0.25, delta.g1_err * delta.g2_err, "cov12");
        shear_jackknife_free(j);
    }
}

/* Parts joined in order are the whole. */
static void test_join(void **state) {
    (void)state;
    static shear_block_sums blocks[BLOCKS];
    shear_result whole;
    shear_result joined;
    draw_blocks(blocks, BLOCKS, 3);
    field_of(blocks, BLOCKS, &whole);
    joined = whole;
    shear_jackknife *j = jackknife_of(blocks, BLOCKS, 9);
    shear_jackknife *a = jackknife_of(blocks, 80, 9);
    shear_jackknife *b = jackknife_of(blocks + 80, BLOCKS - 80, 2);
    shear_jackknife *none = jackknife_of(blocks, 0, 2);
    assert_int_equal(shear_jackknife_join(a, b, NULL), SHEAR_OK);
    assert_int_equal(shear_jackknife_join(a, none, NULL), SHEAR_OK);
    assert_int_equal(shear_jackknife_finish(j, &whole, NULL), SHEAR_OK);
    assert_int_equal(shear_jackknife_finish(a, &joined, NULL), SHEAR_OK);
    assert_true(whole.g1_err == joined.g1_err && whole.g2_err == joined.g2_err &&
                whole.cov12 == joined.cov12);
    shear_jackknife_free(j);
    shear_jackknife_free(a);
    shear_jackknife_free(b);
    shear_jackknife_free(none);
}

static void test_errors(void **state) {
    (void)state;
    shear_block_sums blocks[4];
    shear_result r;
    shear_error err = {0};
    shear_jackknife *j = NULL;
    draw_blocks(blocks, 4, 5);
    for (int groups = -1; groups < 2; groups++) {
        assert_int_equal(shear_jackknife_new(&j, groups, &err), SHEAR_E_SETTING);
        assert_null(j);
    }
    field_of(blocks, 4, &r);
    const double before = r.g1_err;
    j = jackknife_of(blocks, 4, 5);
    assert_int_equal(shear_jackknife_finish(j, &r, &err), SHEAR_E_SETTING);
    assert_non_null(strstr(err.message, "5 groups"));
    assert_non_null(strstr(err.advice, "fewer"));
    assert_true(r.g1_err == before && r.jackknife == 0);
    shear_jackknife_free(j);
    shear_jackknife_free(NULL);
}

/* Without a shear there is no error; nor where all that counts lies in one group. */
static void test_undefined(void **state) {
    (void)state;
    shear_block_sums blocks[4];
    shear_result r;
    memset(blocks, 0, sizeof blocks);
    shear_jackknife *j = jackknife_of(blocks, 4, 4);
    field_of(blocks, 4, &r);
    assert_int_equal(shear_jackknife_finish(j, &r, NULL), SHEAR_OK);
    assert_true(!r.valid && isnan(r.g1_err) && isnan(r.g2_err) && isnan(r.cov12));
    shear_jackknife_free(j);
    uint64_t seed = 6;
    blocks[2] = draw_block(&seed);
    j = jackknife_of(blocks, 4, 4);
    field_of(blocks, 4, &r);
    assert_true(r.valid);
    assert_int_equal(shear_jackknife_finish(j, &r, NULL), SHEAR_OK);
    assert_true(isnan(r.g1_err) && isnan(r.g2_err) && isnan(r.cov12));
    shear_jackknife_free(j);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_by_hand),   cmocka_unit_test(test_agrees_with_delta),
        cmocka_unit_test(test_join),      cmocka_unit_test(test_errors),
        cmocka_unit_test(test_undefined),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
