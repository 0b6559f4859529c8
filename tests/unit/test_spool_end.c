/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opening taken files, and from active/ to done/ and failed/. */
#include "spool_fixture.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Drop, wait until it is taken. Returns its number. */
static int take(spool_fixture *f, const char *name, const char *content) {
    char path[FIXTURE_NAME + 16];
    snprintf(path, sizeof path, "incoming/%s", name);
    fixture_write(f, path, content);
    fixture_run_until_found(f, f->n_found + 1);
    return f->n_found - 1;
}

static void good_and_bad(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    fixture_end(f, take(f, "a.fits", "good"), true, "{\"ok\":1}\n");
    fixture_end(f, take(f, "b.fits.gz", "bad"), false, "{\"ok\":0}\n");
    fixture_expect(f, "done/a.fits", "good");
    fixture_expect(f, "done/a.fits.json", "{\"ok\":1}\n");
    fixture_expect(f, "failed/b.fits.gz", "bad");
    fixture_expect(f, "failed/b.fits.gz.json", "{\"ok\":0}\n");
    assert_int_equal(fixture_count(f, "active"), 0);
    const spool_stats stats = spool_get_stats(f->spool);
    assert_int_equal(stats.done, 1);
    assert_int_equal(stats.failed, 1);
    assert_int_equal(stats.active, 0);
}

static void ended_twice_is_ended_once(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    const int n = take(f, "a.fits", "a");
    fixture_end(f, n, true, "first");
    fixture_end(f, n, true, "second");
    fixture_end(f, n, false, "third");
    fixture_expect(f, "done/a.fits.json", "first");
    assert_int_equal(fixture_count(f, "done"), 2);
    assert_int_equal(fixture_count(f, "failed"), 0);
    assert_int_equal(spool_get_stats(f->spool).done, 1);
}

static void names_are_never_overwritten(void **state) {
    spool_fixture *f = *state;
    char name[64];
    char content[16];
    fixture_open(f);
    for (int i = 0; i < 20; i++) {
        snprintf(content, sizeof content, "%d", i);
        fixture_end(f, take(f, "a.fits", content), true, content);
    }
    assert_int_equal(fixture_count(f, "done"), 40);
    fixture_expect(f, "done/a.fits", "0");
    for (int i = 1; i < 20; i++) {
        snprintf(content, sizeof content, "%d", i);
        snprintf(name, sizeof name, "done/a.%d.fits", i);
        fixture_expect(f, name, content);
        snprintf(name, sizeof name, "done/a.%d.fits.json", i);
        fixture_expect(f, name, content);
    }
}

/* a.fits.json is both a job and the name of the report of a.fits. */
static void jobs_and_reports_do_not_collide(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    fixture_end(f, take(f, "a.fits.json", "job"), true, "of job");
    fixture_end(f, take(f, "a.fits", "file"), true, "of file");
    fixture_end(f, take(f, "a.fits.json", "job 2"), true, "of job 2");
    fixture_expect(f, "done/a.fits.json", "job");
    fixture_expect(f, "done/a.fits.json.json", "of job");
    fixture_expect(f, "done/a.1.fits", "file");
    fixture_expect(f, "done/a.1.fits.json", "of file");
    fixture_expect(f, "done/a.fits.1.json", "job 2");
    assert_int_equal(fixture_count(f, "done"), 6);
}

static void what_others_put_there_stays(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    fixture_write(f, "done/a.fits", "theirs");
    assert_int_equal(symlink("nowhere", fixture_path(f, "done/a.1.fits.json")), 0);
    fixture_end(f, take(f, "a.fits", "ours"), true, "{}");
    fixture_expect(f, "done/a.fits", "theirs");
    fixture_expect(f, "done/a.2.fits", "ours");
    assert_false(fixture_has(f, "done/nowhere"));
}

