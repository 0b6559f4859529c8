/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From incoming/ to active/: which files are taken, and when. */
#include "spool_fixture.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* With this no scan and no settling can be the reason why a file is taken. */
static void only_events(spool_fixture *f) {
    f->tuning.settle_ms = 3600000;
    fixture_open(f);
    fixture_run_until_scans(f, 1);
}

static void expect_only(const spool_fixture *f, const char *name, const char *content) {
    char path[FIXTURE_NAME + 16];
    assert_int_equal(f->n_found, 1);
    assert_string_equal(f->found[0].name, name);
    assert_false(f->found[0].again);
    snprintf(path, sizeof path, "active/%s", f->found[0].active_name);
    fixture_expect(f, path, content);
}

static void closed_file_is_taken_at_once(void **state) {
    spool_fixture *f = *state;
    only_events(f);
    fixture_write(f, "incoming/a.fits", "pixels");
    fixture_run_until_found(f, 1);
    expect_only(f, "a.fits", "pixels");
    assert_false(fixture_has(f, "incoming/a.fits"));
    const spool_stats stats = spool_get_stats(f->spool);
    assert_true(stats.watching);
    assert_int_equal(stats.taken, 1);
    assert_int_equal(stats.active, 1);
    assert_int_equal(stats.waiting, 0);
}

static void renamed_file_is_taken_at_once(void **state) {
    spool_fixture *f = *state;
    only_events(f);
    fixture_write(f, "incoming/a.fits.part", "pixels");
    fixture_write(f, "incoming/.b.fits", "hidden");
    fixture_write(f, "incoming/c.fits.tmp", "temporary");
    fixture_write(f, "incoming/z.fits", "last");
    fixture_run_until_found(f, 1); /* events come in order: the others have been looked at */
    assert_string_equal(f->found[0].name, "z.fits");
    f->n_found = 0;
    assert_int_equal(
        rename(fixture_path(f, "incoming/a.fits.part"), fixture_path(f, "incoming/a.fits")), 0);
    fixture_run_until_found(f, 1);
    expect_only(f, "a.fits", "pixels");
    assert_int_equal(spool_get_stats(f->spool).ignored, 0);
    assert_string_equal(f->log, "");
}

static void moved_in_from_outside(void **state) {
    spool_fixture *f = *state;
    only_events(f);
    fixture_write(f, "a.fits", "pixels");
    assert_int_equal(rename(fixture_path(f, "a.fits"), fixture_path(f, "incoming/a.fits")), 0);
    fixture_run_until_found(f, 1);
    expect_only(f, "a.fits", "pixels");
}

static void slow_writer_is_waited_for(void **state) {
    spool_fixture *f = *state;
    f->tuning.settle_ms = 20; /* its pauses are longer */
    f->tuning.scan_ms = 10;
    fixture_open(f);
    fixture_run_until_scans(f, 1);
    const int fd = open(fixture_path(f, "incoming/a.fits"), O_WRONLY | O_CREAT, 0644);
    assert_true(fd >= 0);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(write(fd, "part,", 5), 5);
        fixture_run_for(f, 100);
        assert_int_equal(f->n_found, 0);
    }
    assert_int_equal(spool_get_stats(f->spool).waiting, 1);
    close(fd);
    fixture_run_until_found(f, 1);
    expect_only(f, "a.fits", "part,part,part,part,");
}

static void written_while_it_waits(void **state) {
    spool_fixture *f = *state;
    f->room = 0;
    only_events(f);
    fixture_write(f, "incoming/a.fits", "old");
    fixture_run_for(f, 50);
    assert_int_equal(spool_get_stats(f->spool).waiting, 1);
    const int fd = open(fixture_path(f, "incoming/a.fits"), O_WRONLY | O_TRUNC);
    assert_int_equal(write(fd, "new, ", 5), 5);
    f->room = 1;
    spool_wake(f->spool);
    fixture_run_for(f, 50);
    assert_int_equal(f->n_found, 0);
    assert_int_equal(write(fd, "complete", 8), 8);
    close(fd);
    fixture_run_until_found(f, 1);
    expect_only(f, "a.fits", "new, complete");
}

