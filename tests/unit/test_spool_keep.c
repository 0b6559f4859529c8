/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Retention in done/ and failed/. */
#include "spool_fixture.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* <folder>/NAME with a report that is `age_s` old. */
static void put(const spool_fixture *f, const char *folder, const char *name, const char *content,
                time_t age_s) {
    char path[128];
    const struct timespec times[2] = {{time(NULL) - age_s, 0}, {time(NULL) - age_s, 0}};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    fixture_write(f, path, content);
    snprintf(path, sizeof path, "%s/%s.json", folder, name);
    fixture_write(f, path, "{}");
    assert_int_equal(utimensat(AT_FDCWD, fixture_path(f, path), times, 0), 0);
}

static bool removed(const spool_fixture *f, const void *n) {
    return spool_get_stats(f->spool).removed >= *(const int *)n;
}

static void run_until_removed(spool_fixture *f, int n) {
    fixture_run_until(f, removed, &n);
    fixture_run_until_scans(f, 3);
    assert_int_equal(spool_get_stats(f->spool).removed, n);
}

static void begin(spool_fixture *f) {
    f->tuning.scan_ms = 20;
    fixture_open(f);
    fixture_close(f);
}

static void by_age(void **state) {
    spool_fixture *f = *state;
    begin(f);
    put(f, "done", "old.fits", "1", 7200);
    put(f, "done", "young.fits", "2", 60);
    put(f, "failed", "old.fits", "3", 7200);
    f->tuning.done.max_age_ms = 3600000;
    fixture_open(f);
    run_until_removed(f, 1);
    assert_false(fixture_has(f, "done/old.fits") || fixture_has(f, "done/old.fits.json"));
    assert_true(fixture_has(f, "done/young.fits") && fixture_has(f, "done/young.fits.json"));
    assert_true(fixture_has(f, "failed/old.fits") && fixture_has(f, "failed/old.fits.json"));
}

static void by_count_the_oldest_first(void **state) {
    spool_fixture *f = *state;
    begin(f);
    for (int i = 0; i < 10; i++) {
        char name[16];
        snprintf(name, sizeof name, "%d.fits", i);
        put(f, "failed", name, name, (i * 7) % 10 * 1000 + 1000); /* ages in no order */
    }
    f->tuning.failed.max_count = 3;
    fixture_open(f);
    run_until_removed(f, 7);
    assert_int_equal(fixture_count(f, "failed"), 6);
    for (int i = 0; i < 10; i++) {
        char name[32];
        snprintf(name, sizeof name, "failed/%d.fits", i);
        assert_int_equal(fixture_has(f, name), (i * 7) % 10 < 3);
    }
}

static void by_bytes_with_the_reports(void **state) {
    spool_fixture *f = *state;
    begin(f);
    put(f, "done", "a.fits", "12345678", 3000); /* 10 with the report */
    put(f, "done", "b.fits", "12345678", 2000);
    put(f, "done", "c.fits", "12345678", 1000);
    f->tuning.done.max_bytes = 20;
    fixture_open(f);
    run_until_removed(f, 1);
    assert_false(fixture_has(f, "done/a.fits"));
    f->tuning.done.max_bytes = 19;
    spool_tune(f->spool, &f->tuning);
    run_until_removed(f, 2);
    assert_true(fixture_has(f, "done/c.fits"));
    assert_int_equal(fixture_count(f, "done"), 2);
}

/* A job a.json and its report a.json.json are one item; so is a report whose file was taken away.
 */
static void jobs_count_once(void **state) {
    spool_fixture *f = *state;
    begin(f);
    put(f, "done", "a.json", "job", 3000);
    put(f, "done", "b.json", "job", 2000);
    put(f, "done", "c.fits", "gone", 1000);
    assert_int_equal(unlink(fixture_path(f, "done/c.fits")), 0);
    f->tuning.done.max_count = 3;
    fixture_open(f);
    fixture_run_until_scans(f, 3);
    assert_int_equal(fixture_count(f, "done"), 5);
    f->tuning.done.max_count = 2;
    spool_tune(f->spool, &f->tuning);
    run_until_removed(f, 1);
    assert_int_equal(fixture_count(f, "done"), 3);
}

static void what_is_not_ours_stays(void **state) {
    spool_fixture *f = *state;
    begin(f);
    fixture_write(f, "done/README", "?");
    assert_int_equal(mkdir(fixture_path(f, "done/dir.fits"), 0755), 0);
    assert_int_equal(symlink("README", fixture_path(f, "done/link.fits")), 0);
    put(f, "done", "a.fits", "1", 10);
    put(f, "done", "b.fits", "1", 5);
    f->tuning.done.max_count = 1;
    fixture_open(f);
    run_until_removed(f, 1);
    assert_int_equal(fixture_count(f, "done"), 5);
    assert_true(fixture_has(f, "done/b.fits"));
}

/* More than is read, or removed, in one turn of the loop. */
static void many(void **state) {
    spool_fixture *f = *state;
    begin(f);
    for (int i = 0; i < 600; i++) {
        char name[16];
        snprintf(name, sizeof name, "%03d.fits", i);
        put(f, "done", name, name, 10000 - i);
    }
    f->tuning.done.max_count = 100;
    fixture_open(f);
    run_until_removed(f, 500);
    assert_true(fixture_has(f, "done/500.fits"));
    assert_int_equal(fixture_count(f, "done"), 200);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

static bool ticked(const spool_fixture *f, const void *ticks) {
    (void)f;
    return *(const int *)ticks >= 3;
}

static void count_tick(uv_timer_t *timer) {
    ++*(int *)timer->data;
}

/* Nothing is in done/ and failed/ to look after: that is no reason to look for ever, and the loop's
 * other users have their turns meanwhile. */
static void empty_folders_are_looked_at_once(void **state) {
    spool_fixture *f = *state;
    int ticks = 0;
    uv_timer_t timer = {.data = &ticks};
    f->tuning.scan_ms = 20;
    f->tuning.done.max_count = 1;
    f->tuning.failed.max_count = 1;
    fixture_open(f);
    uv_timer_init(&f->loop, &timer);
    uv_timer_start(&timer, count_tick, 5, 5);
    fixture_run_until(f, ticked, &ticks);
    fixture_run_until_scans(f, 3);
    assert_int_equal(spool_get_stats(f->spool).removed, 0);
    uv_close((uv_handle_t *)&timer, NULL);
    uv_run(&f->loop, UV_RUN_NOWAIT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(by_age),
        TEST(by_count_the_oldest_first),
        TEST(by_bytes_with_the_reports),
        TEST(jobs_count_once),
        TEST(what_is_not_ours_stays),
        TEST(many),
        TEST(empty_folders_are_looked_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
