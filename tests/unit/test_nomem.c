/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory runs out at the n-th allocation, for every n until the call succeeds: the call says so,
 * leaves nothing behind, and the next one works. The linker brings every allocation of libshear's
 * own here (--wrap, see core.cmake). */
#include "batch.h"
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include "shear/symmetry.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Counted from several OpenMP threads. */
static atomic_int calls;   /* allocations since the countdown was set */
static atomic_int fail_at; /* the call that fails, from 1; 0: none */
static atomic_int live;    /* allocations not yet freed */

static bool refuse(void) {
    return atomic_fetch_add(&calls, 1) + 1 == atomic_load(&fail_at);
}

static void *counted(void *p) {
    atomic_fetch_add(&live, p != NULL);
    return p;
}

/* What the linker's --wrap calls. */
void *__real_malloc(size_t n);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *p, size_t n);
void __real_free(void *p);
char *__real_strdup(const char *s);
void *__real_aligned_alloc(size_t alignment, size_t n);
FILE *__real_open_memstream(char **text, size_t *size);
void *__real_fftw_plan_many_dft(int rank, const int *n, int howmany, void *in, const int *inembed,
                                int istride, int idist, void *out, const int *onembed, int ostride,
                                int odist, int sign, unsigned flags);
void __real_fftw_destroy_plan(void *plan);

void *__wrap_malloc(size_t n);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *p, size_t n);
void __wrap_free(void *p);
char *__wrap_strdup(const char *s);
void *__wrap_aligned_alloc(size_t alignment, size_t n);
FILE *__wrap_open_memstream(char **text, size_t *size);
void *__wrap_fftw_plan_many_dft(int rank, const int *n, int howmany, void *in, const int *inembed,
                                int istride, int idist, void *out, const int *onembed, int ostride,
                                int odist, int sign, unsigned flags);
void __wrap_fftw_destroy_plan(void *plan);

void *__wrap_malloc(size_t n) {
    return refuse() ? NULL : counted(__real_malloc(n));
}

void *__wrap_calloc(size_t n, size_t size) {
    return refuse() ? NULL : counted(__real_calloc(n, size));
}

void *__wrap_realloc(void *p, size_t n) {
    if (refuse())
        return NULL;
    void *q = __real_realloc(p, n);
    return p == NULL ? counted(q) : q;
}

void __wrap_free(void *p) {
    atomic_fetch_sub(&live, p != NULL);
    __real_free(p);
}

char *__wrap_strdup(const char *s) {
    return refuse() ? NULL : counted(__real_strdup(s));
}

void *__wrap_aligned_alloc(size_t alignment, size_t n) {
    return refuse() ? NULL : counted(__real_aligned_alloc(alignment, n));
}

/* Its text is malloc'd by libc and freed by us. */
FILE *__wrap_open_memstream(char **text, size_t *size) {
    return refuse() ? NULL : counted(__real_open_memstream(text, size));
}

void *__wrap_fftw_plan_many_dft(int rank, const int *n, int howmany, void *in, const int *inembed,
                                int istride, int idist, void *out, const int *onembed, int ostride,
                                int odist, int sign, unsigned flags) {
    return refuse()
               ? NULL
               : counted(__real_fftw_plan_many_dft(rank, n, howmany, in, inembed, istride, idist,
                                                   out, onembed, ostride, odist, sign, flags));
}

void __wrap_fftw_destroy_plan(void *plan) {
    atomic_fetch_sub(&live, plan != NULL);
    __real_fftw_destroy_plan(plan);
}

/* Run `attempt` with the n-th allocation failing, n = 1, 2, ... until it needs fewer than n. It
 * returns a code, and must have freed everything. At least `least` allocations must have been met.
 */
static void exhaust(int (*attempt)(void *), void *context, int least) {
    for (int n = 1;; n++) {
        const int before = atomic_load(&live);
        atomic_store(&calls, 0);
        atomic_store(&fail_at, n);
        const int code = attempt(context);
        const bool failed = atomic_load(&calls) >= n;
        atomic_store(&fail_at, 0);
        assert_int_equal(atomic_load(&live), before);
        assert_int_equal(code, failed ? SHEAR_E_NOMEM : SHEAR_OK);
        if (!failed) {
            assert_true(n > least);
            return;
        }
    }
}