static int open_code(const spool_fixture *f, const char *active_name, char *first) {
    shear_error err = {0};
    int fd = 0;
    const int code = spool_open_file(f->spool, active_name, &fd, &err);
    assert_true((code == SHEAR_OK) == (fd >= 0));
    if (fd >= 0) {
        assert_int_equal(read(fd, first, 1), 1);
        close(fd);
    } else if (code != SHEAR_E_INTERNAL) { /* told by the name that its owner knows */
        assert_non_null(strstr(err.message, "'a.fits'"));
        assert_null(strstr(err.message, active_name));
    }
    return code;
}

static void opening_taken_files(void **state) {
    spool_fixture *f = *state;
    char first = ' ';
    char path[FIXTURE_NAME + 16];
    fixture_open(f);
    const char *name = f->found[take(f, "a.fits", "pixels")].active_name;
    assert_int_equal(open_code(f, name, &first), SHEAR_OK);
    assert_int_equal(first, 'p');
    assert_int_equal(open_code(f, "../incoming/a.fits", &first), SHEAR_E_INTERNAL);
    snprintf(path, sizeof path, "active/%s", name);
    assert_int_equal(unlink(fixture_path(f, path)), 0);
    assert_int_equal(open_code(f, name, &first), SPOOL_GONE);
    assert_int_equal(symlink("/etc/passwd", fixture_path(f, path)), 0);
    assert_int_equal(open_code(f, name, &first), SPOOL_NOT_REGULAR);
    assert_int_equal(unlink(fixture_path(f, path)), 0);
    assert_int_equal(mkfifo(fixture_path(f, path), 0600), 0);
    assert_int_equal(open_code(f, name, &first), SPOOL_NOT_REGULAR);
    assert_int_equal(unlink(fixture_path(f, path)), 0);
    assert_int_equal(mkdir(fixture_path(f, path), 0700), 0);
    assert_int_equal(open_code(f, name, &first), SPOOL_NOT_REGULAR);
    if (geteuid() != 0) {
        assert_int_equal(rmdir(fixture_path(f, path)), 0);
        fixture_write(f, path, "x");
        assert_int_equal(chmod(fixture_path(f, path), 0), 0);
        assert_int_equal(open_code(f, name, &first), SPOOL_DENIED);
    }
}

/* Ends it in failed/, as the `n`-th of its name. */
static spool_place fail_it(spool_fixture *f, int found) {
    shear_error err = {0};
    spool_place place;
    assert_int_equal(spool_dispose(f->spool, f->found[found].active_name, false,
                                   f->found[found].key, &place, &err),
                     SHEAR_OK);
    return place;
}

static int take_back(const spool_fixture *f, int found, const spool_place *place) {
    shear_error err = {0};
    const int code = spool_restore(f->spool, f->found[found].active_name, place, &err);
    assert_true(code == SHEAR_OK || code == SHEAR_E_INTERNAL || err.advice[0] != '\0');
    return code;
}

static void back_and_again(void **state) {
    spool_fixture *f = *state;
    char buffer[SPOOL_PLACE_SIZE];
    char path[FIXTURE_NAME + 16];
    fixture_open(f);
    const int n = take(f, "a.fits", "a");
    const char *name = f->found[n].active_name;
    spool_place place = {.name = ""};
    snprintf(path, sizeof path, "active/%s", name);
    assert_string_equal(spool_locate(f->spool, name, &place, buffer), path);
    for (int i = 0; i < 3; i++) {
        place = fail_it(f, n);
        assert_string_equal(place.name, "failed/a.fits");
        assert_string_equal(spool_locate(f->spool, name, &place, buffer), "failed/a.fits");
        assert_int_equal(fixture_count(f, "active"), 0);
        assert_int_equal(take_back(f, n, &place), SHEAR_OK);
        assert_int_equal(take_back(f, n, &place), SHEAR_OK); /* it is there already */
        fixture_expect(f, path, "a");
        assert_int_equal(fixture_count(f, "failed"), 0);
        assert_int_equal(spool_get_stats(f->spool).active, 1);
    }
    fixture_run_for(f, 20);
    assert_int_equal(f->n_found, 1); /* its owner knows of it */
    fixture_end(f, n, true, "{}");
    fixture_expect(f, "done/a.fits", "a");
    assert_null(spool_locate(f->spool, name, &place, buffer));
}

