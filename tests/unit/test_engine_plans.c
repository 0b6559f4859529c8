/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kept plans: equal inputs share one, different ones do not; the limits hold, plans in use are
 * never freed, and no plan is counted twice. */
#include "engine/budget.h"
#include "engine/internal.h"
#include "engine/plan_cache.h"
#include "gaussian.h"
#include "test.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 12, PSF_SIDE = 9, MANY = INT32_MAX };
static const int64_t much = INT64_C(1) << 40;

/* A field of one PSF, of scale radius `r` pixels; `moved` is added to the corner sample. */
typedef struct fake_field {
    shear_settings settings;
    shear_field_info info;
    double r, moved;
    int reads;
} fake_field;

static fake_field a_field(double r) {
    fake_field f = {.info = {.geometry = {.nx = SIDE,
                                          .ny = SIDE,
                                          .psf_nx = PSF_SIDE,
                                          .psf_ny = PSF_SIDE,
                                          .psf_oversample = 1},
                             .n_stamps = 16,
                             .n_psf = 1,
                             .psf_layout = SHEAR_PSF_ONE},
                    .r = r};
    shear_settings_init(&f.settings);
    return f;
}

static int read_psf(void *self, int64_t index, double *out, shear_error *err) {
    fake_field *f = self;
    const shear_geometry *g = &f->info.geometry;
    f->reads++;
    (void)index;
    (void)err;
    const double r = f->r * (double)g->psf_oversample;
    const gaussian psf = {.amplitude = 1.0,
                          .xx = r * r,
                          .yy = r * r,
                          .x0 = 0.5 * (g->psf_nx - 1),
                          .y0 = 0.5 * (g->psf_ny - 1)};
    gaussian_draw(&psf, g->psf_nx, g->psf_ny, 1, out);
    out[0] += f->moved;
    return SHEAR_OK;
}

static int try_to_take(plan_cache *p, fake_field *f, const shear_plan **plan, shear_error *err) {
    shear_plan_request request;
    const shear_psf_source psfs = {.self = f, .read = read_psf};
    assert_int_equal(shear_plan_request_read(&request, &f->settings, &f->info, psfs, err),
                     SHEAR_OK);
    const int code = plan_cache_acquire(p, &request, plan, err);
    shear_plan_request_deinit(&request);
    return code;
}

