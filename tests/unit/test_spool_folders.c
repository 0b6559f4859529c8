/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The directory, its lock, and folders that disappear. */
#include "spool_fixture.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int64_t no_room(void *context) {
    (void)context;
    return 0;
}

static void no_file(void *context, const spool_file *file) {
    (void)context;
    (void)file;
}

static void no_log(void *context, enum spool_level level, const char *text) {
    (void)context;
    (void)level;
    (void)text;
}

static int try_to_open(spool_fixture *f, shear_error *err) {
    static const spool_callbacks callbacks = {no_room, no_file, no_log, NULL, NULL};
    spool *s = NULL;
    const int code = spool_open(&s, &f->loop, f->directory, &f->tuning, &callbacks, err);
    assert_true((code == SHEAR_OK) == (s != NULL));
    spool_close(s);
    uv_run(&f->loop, UV_RUN_NOWAIT);
    return code;
}

static mode_t mode_of(const spool_fixture *f, const char *name) {
    struct stat st;
    assert_int_equal(stat(fixture_path(f, name), &st), 0);
    return st.st_mode & 07777;
}

static void folders_are_made(void **state) {
    spool_fixture *f = *state;
    const mode_t mask = umask(027);
    fixture_open(f);
    umask(mask);
    assert_int_equal(mode_of(f, ".") & 0777, 0750);
    assert_int_equal(mode_of(f, "incoming"), 03770);
    assert_int_equal(mode_of(f, "active"), 02750);
    assert_int_equal(mode_of(f, "done"), 02750);
    assert_int_equal(mode_of(f, "failed"), 02750);
}

static void folders_keep_their_mode(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    fixture_close(f);
    assert_int_equal(chmod(fixture_path(f, "incoming"), 0711), 0);
    fixture_open(f);
    assert_int_equal(mode_of(f, "incoming"), 0711);
}

static void one_owner_at_a_time(void **state) {
    spool_fixture *f = *state;
    shear_error err = {0};
    fixture_open(f);
    assert_int_equal(try_to_open(f, &err), SPOOL_LOCKED);
    assert_non_null(strstr(err.message, "another sheard (process "));
    assert_non_null(strstr(err.message, f->directory));
    spool_close(f->spool); /* the lock is free before the loop turns */
    f->spool = NULL;
    assert_int_equal(try_to_open(f, &err), SHEAR_OK);
}

static void bad_directories(void **state) {
    spool_fixture *f = *state;
    shear_error err = {0};
    snprintf(f->directory, sizeof f->directory, "%s/missing/spool", f->root);
    assert_int_equal(try_to_open(f, &err), SHEAR_E_IO);
    assert_non_null(strstr(err.message, "missing/spool"));
    snprintf(f->directory, sizeof f->directory, "%s/spool", f->root);
    assert_int_equal(mkdir(f->directory, 0755), 0);
    fixture_write(f, "done", "a file");
    assert_int_equal(try_to_open(f, &err), SHEAR_E_IO);
    assert_non_null(strstr(err.message, "spool/done: cannot open it"));
    assert_int_equal(unlink(fixture_path(f, "done")), 0);
    assert_int_equal(symlink("/tmp", fixture_path(f, "done")), 0);
    assert_int_equal(try_to_open(f, &err), SHEAR_E_IO);
    assert_int_equal(unlink(fixture_path(f, "done")), 0);
    assert_int_equal(try_to_open(f, &err), SHEAR_OK);
}

static bool is_watching(const spool_fixture *f, const void *argument) {
    return spool_get_stats(f->spool).watching && strstr(f->log, argument) != NULL;
}

static void removed_incoming_is_made_anew(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    fixture_run_until_scans(f, 1);
    assert_int_equal(rmdir(fixture_path(f, "incoming")), 0);
    fixture_run_until(f, is_watching, "is there again");
    assert_int_equal(f->n_logs[SPOOL_WARNING], 1);
    fixture_write(f, "incoming/a.fits", "a");
    fixture_run_until_found(f, 1);
}