static void second_link_settles(void **state) {
    spool_fixture *f = *state;
    f->tuning.settle_ms = 50;
    fixture_open(f);
    fixture_run_until_scans(f, 1);
    fixture_write(f, "mine.fits", "pixels");
    assert_int_equal(link(fixture_path(f, "mine.fits"), fixture_path(f, "incoming/a.fits")), 0);
    fixture_run_until_found(f, 1);
    expect_only(f, "a.fits", "pixels");
    fixture_expect(f, "mine.fits", "pixels");
}

/* Complete when its name appears, and never closed under that name. */
static void linked_unnamed_file_is_taken_in_the_end(void **state) {
    spool_fixture *f = *state;
    char self[64];
    fixture_open(f);
    fixture_run_until_scans(f, 1);
    const int fd = open(f->directory, O_TMPFILE | O_WRONLY, 0644);
    if (fd < 0) {
        skip(); /* not every file system has them */
    }
    assert_int_equal(write(fd, "pixels", 6), 6);
    snprintf(self, sizeof self, "/proc/self/fd/%d", fd);
    assert_int_equal(
        linkat(AT_FDCWD, self, AT_FDCWD, fixture_path(f, "incoming/a.fits"), AT_SYMLINK_FOLLOW), 0);
    close(fd);
    fixture_run_until_found(f, 1);
    expect_only(f, "a.fits", "pixels");
}

static void found_by_scan_only_when_still(void **state) {
    spool_fixture *f = *state;
    f->tuning.settle_ms = 200;
    fixture_open(f);
    fixture_run_until_scans(f, 1);
    fixture_close(f);
    fixture_write(f, "incoming/a.fits", "growing");
    fixture_open(f);
    const uint64_t begin = uv_hrtime();
    fixture_run_until_scans(f, 1);
    assert_int_equal(f->n_found, 0);
    /* Another machine goes on writing: no event comes for it. A change of the times is enough. */
    const struct timespec times[2] = {{1000000000, 0}, {1000000000, 0}};
    assert_int_equal(utimensat(AT_FDCWD, fixture_path(f, "incoming/a.fits"), times, 0), 0);
    fixture_run_until_found(f, 1);
    assert_true(uv_hrtime() - begin >= 2 * 200000000ULL);
    expect_only(f, "a.fits", "growing");
}

static void scan_finds_what_was_there(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    fixture_close(f);
    fixture_write(f, "incoming/a.fits", "a");
    fixture_write(f, "incoming/b.json", "b");
    fixture_open(f);
    fixture_run_until_found(f, 2);
    assert_non_null(fixture_find(f, "a.fits"));
    assert_non_null(fixture_find(f, "b.json"));
}

static void empty_file_settles(void **state) {
    spool_fixture *f = *state;
    f->tuning.settle_ms = 100;
    fixture_open(f);
    fixture_run_until_scans(f, 1);
    fixture_write(f, "incoming/a.fits", "");
    fixture_run_until_found(f, 1);
    expect_only(f, "a.fits", "");
}

