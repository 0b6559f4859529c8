/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One result for any number of threads, to the last bit; and plans made and used by many threads at
 * once. */
#include "batch.h"
#include "gaussian.h"
#include "pair.h"
#include "test.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

static const shear_geometry geometry = {
    .nx = 17, .ny = 16, .psf_nx = 13, .psf_ny = 12, .psf_oversample = 1};
enum { COUNT = 50, PIXELS = 17 * 16, MOST = 7 }; /* three blocks and a part */

static void use(shear_settings *settings, const char *method) {
    shear_settings_init(settings);
    settings->artefacts = SHEAR_ARTEFACTS_KEEP; /* images of any kind */
    assert_int_equal(shear_settings_set(settings, "interpolation", method, NULL), SHEAR_OK);
}

/* Every column, PSFs by index, a filter that follows R_GAL, some stamps flagged. */
static void draw(batch *b) {
    batch_init(b, COUNT, &geometry, 1.1, 3);
    b->galaxy[20 * PIXELS + 3] = NAN;
    b->mask[40] = 1;
    b->psf_index[41] = -1;
}

static void test_batch_is_the_same(void **state) {
    (void)state;
    static const char *const methods[] = {"none", "log-spline"};
    for (int m = 0; m < 2; m++) {
        batch b;
        shear_settings settings;
        shear_row expected[COUNT];
        draw(&b);
        use(&settings, methods[m]);
        shear_plan *plan = batch_plan(&b, &settings, true, true);
        const shear_stamps stamps = batch_full(&b);
        batch_measure(plan, &stamps, expected);
        for (int threads = 1; threads <= MOST; threads = 2 * threads + (threads == 1 ? 0 : 3)) {
            shear_row rows[COUNT];
            assert_int_equal(shear_measure_batch(plan, &stamps, threads, NULL, rows, NULL),
                             SHEAR_OK);
            assert_same_rows(rows, expected, COUNT);
        }
        shear_row rows[COUNT];
        assert_int_equal(shear_measure_batch(plan, &stamps, 0, NULL, rows, NULL), SHEAR_OK);
        assert_same_rows(rows, expected, COUNT);
        shear_plan_free(plan);
        batch_deinit(&b);
    }
}

/* With the caller's workspaces, again and again. */
static void test_own_workspaces(void **state) {
    (void)state;
    batch b;
    shear_settings settings;
    shear_row first[COUNT];
    shear_row rows[COUNT];
    shear_workspace *ws[MOST];
    draw(&b);
    use(&settings, "bicubic");
    shear_plan *plan = batch_plan(&b, &settings, true, true);
    const shear_stamps stamps = batch_full(&b);
    for (int i = 0; i < MOST; i++)
        assert_int_equal(shear_workspace_new(&ws[i], plan, NULL), SHEAR_OK);
    assert_int_equal(shear_measure_batch(plan, &stamps, MOST, ws, first, NULL), SHEAR_OK);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(shear_measure_batch(plan, &stamps, 3, ws, rows, NULL), SHEAR_OK);
        assert_same_rows(rows, first, COUNT);
    }
    for (int i = 0; i < MOST; i++)
        shear_workspace_free(ws[i]);
    shear_plan_free(plan);
    batch_deinit(&b);
}

/* Two stamps are bad: the error is always the first one's. */
static void test_first_error(void **state) {
    (void)state;
    batch b;
    shear_settings settings;
    shear_row rows[COUNT];
    draw(&b);
    use(&settings, "log-bilinear");
    b.noise[49 * PIXELS + 1] = -1.0;
    b.galaxy[37 * PIXELS + 1] = -1.0;
    b.galaxy[38 * PIXELS + 1] = -1.0;
    shear_plan *plan = batch_plan(&b, &settings, false, false);
    const shear_stamps stamps = batch_plain(&b);
    for (int threads = 1; threads <= MOST; threads++) {
        shear_error err = {0};
        assert_int_equal(shear_measure_batch(plan, &stamps, threads, NULL, rows, &err),
                         SHEAR_E_NEGATIVE);
        assert_non_null(strstr(err.message, "galaxy stamp 37 "));
        assert_int_equal(shear_measure_batch(plan, &stamps, threads, NULL, rows, NULL),
                         SHEAR_E_NEGATIVE);
    }
    shear_plan_free(plan);
    batch_deinit(&b);
}