static void not_what_it_was(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    const int n = take(f, "a.fits", "a");
    const spool_place place = fail_it(f, n);
    fixture_write(f, "failed/a.fits", "longer");
    assert_int_equal(take_back(f, n, &place), SPOOL_REPLACED);
    fixture_expect(f, "failed/a.fits", "longer");
    assert_int_equal(unlink(fixture_path(f, "failed/a.fits")), 0);
    assert_int_equal(take_back(f, n, &place), SPOOL_GONE);
    assert_int_equal(symlink("/etc/passwd", fixture_path(f, "failed/a.fits")), 0);
    assert_int_equal(take_back(f, n, &place), SPOOL_NOT_REGULAR);
    const spool_place nowhere = {.name = ""};
    const spool_place foreign = {.name = "incoming/a.fits"};
    const spool_place outside = {.name = "failed/../../a.fits"};
    assert_int_equal(take_back(f, n, &nowhere), SPOOL_GONE);
    assert_int_equal(take_back(f, n, &foreign), SPOOL_GONE);
    assert_int_equal(take_back(f, n, &outside), SPOOL_GONE);
    assert_int_equal(spool_restore(f->spool, "mine.fits", &place, NULL), SHEAR_E_INTERNAL);
}

/* By its report, among others of its name, some of which retention has taken. */
static void found_by_its_report(void **state) {
    spool_fixture *f = *state;
    spool_place place;
    fixture_open(f);
    for (int i = 0; i < 4; i++)
        fail_it(f, take(f, "a.fits", "a"));
    assert_int_equal(unlink(fixture_path(f, "failed/a.1.fits")), 0);
    assert_int_equal(unlink(fixture_path(f, "failed/a.1.fits.json")), 0);
    spool_find_place(f->spool, f->found[2].active_name, 9, &place);
    assert_string_equal(place.name, "failed/a.2.fits");
    assert_int_equal(take_back(f, 2, &place), SHEAR_OK);
    assert_int_equal(fixture_count(f, "failed"), 4);
    spool_find_place(f->spool, f->found[1].active_name, 9, &place);
    assert_string_equal(place.name, "");
}

static void names_of_others_are_refused(void **state) {
    spool_fixture *f = *state;
    shear_error err = {0};
    fixture_open(f);
    fixture_write(f, "active/mine.fits", "?");
    assert_int_equal(spool_dispose(f->spool, "mine.fits", true, "{}", NULL, &err),
                     SHEAR_E_INTERNAL);
    assert_int_equal(spool_dispose(f->spool, "../done", true, "{}", NULL, &err), SHEAR_E_INTERNAL);
    assert_true(fixture_has(f, "active/mine.fits"));
}

static void end_from_the_callback_of_a_refused_file(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    const int n = take(f, "a.fits", "a");
    assert_int_equal(spool_refuse(f->spool, f->found[n].active_name, NULL), SHEAR_OK);
    fixture_end(f, n, true, "{}");
    spool_wake(f->spool);
    fixture_run_for(f, 20);
    assert_int_equal(f->n_found, 1); /* what has ended is not told again */
    assert_string_equal(f->log, "");
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(good_and_bad),
        TEST(ended_twice_is_ended_once),
        TEST(names_are_never_overwritten),
        TEST(jobs_and_reports_do_not_collide),
        TEST(what_others_put_there_stays),
        TEST(opening_taken_files),
        TEST(back_and_again),
        TEST(not_what_it_was),
        TEST(found_by_its_report),
        TEST(names_of_others_are_refused),
        TEST(end_from_the_callback_of_a_refused_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