static void replaced_incoming_is_watched(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    fixture_run_until_scans(f, 1);
    assert_int_equal(rename(fixture_path(f, "incoming"), fixture_path(f, "aside")), 0);
    assert_int_equal(mkdir(fixture_path(f, "incoming"), 0770), 0);
    fixture_run_until(f, is_watching, "is there again");
    fixture_write(f, "aside/b.fits", "b");
    fixture_write(f, "incoming/a.fits", "a");
    fixture_run_until_found(f, 1);
    assert_string_equal(f->found[0].name, "a.fits");
    assert_true(fixture_has(f, "aside/b.fits"));
}

static bool complained(const spool_fixture *f, const void *text) {
    return strstr(f->log, text) != NULL;
}

static void directory_away_and_back(void **state) {
    spool_fixture *f = *state;
    char away[256];
    f->tuning.scan_ms = 20;
    fixture_open(f);
    fixture_run_until_scans(f, 1);
    snprintf(away, sizeof away, "%s/away", f->root);
    assert_int_equal(rename(f->directory, away), 0);
    fixture_run_until(f, complained, "no files are taken meanwhile");
    fixture_run_for(f, 100);
    assert_int_equal(f->n_logs[SPOOL_ERROR], 1);
    assert_int_equal(rename(away, f->directory), 0);
    fixture_write(f, "incoming/a.fits", "a");
    fixture_run_until_found(f, 1);
}

static void removed_done_is_made_anew(void **state) {
    spool_fixture *f = *state;
    shear_error err = {0};
    fixture_open(f);
    fixture_write(f, "incoming/a.fits", "a");
    fixture_run_until_found(f, 1);
    assert_int_equal(rmdir(fixture_path(f, "done")), 0);
    assert_int_equal(spool_dispose(f->spool, f->found[0].active_name, true, "{}", NULL, &err),
                     SHEAR_E_IO);
    assert_int_equal(fixture_count(f, "active"), 1);
    f->tuning.scan_ms = 1;
    spool_tune(f->spool, &f->tuning);
    fixture_run_until_scans(f, 1);
    fixture_end(f, 0, true, "{}");
    fixture_expect(f, "done/a.fits", "a");
}

static void strangers_in_active_are_left_alone(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    fixture_close(f);
    fixture_write(f, "active/mine.fits", "?");
    fixture_open(f);
    fixture_run_until_scans(f, 1);
    assert_int_equal(f->n_found, 0);
    assert_non_null(strstr(f->log, "active/mine.fits: ignored"));
    fixture_expect(f, "active/mine.fits", "?");
}

static spool *closing;
static void close_it(void *context, const spool_file *file) {
    (void)context;
    (void)file;
    spool_close(closing);
}

static int64_t much_room(void *context) {
    (void)context;
    return 10;
}

static void closed_from_the_callback(void **state) {
    spool_fixture *f = *state;
    static const spool_callbacks callbacks = {much_room, close_it, no_log, NULL, NULL};
    fixture_open(f);
    fixture_close(f);
    fixture_write(f, "incoming/a.fits", "a");
    fixture_write(f, "incoming/b.fits", "b");
    assert_int_equal(spool_open(&closing, &f->loop, f->directory, &f->tuning, &callbacks, NULL),
                     SHEAR_OK);
    uv_run(&f->loop, UV_RUN_DEFAULT); /* ends: no handle is left */
    fixture_open(f);
    fixture_run_until_found(f, 2);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(folders_are_made),
        TEST(folders_keep_their_mode),
        TEST(one_owner_at_a_time),
        TEST(bad_directories),
        TEST(removed_incoming_is_made_anew),
        TEST(replaced_incoming_is_watched),
        TEST(directory_away_and_back),
        TEST(removed_done_is_made_anew),
        TEST(strangers_in_active_are_left_alone),
        TEST(closed_from_the_callback),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