static const shear_plan *take(plan_cache *p, fake_field *f) {
    const shear_plan *plan = NULL;
    shear_error err = {0};
    if (try_to_take(p, f, &plan, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    plan_cache_count(p, plan);
    return plan;
}

static void expect(plan_cache *p, int64_t count, int64_t hits, int64_t misses) {
    const plan_cache_statistics s = plan_cache_get_statistics(p);
    assert_int_equal(s.count, count);
    assert_int_equal(s.hits, hits);
    assert_int_equal(s.misses, misses);
    assert_true((s.bytes > 0) == (count > 0));
}

static void test_equal_fields_share(void **state) {
    (void)state;
    plan_cache *p = plan_cache_new(4, much);
    fake_field a = a_field(1.3);
    fake_field b = a_field(1.3);
    const shear_plan *first = take(p, &a);
    assert_ptr_equal(take(p, &b), first);
    assert_int_equal(a.reads + b.reads, 2);
    plan_cache_release(p, first);
    plan_cache_release(p, first);
    b.info.n_stamps = 5; /* not the plan's business */
    assert_ptr_equal(take(p, &b), first);
    plan_cache_release(p, first);
    expect(p, 1, 2, 1);
    plan_cache_free(p);
}

/* One thing differs from the base field, each time another. */
static void differ(fake_field *f, int how) {
    shear_geometry *g = &f->info.geometry;
    switch (how) {
    case 0:
        f->moved = 1e-15;
        break;
    case 1:
        f->settings.beta_px = 2.0;
        break;
    case 2:
        f->settings.beta_px = nextafter(2.0, 3.0);
        break;
    case 3:
        f->settings.noise_correction = false;
        break;
    case 4:
        f->settings.interpolation = SHEAR_INTERP_SPLINE;
        break;
    case 5:
        g->nx++;
        break;
    case 6:
        g->ny++;
        break;
    case 7:
        f->info.columns = SHEAR_COL_R_GAL;
        break;
    case 8: /* the same samples, but twice as fine */
        g->psf_oversample = 2;
        f->r *= 0.5;
        break;
    case 9: /* a PSF for each stamp, of the same radius */
        f->info.psf_layout = SHEAR_PSF_PER_STAMP;
        f->info.n_psf = 16;
        break;
    default:
        break;
    }
}
enum { WAYS = 10 };

static void test_whatever_differs_is_another(void **state) {
    (void)state;
    plan_cache *p = plan_cache_new(MANY, much);
    fake_field base = a_field(1.3);
    const shear_plan *seen[WAYS + 1] = {take(p, &base)};
    for (int how = 0; how < WAYS; how++) {
        fake_field f = a_field(1.3);
        differ(&f, how);
        seen[how + 1] = take(p, &f);
        for (int i = 0; i <= how; i++)
            assert_ptr_not_equal(seen[how + 1], seen[i]);
    }
    for (int how = 0; how < WAYS; how++) {
        fake_field f = a_field(1.3);
        differ(&f, how);
        assert_ptr_equal(take(p, &f), seen[how + 1]);
        plan_cache_release(p, seen[how + 1]);
    }
    expect(p, WAYS + 1, WAYS, WAYS + 1);
    for (int i = 0; i <= WAYS; i++)
        plan_cache_release(p, seen[i]);
    plan_cache_free(p);
}

static void touch(plan_cache *p, double r) {
    fake_field f = a_field(r);
    plan_cache_release(p, take(p, &f));
}

static void test_the_oldest_goes_first(void **state) {
    (void)state;
    plan_cache *p = plan_cache_new(2, much);
    touch(p, 1.1);
    touch(p, 1.2);
    touch(p, 1.1); /* hit: now 1.2 is the older one */
    touch(p, 1.3);
    expect(p, 2, 1, 3);
    touch(p, 1.1);
    expect(p, 2, 2, 3);
    touch(p, 1.2);
    expect(p, 2, 2, 4);
    plan_cache_free(p);
}

static void test_bytes_and_none(void **state) {
    (void)state;
    plan_cache *p = plan_cache_new(MANY, much);
    touch(p, 1.1);
    const int64_t one = plan_cache_get_statistics(p).bytes;
    touch(p, 1.2);
    assert_int_equal(plan_cache_get_statistics(p).bytes, 2 * one);
    plan_cache_limit(p, MANY, 2 * one);
    expect(p, 2, 0, 2);
    plan_cache_limit(p, MANY, 2 * one - 1);
    expect(p, 1, 0, 2);
    touch(p, 1.2);
    expect(p, 1, 1, 2);
    plan_cache_limit(p, 0, much);
    expect(p, 0, 1, 2);
    touch(p, 1.2);
    expect(p, 0, 1, 3);
    plan_cache_free(p);
}

/* Kept beyond the bounds while it is in use, and shared all the same; given up when it is not. */
static void test_in_use_stays(void **state) {
    (void)state;
    plan_cache *p = plan_cache_new(0, 0);
    fake_field a = a_field(1.1);
    fake_field b = a_field(1.2);
    const shear_plan *one = take(p, &a);
    const shear_plan *two = take(p, &b);
    assert_ptr_equal(take(p, &a), one);
    assert_true(shear_plan_get_info(one)->r_psf_px < shear_plan_get_info(two)->r_psf_px);
    plan_cache_release(p, one);
    expect(p, 2, 1, 2);
    plan_cache_release(p, two);
    assert_true(shear_plan_get_info(one)->r_psf_px > 0.0);
    expect(p, 1, 1, 2);
    plan_cache_release(p, one);
    expect(p, 0, 1, 2);
    plan_cache_free(p);
}

/* What is idle goes, the longest unused first, and no more than must. */
static void test_shrunk(void **state) {
    (void)state;
    plan_cache *p = plan_cache_new(MANY, much);
    fake_field a = a_field(1.3);
    fake_field b = a_field(1.4);
    fake_field c = a_field(1.5);
    const shear_plan *kept = take(p, &a);
    plan_cache_release(p, take(p, &b));
    plan_cache_release(p, take(p, &c));
    const int64_t all = plan_cache_get_statistics(p).bytes;
    assert_int_equal(plan_cache_shrink_to(p, all), all);
    expect(p, 3, 0, 3);
    assert_true(plan_cache_shrink_to(p, all - 1) < all);
    expect(p, 2, 0, 3);
    plan_cache_release(p, take(p, &c)); /* still there */
    expect(p, 2, 1, 3);
    assert_true(plan_cache_shrink_to(p, 0) >= shear_plan_bytes(kept)); /* in use */
    expect(p, 1, 1, 3);
    plan_cache_release(p, kept);
    assert_int_equal(plan_cache_shrink_to(p, 0), 0);
    expect(p, 0, 1, 3);
    plan_cache_free(p);
}

/* Its bytes are its maker's until it is counted, which happens once, at the latest on release. */
static void test_counted_when_told(void **state) {
    (void)state;
    plan_cache *p = plan_cache_new(MANY, much);
    fake_field a = a_field(1.3);
    const shear_plan *plan = NULL;
    assert_int_equal(try_to_take(p, &a, &plan, NULL), SHEAR_OK);
    expect(p, 0, 0, 1);
    assert_ptr_equal(take(p, &a), plan);
    const int64_t bytes = plan_cache_get_statistics(p).bytes;
    plan_cache_count(p, plan);
    plan_cache_release(p, plan);
    plan_cache_release(p, plan);
    expect(p, 1, 1, 1);
    assert_int_equal(plan_cache_get_statistics(p).bytes, bytes);
    a.moved = 1e-15;
    assert_int_equal(try_to_take(p, &a, &plan, NULL), SHEAR_OK);
    expect(p, 1, 1, 2);
    plan_cache_release(p, plan);
    expect(p, 2, 1, 2);
    plan_cache_free(p);
}

static void ignore(void *context) {
    (void)context;
}

/* At every step of a job, what is said to be used is what it has reserved and the other plans. */
static void test_a_plan_is_used_once(void **state) {
    (void)state;
    enum { PLANNING = 1 << 28, BESIDE = 1000 };
    const engine_options options = {.workers = 1,
                                    .limits = {.program = "none", .scratch = "none"},
                                    .plans_count = MANY,
                                    .plans_bytes = much,
                                    .memory_bytes = PLANNING,
                                    .wake = ignore};
    engine *e = NULL;
    assert_int_equal(engine_new(&e, &options, NULL), SHEAR_OK);
    fake_field field = a_field(1.3);
    job j = {.engine = e, .phase = JOB_PREPARING};
    assert_int_equal(budget_wait(&j, PLANNING), BUDGET_RESERVED);
    assert_int_equal(try_to_take(e->plans, &field, &j.plan, NULL), SHEAR_OK);
    assert_int_equal(engine_get_load(e).memory_used, PLANNING);
    assert_true(budget_settle(&j, BESIDE));
    const int64_t plan = engine_get_load(e).plans.bytes;
    assert_true(plan >= shear_plan_bytes(j.plan));
    assert_int_equal(engine_get_load(e).memory_used, plan + BESIDE);
    assert_false(budget_settle(&j, PLANNING)); /* there is no room for it beside the plan */
    assert_null(j.plan);
    assert_int_equal(engine_get_load(e).memory_used, plan);
    assert_int_equal(budget_wait(&j, PLANNING), BUDGET_RESERVED); /* the idle plan is freed */
    assert_int_equal(engine_get_load(e).plans.count, 0);
    assert_int_equal(try_to_take(e->plans, &field, &j.plan, NULL), SHEAR_OK);
    budget_return(&j);
    assert_int_equal(engine_get_load(e).memory_used, plan);
    engine_free(e);
}

typedef struct waiter {
    job job;
    int64_t bytes;
    enum budget_answer answer;
    pthread_t thread;
} waiter;

static void *wait_for_memory(void *argument) {
    waiter *w = argument;
    w->answer = budget_wait(&w->job, w->bytes);
    return NULL;
}

/* Add the job to the engine's list, and return when it waits for memory as one of `n`. */
static void begin_to_wait(engine *e, waiter *w, int n) {
    w->job = (job){.engine = e, .phase = JOB_PREPARING, .next = e->jobs};
    pthread_mutex_lock(&e->lock);
    e->jobs = &w->job;
    pthread_mutex_unlock(&e->lock);
    assert_int_equal(thread_start(&w->thread, wait_for_memory, w), 0);
    while (engine_get_load(e).memory_waiting < n)
        usleep(1000);
}

/* A job that stops waiting lets those behind it have what is free, at once. */
static void test_who_stops_waiting_blocks_nobody(void **state) {
    (void)state;
    enum { TOTAL = 1000, HELD = 900, PATIENCE = 500, PAUSE_US = 10000 };
    const engine_options options = {.workers = 1,
                                    .limits = {.program = "none", .scratch = "none"},
                                    .memory_bytes = TOTAL,
                                    .wake = ignore};
    engine *e = NULL;
    assert_int_equal(engine_new(&e, &options, NULL), SHEAR_OK);
    job holder = {.engine = e, .phase = JOB_PREPARING};
    waiter large = {.bytes = TOTAL};
    waiter small = {.bytes = 1};
    assert_int_equal(budget_wait(&holder, HELD), BUDGET_RESERVED);
    begin_to_wait(e, &large, 1);
    begin_to_wait(e, &small, 2);
    pthread_mutex_lock(&e->lock);
    large.job.stop_asked = true;
    pthread_mutex_unlock(&e->lock);
    /* The one that waits longest is woken alone. */
    int left = PATIENCE;
    for (; left > 0 && engine_get_load(e).memory_waiting > 0; left--) {
        if (engine_get_load(e).memory_waiting == 2)
            pthread_cond_signal(&e->progressed);
        usleep(PAUSE_US);
    }
    assert_true(left > 0);
    pthread_join(large.thread, NULL);
    pthread_join(small.thread, NULL);
    assert_int_equal(large.answer, BUDGET_STOP);
    assert_int_equal(small.answer, BUDGET_RESERVED);
    budget_return(&small.job);
    budget_return(&holder);
    pthread_mutex_lock(&e->lock);
    e->jobs = NULL;
    pthread_mutex_unlock(&e->lock);
    engine_free(e);
}

static void test_errors_are_not_kept(void **state) {
    (void)state;
    plan_cache *p = plan_cache_new(4, much);
    fake_field f = a_field(1.3);
    const shear_plan *plan = NULL;
    shear_error err = {0};
    f.settings.beta_px = 0.01;
    assert_int_equal(try_to_take(p, &f, &plan, &err), SHEAR_E_BETA);
    assert_null(plan);
    expect(p, 0, 0, 1);
    plan_cache_release(p, NULL);
    plan_cache_free(p);
}

/* ---- many threads ---- */

enum { THREADS = 4, ROUNDS = 60, RADII = 3 };
typedef struct busy {
    plan_cache *p;
    int number;
} busy;

static void *work(void *argument) {
    const busy *b = argument;
    for (int i = 0; i < ROUNDS; i++) {
        const double r = 1.1 + 0.1 * ((i + b->number) % RADII);
        fake_field f = a_field(r);
        const shear_plan *plan = take(b->p, &f);
        assert_true(fabs(shear_plan_get_info(plan)->r_psf_px - r) < 0.05);
        plan_cache_release(b->p, plan);
    }
    return NULL;
}

static void test_many_threads(void **state) {
    (void)state;
    plan_cache *p = plan_cache_new(1, much);
    pthread_t threads[THREADS];
    busy b[THREADS];
    for (int i = 0; i < THREADS; i++) {
        b[i] = (busy){.p = p, .number = i};
        assert_int_equal(pthread_create(&threads[i], NULL, work, &b[i]), 0);
    }
    for (int i = 0; i < THREADS; i++)
        pthread_join(threads[i], NULL);
    const plan_cache_statistics s = plan_cache_get_statistics(p);
    assert_int_equal(s.hits + s.misses, THREADS * ROUNDS);
    assert_int_equal(s.count, 1);
    plan_cache_free(p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_equal_fields_share),
        cmocka_unit_test(test_whatever_differs_is_another),
        cmocka_unit_test(test_the_oldest_goes_first),
        cmocka_unit_test(test_bytes_and_none),
        cmocka_unit_test(test_shrunk),
        cmocka_unit_test(test_in_use_stays),
        cmocka_unit_test(test_counted_when_told),
        cmocka_unit_test(test_a_plan_is_used_once),
        cmocka_unit_test(test_who_stops_waiting_blocks_nobody),
        cmocka_unit_test(test_errors_are_not_kept),
        cmocka_unit_test(test_many_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
