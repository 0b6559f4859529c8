/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From rows to a field: against the plain formulas in long double, in any order and any split, and
 * as text. */
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "shear/sums.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 400 };

/* Rows with a shear of about (0.02, -0.03), scatter, weights and some flags. */
static void draw_rows(shear_row *rows, int n, uint64_t seed) {
    for (int i = 0; i < n; i++) {
        const double flux = exp(4.0 * uniform(&seed));
        const double e1 = 0.02 + 0.3 * (uniform(&seed) - 0.5);
        const double e2 = -0.03 + 0.3 * (uniform(&seed) - 0.5) + 0.2 * (e1 - 0.02);
        rows[i] = (shear_row){.n1 = flux * flux * e1,
                              .n2 = flux * flux * e2,
                              .d = flux * flux * (1.0 + 0.2 * uniform(&seed)),
                              .flux = flux,
                              .flux_removed = 0.01 * flux * uniform(&seed),
                              .border_mean = 0.1 * (uniform(&seed) - 0.4),
                              .border_var = uniform(&seed) - 0.3,
                              .border_var_noise = 0.5 + uniform(&seed),
                              .weight = 0.5 + uniform(&seed)};
        if (i % 13 == 5) {
            rows[i].n1 = rows[i].d = NAN;
            rows[i].flags = i % 2 ? SHEAR_FLAG_MASKED : SHEAR_FLAG_EMPTY | SHEAR_FLAG_BAD_WEIGHT;
        }
    }
}

static shear_field_sums *new_sums(void) {
    shear_field_sums *f = NULL;
    assert_int_equal(shear_field_sums_new(&f, NULL), SHEAR_OK);
    return f;
}

static shear_block_sums block_of(const shear_row *rows, int n) {
    shear_block_sums b;
    shear_block_sums_init(&b);
    for (int i = 0; i < n; i++)
        shear_block_sums_add(&b, &rows[i]);
    return b;
}