/* 16 lines are transformed by ourselves, 14 by FFTW. */
static const shear_geometry geometry = {
    .nx = 16, .ny = 14, .psf_nx = 13, .psf_ny = 12, .psf_oversample = 1};
enum { COUNT = 40 };

/* What the attempts share. */
typedef struct scene {
    batch b;
    shear_settings settings;
    const shear_plan *plan;
    bool own_psf;
} scene;

static int new_plan(void *context) {
    const scene *s = context;
    shear_error err = {0};
    shear_plan *plan = NULL;
    const int code = shear_plan_new(&plan,
                                    &(shear_plan_request){.settings = &s->settings,
                                                          .geometry = geometry,
                                                          .psf = s->own_psf ? NULL : s->b.psf,
                                                          .r_psf_px = 1.0,
                                                          .has_r_gal = true},
                                    &err);
    assert_true((code == SHEAR_OK) == (plan != NULL));
    assert_int_equal(err.code, code);
    shear_plan_free(plan);
    return code;
}

static int new_workspace(void *context) {
    const scene *s = context;
    shear_error err = {0};
    shear_workspace *ws = NULL;
    const int code = shear_workspace_new(&ws, s->plan, &err);
    assert_true((code == SHEAR_OK) == (ws != NULL));
    assert_int_equal(err.code, code);
    shear_workspace_free(ws);
    return code;
}

static int measure_batch(void *context) {
    const scene *s = context;
    shear_row rows[COUNT];
    const shear_stamps stamps = batch_full(&s->b);
    return shear_measure_batch(s->plan, &stamps, 3, NULL, rows, NULL);
}

static int inspect(void *context) {
    const scene *s = context;
    shear_inspection in;
    shear_workspace *ws = NULL;
    const shear_stamps stamps = batch_full(&s->b);
    int code = shear_workspace_new(&ws, s->plan, NULL);
    if (code == SHEAR_OK) {
        code = shear_inspect(s->plan, ws, &stamps, 0, &in, NULL);
        shear_inspection_deinit(&in);
    }
    shear_workspace_free(ws);
    return code;
}

static void test_plans_and_workspaces(void **state) {
    (void)state;
    scene s = {0};
    batch_init(&s.b, COUNT, &geometry, 1.0, 4);
    for (int m = 0; m < PAIR_METHODS; m += 3) { /* none, spline, log-spline */
        for (int own = 0; own < 2; own++) {
            shear_settings_init(&s.settings);
            shear_settings_set(&s.settings, "interpolation", pair_methods[m], NULL);
            shear_settings_set(&s.settings, "filter", own != 0 ? "paper" : "edge", NULL);
            shear_settings_set(&s.settings, "width", "0.5", NULL);
            s.own_psf = own != 0;
            exhaust(new_plan, &s, 8);
            shear_plan *plan = batch_plan(&s.b, &s.settings, s.own_psf, true);
            s.plan = plan;
            exhaust(new_workspace, &s, 2);
            exhaust(measure_batch, &s, 7);
            exhaust(inspect, &s, 8);
            shear_plan_free(plan);
        }
    }
    batch_deinit(&s.b);
}

/* Measuring allocates nothing at all. */
static void test_nothing_per_stamp(void **state) {
    (void)state;
    scene s = {0};
    shear_row rows[COUNT];
    batch_init(&s.b, COUNT, &geometry, 1.0, 4);
    for (int m = 0; m < PAIR_METHODS; m++) {
        shear_workspace *ws = NULL;
        shear_settings_init(&s.settings);
        shear_settings_set(&s.settings, "interpolation", pair_methods[m], NULL);
        shear_plan *plan = batch_plan(&s.b, &s.settings, true, true);
        const shear_stamps stamps = batch_full(&s.b);
        assert_int_equal(shear_workspace_new(&ws, plan, NULL), SHEAR_OK);
        atomic_store(&calls, 0);
        assert_int_equal(shear_measure_range(plan, ws, &stamps, 0, COUNT, rows, NULL), SHEAR_OK);
        assert_int_equal(atomic_load(&calls), 0);
        shear_workspace_free(ws);
        shear_plan_free(plan);
    }
    batch_deinit(&s.b);
}