static void others_are_ignored_with_one_message(void **state) {
    spool_fixture *f = *state;
    f->tuning.scan_ms = 20;
    fixture_open(f);
    fixture_write(f, "outside.fits", "secret");
    fixture_write(f, "incoming/README", "?");
    fixture_write(f, "incoming/a\n.fits", "?");
    assert_int_equal(symlink("../outside.fits", fixture_path(f, "incoming/link.fits")), 0);
    assert_int_equal(mkdir(fixture_path(f, "incoming/dir.fits"), 0755), 0);
    assert_int_equal(mkfifo(fixture_path(f, "incoming/pipe.fits"), 0644), 0);
    fixture_run_until_scans(f, 5);
    assert_int_equal(f->n_found, 0);
    assert_int_equal(f->n_logs[SPOOL_NOTICE], 5);
    assert_non_null(strstr(f->log, "incoming/README: ignored: its name ends neither in .fits"));
    assert_non_null(strstr(f->log, "incoming/a?.fits: ignored: its name has control characters"));
    assert_non_null(strstr(f->log, "incoming/link.fits: ignored: it is a symbolic link"));
    assert_int_equal(spool_get_stats(f->spool).ignored, 5);
    spool_ignored list[8];
    assert_int_equal(spool_get_ignored(f->spool, list, 8), 5);
    for (size_t i = 0; i < 5; i++) {
        const bool is_pipe = strcmp(list[i].name, "pipe.fits") == 0;
        assert_true(!is_pipe || strcmp(list[i].reason, "it is a named pipe") == 0);
        assert_true(list[i].reason[0] != '\0');
    }
    assert_int_equal(spool_get_ignored(f->spool, list, 2), 2);
    /* A file in the link's place is taken. */
    fixture_write(f, "incoming/x.part", "pixels");
    assert_int_equal(
        rename(fixture_path(f, "incoming/x.part"), fixture_path(f, "incoming/link.fits")), 0);
    assert_int_equal(rmdir(fixture_path(f, "incoming/dir.fits")), 0);
    fixture_run_until_found(f, 1);
    expect_only(f, "link.fits", "pixels");
    fixture_run_until_scans(f, 2);
    assert_int_equal(spool_get_stats(f->spool).ignored, 3);
}

static void full_queue_leaves_files_waiting(void **state) {
    spool_fixture *f = *state;
    f->room = 2;
    only_events(f);
    for (char name[] = "incoming/a.fits"; name[9] <= 'e'; name[9]++)
        fixture_write(f, name, name);
    fixture_run_until_found(f, 2);
    fixture_run_for(f, 50);
    assert_int_equal(f->n_found, 2);
    assert_int_equal(spool_get_stats(f->spool).waiting, 3);
    assert_true(fixture_has(f, "incoming/c.fits"));
    f->room = 10;
    spool_wake(f->spool);
    fixture_run_until_found(f, 5);
    for (int i = 0; i < 5; i++) { /* in the order of arrival */
        assert_int_equal(f->found[i].name[0], 'a' + i);
    }
}

static void refused_file_is_told_again(void **state) {
    spool_fixture *f = *state;
    f->refusals = 2;
    f->tuning.scan_ms = 20;
    fixture_open(f);
    fixture_write(f, "incoming/a.fits", "pixels");
    fixture_run_until_found(f, 1);
    assert_true(f->found[0].again);
    assert_int_equal(spool_get_stats(f->spool).taken, 1);
    fixture_run_until_scans(f, 2);
    assert_int_equal(f->n_found, 1);
}

static bool nothing_refused(const spool_fixture *f, const void *argument) {
    (void)argument;
    return f->refusals == 0;
}

static void refused_file_does_not_hold_up_others(void **state) {
    spool_fixture *f = *state;
    f->refusals = 1;
    only_events(f);
    fixture_write(f, "incoming/a.fits", "a");
    fixture_run_until(f, nothing_refused, NULL);
    fixture_write(f, "incoming/b.fits", "b");
    fixture_run_until_found(f, 1);
    assert_string_equal(f->found[0].name, "b.fits");
    spool_wake(f->spool);
    fixture_run_until_found(f, 2);
    assert_string_equal(f->found[1].name, "a.fits");
}

static void taken_files_are_told_again_first(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    fixture_write(f, "incoming/a.fits", "a");
    fixture_run_until_found(f, 1);
    fixture_close(f);
    fixture_write(f, "incoming/A.fits", "new");
    fixture_open(f);
    assert_int_equal(spool_get_stats(f->spool).active, 1);
    fixture_run_until_found(f, 3);
    assert_string_equal(f->found[1].active_name, f->found[0].active_name);
    assert_string_equal(f->found[1].key, f->found[0].key);
    assert_true(f->found[1].again);
    assert_string_equal(f->found[2].name, "A.fits");
    assert_false(f->found[2].again);
}