static int blocks_in(int n) {
    return (n + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
}

static shear_block_sums block_number(const shear_row *rows, int n, int block) {
    const int from = block * SHEAR_BLOCK;
    return block_of(rows + from, n - from < SHEAR_BLOCK ? n - from : SHEAR_BLOCK);
}

static shear_result result_of(const shear_row *rows, int n) {
    shear_result r;
    shear_field_sums *f = new_sums();
    for (int b = 0; b < blocks_in(n); b++) {
        const shear_block_sums block = block_number(rows, n, b);
        shear_field_sums_add(f, &block);
    }
    shear_field_result(f, &r);
    shear_field_sums_free(f);
    return r;
}

/* Mean and error of the mean of one member over the unflagged rows. */
static void mean_and_error(const shear_row *rows, int n, size_t member, long double *mean,
                           long double *error) {
    long double sum = 0.0L;
    long double squares = 0.0L;
    int used = 0;
    for (int pass = 0; pass < 2; pass++) {
        *mean = pass > 0 ? sum / used : 0.0L;
        for (int i = 0; i < n; i++) {
            const long double x = *(const double *)((const char *)&rows[i] + member);
            if (rows[i].flags == 0 && pass == 0) {
                sum += x;
                used++;
            } else if (rows[i].flags == 0) {
                squares += (x - *mean) * (x - *mean);
            }
        }
    }
    *error = sqrtl(squares / used / (used - 1));
}

static void test_formulas(void **state) {
    (void)state;
    shear_row rows[N];
    draw_rows(rows, N, 1);
    const shear_result r = result_of(rows, N);
    long double w = 0.0L;
    long double n1 = 0.0L;
    long double n2 = 0.0L;
    long double d = 0.0L;
    for (int i = 0; i < N; i++) {
        if (rows[i].flags == 0) {
            w += rows[i].weight;
            n1 += (long double)rows[i].weight * rows[i].n1;
            n2 += (long double)rows[i].weight * rows[i].n2;
            d += (long double)rows[i].weight * rows[i].d;
        }
    }
    long double v11 = 0.0L;
    long double v22 = 0.0L;
    long double v12 = 0.0L;
    for (int i = 0; i < N; i++) {
        if (rows[i].flags == 0) {
            const long double r1 = rows[i].weight * (rows[i].n1 - n1 / d * rows[i].d);
            const long double r2 = rows[i].weight * (rows[i].n2 - n2 / d * rows[i].d);
            v11 += r1 * r1;
            v22 += r2 * r2;
            v12 += r1 * r2;
        }
    }
    /* Terms are rounded once, sums and results twice: a few 1e-16; the errors' squares cancel a
     * little. (Where long double is no wider than double, as under valgrind, it is the sums here
     * that round.) */
    assert_true(r.valid && r.jackknife == 0);
    assert_near(r.g1, (double)(n1 / d), 1e-14, r.g1, "g1");
    assert_near(r.g2, (double)(n2 / d), 1e-14, r.g2, "g2");
    assert_near(r.g1_err, (double)(sqrtl(v11) / d), 1e-14, r.g1_err, "g1_err");
    assert_near(r.g2_err, (double)(sqrtl(v22) / d), 1e-14, r.g2_err, "g2_err");
    assert_near(r.cov12, (double)(v12 / (d * d)), 1e-13, r.cov12, "cov12");
    assert_near(r.sum_weight, (double)w, 1e-14, r.sum_weight, "sum_weight");
    assert_near(r.sum_d, (double)d, 1e-14, r.sum_d, "sum_d");
    assert_int_equal(r.n_stamps, N);
    assert_int_equal(r.n_flagged, 31);
    assert_int_equal(r.n_used, N - 31);
    assert_int_equal(r.flagged[2] + r.flagged[3], 31);
    assert_int_equal(r.flagged[3], r.flagged[5]);
}

static void test_diagnostics(void **state) {
    (void)state;
    shear_row rows[N];
    draw_rows(rows, N, 2);
    const shear_result r = result_of(rows, N);
    long double mean;
    long double error;
    mean_and_error(rows, N, offsetof(shear_row, border_mean), &mean, &error);
    assert_near(r.border_excess, (double)mean, 1e-14, 1.0, "border_excess");
    assert_near(r.border_excess_err, (double)error, 1e-13, r.border_excess_err,
                "border_excess_err");
    mean_and_error(rows, N, offsetof(shear_row, border_var), &mean, &error);
    assert_near(r.border_rough, (double)mean, 1e-14, 1.0, "border_rough");
    assert_near(r.border_rough_err, (double)error, 1e-13, r.border_rough_err, "border_rough_err");
    mean_and_error(rows, N, offsetof(shear_row, border_var_noise), &mean, &error);
    assert_near(r.border_noise_var, (double)mean, 1e-14, 1.0, "border_noise_var");
    mean_and_error(rows, N, offsetof(shear_row, flux_removed), &mean, &error);
    assert_near(r.filter_removed, (double)mean / r.mean_flux, 1e-14, 1.0, "filter_removed");
    assert_near(r.filter_removed_err, (double)error / r.mean_flux, 1e-13, r.filter_removed_err,
                "filter_removed_err");
    mean_and_error(rows, N, offsetof(shear_row, flux), &mean, &error);
    assert_near(r.mean_flux, (double)mean, 1e-14, r.mean_flux, "mean_flux");
}

/* What is joined and leaves again was never there: the same text. */
static void leave_again(shear_field_sums *total, const shear_row *rows) {
    shear_field_sums *more = new_sums();
    char *before = NULL;
    char *after = NULL;
    for (int b = 0; b < blocks_in(N); b += 3) {
        const shear_block_sums block = block_number(rows, N, b);
        shear_field_sums_add(more, &block);
    }
    assert_int_equal(shear_field_sums_format(total, &before, NULL), SHEAR_OK);
    shear_field_sums_join(total, more);
    assert_int_equal(shear_field_sums_format(total, &after, NULL), SHEAR_OK);
    assert_string_not_equal(before, after);
    free(after);
    shear_field_sums_subtract(total, more);
    assert_int_equal(shear_field_sums_format(total, &after, NULL), SHEAR_OK);
    assert_string_equal(before, after);
    shear_field_sums_free(more);
    free(before);
    free(after);
}

/* Blocks in any order, over any number of shards, also by way of text: the same bits. */
static void test_any_order(void **state) {
    (void)state;
    shear_row rows[N];
    draw_rows(rows, N, 3);
    const shear_result expected = result_of(rows, N);
    for (int shards = 1; shards < 8; shards++) {
        shear_field_sums *total = new_sums();
        for (int shard = 0; shard < shards; shard++) {
            shear_field_sums *f = new_sums();
            shear_field_sums *read = NULL;
            char *text = NULL;
            for (int b = blocks_in(N) - 1 - shard; b >= 0; b -= shards) {
                const shear_block_sums block = block_number(rows, N, b);
                shear_field_sums_add(f, &block);
            }
            assert_int_equal(shear_field_sums_format(f, &text, NULL), SHEAR_OK);
            assert_int_equal(shear_field_sums_parse(&read, text, NULL), SHEAR_OK);
            shear_field_sums_join(total, read);
            shear_field_sums_free(f);
            shear_field_sums_free(read);
            free(text);
        }
        shear_result r;
        leave_again(total, rows);
        shear_field_result(total, &r);
        assert_true(r.g1 == expected.g1 && r.g2 == expected.g2 && r.g1_err == expected.g1_err &&
                    r.g2_err == expected.g2_err && r.cov12 == expected.cov12 &&
                    r.n_used == expected.n_used && r.sum_d == expected.sum_d &&
                    r.filter_removed == expected.filter_removed);
        shear_field_sums_free(total);
    }
}

/* Within a block Neumaier keeps what plain summation loses. */
static void test_compensation(void **state) {
    (void)state;
    shear_row rows[4] = {{.d = 1.0, .weight = 1.0},
                         {.d = 1e100, .weight = 1.0},
                         {.d = 1.0, .weight = 1.0},
                         {.d = -1e100, .weight = 1.0}};
    const shear_block_sums b = block_of(rows, 4);
    assert_true(b.hi[SHEAR_S_COMPONENT + SHEAR_C_D] + b.lo[SHEAR_S_COMPONENT + SHEAR_C_D] == 2.0);
    assert_true(result_of(rows, 4).sum_d == 2.0);
}

static void assert_invalid(const shear_row *rows, int n) {
    const shear_result r = result_of(rows, n);
    assert_false(r.valid);
    assert_true(isnan(r.g1) && isnan(r.g2) && isnan(r.g1_err) && isnan(r.g2_err) && isnan(r.cov12));
    assert_int_equal(r.n_stamps, n);
    assert_int_equal(r.n_used + r.n_flagged, n);
}

static void test_invalid(void **state) {
    (void)state;
    shear_row rows[20] = {0};
    assert_invalid(rows, 0);
    draw_rows(rows, 20, 4);
    assert_invalid(rows, 1);
    for (int i = 0; i < 20; i++) {
        rows[i].d = -fabs(rows[i].d); /* rows 5 and 18 stay NaN, and flagged */
    }
    assert_invalid(rows, 20);
    for (int i = 0; i < 20; i++)
        rows[i].weight = 0.0;
    assert_invalid(rows, 20);
    for (int i = 0; i < 20; i++)
        rows[i].flags = SHEAR_FLAG_MASKED;
    assert_invalid(rows, 20);
}

/* Units so large or small that squares leave the range of double: counted as overflow, or the
 * errors are not known. */
static void test_extreme_units(void **state) {
    (void)state;
    shear_row rows[20];
    draw_rows(rows, 20, 5);
    const shear_result usual = result_of(rows, 20);
    static const double units[] = {1e-60, 1e60, 1e130, 1e-200, 1e200};
    for (int u = 0; u < 5; u++) {
        draw_rows(rows, 20, 5);
        for (int i = 0; i < 20; i++) {
            rows[i].n1 *= units[u];
            rows[i].n2 *= units[u];
            rows[i].d *= units[u];
        }
        const shear_result r = result_of(rows, 20);
        if (units[u] == 1e200) {
            assert_int_equal(r.flagged[7], 18);
            assert_int_equal(r.n_used, 0);
            assert_false(r.valid);
        } else {
            assert_near(r.g1, usual.g1, 1e-14, 1.0, "g1");
            assert_true(units[u] == 1e-200 ? isnan(r.g1_err) && isnan(r.cov12)
                                           : fabs(r.g1_err - usual.g1_err) < 1e-14);
        }
    }
    rows[0].weight = NAN; /* nothing that is not finite reaches the integers */
    rows[1].d = INFINITY;
    assert_int_equal(result_of(rows, 2).n_used, 0);
}

static void check_bad_text(const char *text, const char *words) {
    shear_field_sums *f = NULL;
    shear_error err = {0};
    if (shear_field_sums_parse(&f, text, &err) != SHEAR_E_FORMAT)
        fail_msg("accepted: %s", text);
    assert_null(f);
    assert_int_equal(err.code, SHEAR_E_FORMAT);
    assert_true(words == NULL || strstr(err.message, words) != NULL);
}

/* A good text with its word number `word` (0 and 1: the magic) replaced; NULL cuts there. */
static void check_replaced(const char *good, int word, const char *by, const char *words) {
    char text[32768] = "";
    char copy[32768];
    char *rest = copy;
    strcpy(copy, good);
    for (int i = 0; rest != NULL && !(i == word && by == NULL); i++) {
        const char *next = strsep(&rest, " ");
        strcat(text, i > 0 ? " " : "");
        strcat(text, i == word ? by : next);
    }
    check_bad_text(text, words);
}

/* Every word of the text, by what it is: counts, terms, the size and the number of the stamp that
 * counts most. */
static void check_words(const char *good, int from, int to, const char *const *bad,
                        const char *words) {
    for (int word = from; word < to; word++) {
        for (size_t i = 0; bad[i] != NULL; i++)
            check_replaced(good, word, bad[i], words);
        check_replaced(good, word, NULL, words);
    }
}

static void test_bad_text(void **state) {
    (void)state;
    shear_row rows[40];
    char *good = NULL;
    shear_field_sums *f = new_sums();
    draw_rows(rows, 40, 6);
    for (int i = 0; i < 40; i++)
        rows[i].stamp = 100 + i;
    const shear_block_sums block = block_of(rows, 40);
    shear_field_sums_add(f, &block);
    assert_int_equal(shear_field_sums_format(f, &good, NULL), SHEAR_OK);
    assert_true(strlen(good) < 32768);
    static const char *const bad_count[] = {
        "", "x", "-1", "1.0", "+1", "\t1", "99999999999999999999", "0x10", NULL};
    static const char *const bad_term[] = {"", "g", "1.0", NULL};
    static const char *const bad_size[] = {"", "x", "-1", "-0x1p-2", "1 ", "inf", "0", "nan", NULL};
    static const char *const bad_stamp[] = {
        "", "x", "-1", "-2", "1.5", "4611686018427387904", "99999999999999999999", NULL};
    static const char top[] = "the stamp that counts most";
    const int terms = 2 + 3 + SHEAR_N_FLAGS + 1;
    check_words(good, 0, terms, bad_count, NULL);
    check_words(good, terms, terms + SHEAR_N_TERMS, bad_term, "the terms");
    check_words(good, terms + SHEAR_N_TERMS, terms + SHEAR_N_TERMS + 1, bad_size, top);
    check_words(good, terms + SHEAR_N_TERMS + 1, terms + SHEAR_N_TERMS + 2, bad_stamp, top);
    check_replaced(good, 1, "1", NULL); /* another version */
    check_replaced(good, 1, "3", NULL);
    check_replaced(good, 4, "99", NULL); /* flags and terms of a later version */
    check_replaced(good, terms - 1, "9999", NULL);
    check_replaced(good, 3, "41", NULL); /* more used than there are */
    check_replaced(good, 5, "39", NULL); /* more flagged than are left out */
    char longer[32768];
    strcpy(longer, good);
    check_bad_text(strcat(longer, " "), NULL);
    check_bad_text(strcat(longer, "0"), NULL);
    check_bad_text("shear-sums 1", NULL);
    free(good);
    shear_field_sums_free(f);
    shear_field_sums_free(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_formulas),  cmocka_unit_test(test_diagnostics),
        cmocka_unit_test(test_any_order), cmocka_unit_test(test_compensation),
        cmocka_unit_test(test_invalid),   cmocka_unit_test(test_extreme_units),
        cmocka_unit_test(test_bad_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