static int new_sums(void *context) {
    (void)context;
    shear_field_sums *f = NULL;
    const int code = shear_field_sums_new(&f, NULL);
    assert_true((code == SHEAR_OK) == (f != NULL));
    shear_field_sums_free(f);
    return code;
}

static int parse_sums(void *context) {
    shear_field_sums *f = NULL;
    const int code = shear_field_sums_parse(&f, context, NULL);
    assert_true((code == SHEAR_OK) == (f != NULL));
    shear_field_sums_free(f);
    return code;
}

/* GMP writes into memory of ours; the stream is libc's. */
static int format_sums(void *context) {
    char *text = NULL;
    const int code = shear_field_sums_format(context, &text, NULL);
    assert_true((code == SHEAR_OK) == (text != NULL));
    free(text);
    return code;
}

static void test_sums(void **state) {
    (void)state;
    shear_field_sums *f = NULL;
    shear_block_sums b;
    char *text = NULL;
    const shear_row row = {.n1 = 0.1, .n2 = -1.0 / 3.0, .d = 3.0, .weight = 1.0};
    exhaust(new_sums, NULL, 1);
    shear_block_sums_init(&b);
    shear_block_sums_add(&b, &row);
    assert_int_equal(shear_field_sums_new(&f, NULL), SHEAR_OK);
    shear_field_sums_add(f, &b);
    exhaust(format_sums, f, SHEAR_N_TERMS);
    assert_int_equal(shear_field_sums_format(f, &text, NULL), SHEAR_OK);
    exhaust(parse_sums, text, 2);
    free(text);
    shear_field_sums_free(f);
}

/* 600 blocks: the table grows twice. */
static int fill_jackknife(void *context) {
    shear_jackknife *j = NULL;
    shear_jackknife *whole = NULL;
    int code = shear_jackknife_new(&j, 5, NULL);
    for (int i = 0; i < 600 && code == SHEAR_OK; i++)
        code = shear_jackknife_add(j, context, NULL);
    code = code == SHEAR_OK ? shear_jackknife_new(&whole, 5, NULL) : code;
    code = code == SHEAR_OK ? shear_jackknife_join(whole, j, NULL) : code;
    shear_jackknife_free(j);
    shear_jackknife_free(whole);
    return code;
}

static void test_jackknife(void **state) {
    (void)state;
    shear_block_sums b;
    shear_block_sums_init(&b);
    exhaust(fill_jackknife, &b, 5);
}

/* 600 stamps: the table grows twice; joined, and solved. */
static int solve_symmetry(void *context) {
    shear_symmetry *s = NULL;
    shear_symmetry *whole = NULL;
    shear_result r = {0};
    uint64_t seed = *(const uint64_t *)context;
    int code = shear_symmetry_new(&s, NULL);
    for (int i = 0; i < 600 && code == SHEAR_OK; i++) {
        const shear_row row = {
            .n1 = uniform(&seed) - 0.5, .n2 = uniform(&seed) - 0.5, .d = 1.0, .weight = 1.0};
        code = shear_symmetry_add(s, &row, 1.5, NULL);
    }
    code = code == SHEAR_OK ? shear_symmetry_new(&whole, NULL) : code;
    code = code == SHEAR_OK ? shear_symmetry_join(whole, s, 0, NULL) : code;
    code = code == SHEAR_OK ? shear_symmetry_solve(whole, 0, &r, NULL) : code;
    assert_true(r.valid == (code == SHEAR_OK));
    shear_symmetry_free(s);
    shear_symmetry_free(whole);
    return code;
}

static void test_symmetry(void **state) {
    (void)state;
    uint64_t seed = 3;
    exhaust(solve_symmetry, &seed, 12);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plans_and_workspaces),
        cmocka_unit_test(test_nothing_per_stamp),
        cmocka_unit_test(test_sums),
        cmocka_unit_test(test_jackknife),
        cmocka_unit_test(test_symmetry),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