static void test_no_stamps(void **state) {
    (void)state;
    batch b;
    shear_settings settings;
    batch_init(&b, 1, &geometry, 1.1, 3);
    use(&settings, "none");
    shear_plan *plan = batch_plan(&b, &settings, false, false);
    shear_stamps stamps = batch_plain(&b);
    stamps.count = 0;
    assert_int_equal(shear_measure_batch(plan, &stamps, 3, NULL, NULL, NULL), SHEAR_OK);
    shear_plan_free(plan);
    batch_deinit(&b);
}

/* What a thread of the two tests below does; assertions stay on the main thread. */
typedef struct task {
    const batch *b;
    const shear_plan *plan; /* NULL: make one */
    int method;
    int code;
    shear_row rows[COUNT];
} task;

static void *measure_with_new_plans(void *argument) {
    task *t = argument;
    const shear_stamps stamps = batch_plain(t->b);
    for (int round = 0; round < 3 && t->code == SHEAR_OK; round++) {
        shear_plan *plan = NULL;
        shear_workspace *ws = NULL;
        shear_settings settings;
        shear_settings_init(&settings);
        shear_settings_set(&settings, "interpolation", pair_methods[t->method], NULL);
        t->code =
            shear_plan_new(&plan,
                           &(shear_plan_request){
                               .settings = &settings, .geometry = t->b->geometry, .psf = t->b->psf},
                           NULL);
        t->code = t->code == SHEAR_OK ? shear_workspace_new(&ws, plan, NULL) : t->code;
        t->code = t->code == SHEAR_OK ? shear_measure_range(plan, ws, &stamps, 0, 10, t->rows, NULL)
                                      : t->code;
        shear_workspace_free(ws);
        shear_plan_free(plan);
    }
    return NULL;
}

static void *measure_with_given_plan(void *argument) {
    task *t = argument;
    const shear_stamps stamps = batch_full(t->b);
    shear_workspace *ws = NULL;
    t->code = shear_workspace_new(&ws, t->plan, NULL);
    for (int round = 0; round < 2 && t->code == SHEAR_OK; round++)
        t->code = shear_measure_range(t->plan, ws, &stamps, 0, COUNT, t->rows, NULL);
    shear_workspace_free(ws);
    return NULL;
}

enum { THREADS = 4 };

static void run(task *tasks, void *(*work)(void *)) {
    pthread_t threads[THREADS];
    for (int i = 0; i < THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, work, &tasks[i]), 0);
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        assert_int_equal(tasks[i].code, SHEAR_OK);
    }
}

static void test_plans_at_once(void **state) {
    (void)state;
    batch b;
    static task tasks[THREADS];
    draw(&b);
    for (int i = 0; i < THREADS; i++)
        tasks[i] = (task){.b = &b, .method = i == 3 ? 0 : 2 * i};
    run(tasks, measure_with_new_plans);
    assert_same_rows(tasks[3].rows, tasks[0].rows, 10); /* both `none` */
    for (int i = 0; i < THREADS; i++) {
        task alone = {.b = &b, .method = tasks[i].method};
        measure_with_new_plans(&alone);
        assert_same_rows(tasks[i].rows, alone.rows, 10);
    }
    batch_deinit(&b);
}

static void test_one_plan_at_once(void **state) {
    (void)state;
    batch b;
    static task tasks[THREADS];
    shear_settings settings;
    shear_row expected[COUNT];
    draw(&b);
    use(&settings, "log-bicubic");
    shear_plan *plan = batch_plan(&b, &settings, true, true);
    const shear_stamps stamps = batch_full(&b);
    batch_measure(plan, &stamps, expected);
    for (int i = 0; i < THREADS; i++)
        tasks[i] = (task){.b = &b, .plan = plan};
    run(tasks, measure_with_given_plan);
    for (int i = 0; i < THREADS; i++)
        assert_same_rows(tasks[i].rows, expected, COUNT);
    shear_plan_free(plan);
    batch_deinit(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_batch_is_the_same), cmocka_unit_test(test_own_workspaces),
        cmocka_unit_test(test_first_error),       cmocka_unit_test(test_no_stamps),
        cmocka_unit_test(test_plans_at_once),     cmocka_unit_test(test_one_plan_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