static void removed_before_it_settles(void **state) {
    spool_fixture *f = *state;
    only_events(f);
    fixture_write(f, "incoming/a.fits", "");
    fixture_write(f, "incoming/b.fits", "b");
    fixture_run_until_found(f, 1);
    assert_int_equal(spool_get_stats(f->spool).waiting, 1);
    assert_int_equal(unlink(fixture_path(f, "incoming/a.fits")), 0);
    fixture_write(f, "incoming/c.fits", "c");
    fixture_run_until_found(f, 2);
    assert_int_equal(spool_get_stats(f->spool).waiting, 0);
}

static long events_that_fit(void) {
    long n = 16384;
    FILE *file = fopen("/proc/sys/fs/inotify/max_queued_events", "r");
    if (file != NULL) {
        n = fscanf(file, "%ld", &n) == 1 ? n : 16384;
        fclose(file);
    }
    return n;
}

static void lost_events_are_made_up_for(void **state) {
    spool_fixture *f = *state;
    fixture_open(f);
    fixture_run_until_scans(f, 1);
    fixture_write(f, "incoming/x.part", "!");
    const long n = events_that_fit();
    if (n > 200000)
        skip();
    char here[FIXTURE_PATH];
    char there[FIXTURE_PATH];
    snprintf(here, sizeof here, "%s", fixture_path(f, "incoming/x.part"));
    snprintf(there, sizeof there, "%s", fixture_path(f, "incoming/y.part"));
    for (long i = 0; i < n / 4 + 1; i++) { /* two events each */
        assert_int_equal(rename(here, there), 0);
        assert_int_equal(rename(there, here), 0);
    }
    fixture_write(f, "incoming/a.fits", "pixels"); /* nobody hears of it */
    fixture_run_until_found(f, 1);
    expect_only(f, "a.fits", "pixels");
    assert_non_null(strstr(f->log, "too many events"));
}

static void many_files_are_each_told_once(void **state) {
    enum { MANY = 1500 };
    spool_fixture *f = *state;
    static bool seen[MANY];
    memset(seen, 0, sizeof seen);
    f->tuning.scan_ms = 5; /* scans and events overlap */
    fixture_open(f);
    for (int i = 0; i < MANY; i++) {
        char name[64];
        snprintf(name, sizeof name, "incoming/%04d.fits", i);
        fixture_write(f, name, name);
        if (i % 100 == 0)
            uv_run(&f->loop, UV_RUN_NOWAIT);
    }
    fixture_run_until_found(f, MANY);
    fixture_run_until_scans(f, 2);
    assert_int_equal(f->n_found, MANY);
    for (int i = 0; i < MANY; i++) {
        const int number = atoi(f->found[i].name);
        assert_false(seen[number] || f->found[i].again);
        seen[number] = true;
    }
    assert_int_equal(fixture_count(f, "active"), MANY);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(closed_file_is_taken_at_once),
        TEST(renamed_file_is_taken_at_once),
        TEST(moved_in_from_outside),
        TEST(slow_writer_is_waited_for),
        TEST(written_while_it_waits),
        TEST(second_link_settles),
        TEST(linked_unnamed_file_is_taken_in_the_end),
        TEST(found_by_scan_only_when_still),
        TEST(scan_finds_what_was_there),
        TEST(empty_file_settles),
        TEST(others_are_ignored_with_one_message),
        TEST(full_queue_leaves_files_waiting),
        TEST(refused_file_is_told_again),
        TEST(refused_file_does_not_hold_up_others),
        TEST(taken_files_are_told_again_first),
        TEST(removed_before_it_settles),
        TEST(lost_events_are_made_up_for),
        TEST(many_files_are_each_told_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
