/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Catalogs that are resumed after their process has died: the file is the one that an
 * uninterrupted process makes, to the last byte; and those that cannot be resumed are refused. */
#include "catalog_fixture.h"
#include "fits_fixture.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* More rows than CFITSIO has buffers for. */
enum { N = 4000, CHUNK = 16 };
static const unsigned columns = SHEAR_COL_ID | SHEAR_COL_X;
static const shear_carried carried[] = {{.name = "ZBIN", .form = "1J", .bytes = 4},
                                        {.name = "TILE", .form = "9A", .unit = "name", .bytes = 9}};
enum { N_CARRIED = 2, CARRIED_BYTES = 13 };
static const char sum[] = "0123456789abcdef0123456789abcdef";

static shear_field_info info_of(int64_t n) {
    shear_field_info info = catalog_info(n, columns);
    info.n_carried = N_CARRIED;
    info.carried_bytes = CARRIED_BYTES;
    info.carried = carried;
    return info;
}

/* Rows [first, end), or wrong ones in their place. */
static void write_rows(shear_catalog *c, int64_t first, int64_t end, bool wrong) {
    const shear_field_info info = info_of(N);
    shear_block *b = NULL;
    shear_error err = {0};
    assert_int_equal(shear_block_new(&b, &info, CHUNK, &err), SHEAR_OK);
    for (int64_t at = first; at < end; at += CHUNK) {
        shear_row rows[CHUNK];
        const int count = end - at < CHUNK ? (int)(end - at) : CHUNK;
        for (int k = 0; k < count; k++) {
            const int64_t i = wrong ? at + k + 7777 : at + k;
            rows[k] = catalog_row(i);
            b->id[k] = i * 5000000000;
            b->x[k] = fixture_column(SHEAR_COL_X, i);
            memset(b->carried + (size_t)k * CARRIED_BYTES, (int)(i % 251), CARRIED_BYTES);
        }
        if (shear_catalog_write(c, at, count, rows, b, &err) != SHEAR_OK)
            fail_msg("%s", err.message);
    }
    shear_block_free(b);
}

static shear_catalog *begin(const char *path) {
    const shear_field_info info = info_of(N);
    shear_catalog *c = NULL;
    shear_error err = {0};
    if (shear_catalog_begin(&c, path, &info, sum, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    return c;
}

static shear_catalog *resume(const char *path, int64_t rows) {
    const shear_field_info info = info_of(N);
    shear_catalog *c = NULL;
    shear_error err = {0};
    if (shear_catalog_resume(&c, path, &info, sum, rows, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    return c;
}

static void keep(shear_catalog *c, int64_t rows) {
    shear_error err = {0};
    if (shear_catalog_sync(c, rows, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
}

static void finish(shear_catalog *c) {
    const shear_result result = catalog_result(N);
    shear_error err = {0};
    if (shear_catalog_finish(c, catalog_plan, &result, "in.fits", sum, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
}

/* The file of a process that nothing interrupts, as `shearctl measure` makes it. */
static void write_whole(const char *path) {
    const shear_field_info info = info_of(N);
    shear_catalog *c = NULL;
    shear_error err = {0};
    assert_int_equal(shear_catalog_create(&c, path, &info, true, &err), SHEAR_OK);
    write_rows(c, 0, N, false);
    finish(c);
}

static void same_files(const char *a, const char *b) {
    size_t n = 0;
    size_t m = 0;
    unsigned char *x = fixture_load(a, &n);
    unsigned char *y = fixture_load(b, &m);
    assert_int_equal(n, m);
    for (size_t i = 0; i < n; i++) {
        if (x[i] != y[i])
            fail_msg("the files differ from byte %zu on", i);
    }
    free(x);
    free(y);
}

/* A process that writes `rows` rows, keeps them, writes wrong ones behind them, and is killed. */
static void write_and_die(const char *path, int64_t from, int64_t rows) {
    const pid_t child = fork();
    if (child == 0) {
        shear_catalog *c = from > 0 ? resume(path, from) : begin(path);
        write_rows(c, from, rows, false);
        keep(c, rows);
        write_rows(c, rows, N, true);
        kill(getpid(), SIGKILL);
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

static void goes_on_after_a_kill(void **state) {
    (void)state;
    static const int64_t stops[][2] = {{16, 0}, {1600, 0}, {1600, 2400}, {N, 0}, {N - 1, N}};
    const char *whole = fixture_path("whole.fits");
    write_whole(whole);
    for (size_t i = 0; i < sizeof stops / sizeof stops[0]; i++) {
        const char *path = fixture_path("killed.fits");
        int64_t rows = stops[i][0];
        write_and_die(path, 0, rows);
        if (stops[i][1] > 0) {
            write_and_die(path, rows, stops[i][1]);
            rows = stops[i][1];
        }
        shear_catalog *c = resume(path, rows);
        write_rows(c, rows, N, false);
        finish(c);
        same_files(path, whole);
        assert_int_equal(unlink(path), 0);
    }
}

static void goes_on_after_a_stop(void **state) {
    (void)state;
    const char *whole = fixture_path("uninterrupted.fits");
    const char *path = fixture_path("left.fits");
    const int before = fixture_count_files();
    write_whole(whole);
    shear_catalog *c = begin(path);
    for (int64_t rows = 0; rows < N; rows += 800) {
        write_rows(c, rows, rows + 800, false);
        keep(c, rows + 800);
        keep(c, rows); /* an older word does not take the newer one back */
        shear_catalog_suspend(c);
        c = resume(path, rows + 800);
    }
    finish(c);
    same_files(path, whole);
    assert_int_equal(fixture_count_files(), before + 2);
    shear_catalog_suspend(NULL);
}

static void refused(const char *path, const shear_field_info *info, const char *checksum,
                    int64_t rows, int code) {
    shear_catalog *c = (shear_catalog *)1;
    shear_error err = {0};
    assert_int_equal(shear_catalog_resume(&c, path, info, checksum, rows, &err), code);
    assert_null(c);
    assert_true(err.message[0] != '\0');
}

static const char *temporary(const char *path) {
    static char name[300];
    const char *slash = strrchr(path, '/');
    snprintf(name, sizeof name, "%.*s/.%s.part", (int)(slash - path), path, slash + 1);
    return name;
}

static void what_cannot_be_gone_on_with(void **state) {
    (void)state;
    char path[256];
    snprintf(path, sizeof path, "%s", fixture_path("refused.fits"));
    const shear_field_info info = info_of(N);
    refused(path, &info, sum, 16, SHEAR_E_IO); /* nothing is there */
    write_and_die(path, 0, 160);
    refused(path, &info, "another sum", 160, SHEAR_E_FORMAT);
    refused(path, &info, sum, 161, SHEAR_E_FORMAT);
    shear_field_info other = catalog_info(N + 1, columns);
    refused(path, &other, sum, 160, SHEAR_E_FORMAT);
    other = catalog_info(N, SHEAR_COL_ID | SHEAR_COL_Y);
    refused(path, &other, sum, 160, SHEAR_E_FORMAT);
    other = catalog_info(N, SHEAR_COL_ID);
    refused(path, &other, sum, 160, SHEAR_E_FORMAT);
    shear_catalog_suspend(resume(path, 160)); /* it was not harmed by all that */
    assert_int_equal(truncate(temporary(path), 30000), 0);
    refused(path, &info, sum, 160, SHEAR_E_FORMAT);
    fixture_save(temporary(path), "x", 1);
    refused(path, &info, sum, 160, SHEAR_E_FORMAT);
    shear_catalog_suspend(begin(path)); /* started over: no earlier row counts */
    refused(path, &info, sum, 160, SHEAR_E_FORMAT);
    shear_catalog *c = begin(path);
    keep(c, 0);
    shear_catalog_suspend(c);
    refused(path, &info, sum, 160, SHEAR_E_FORMAT);
    shear_catalog_suspend(resume(path, 0));
}

static void forgotten(void **state) {
    (void)state;
    char path[256];
    shear_error err = {0};
    snprintf(path, sizeof path, "%s", fixture_path("forgotten.fits"));
    write_and_die(path, 0, 160);
    assert_int_equal(access(temporary(path), F_OK), 0);
    assert_int_equal(shear_catalog_discard(path, &err), SHEAR_OK);
    assert_int_not_equal(access(temporary(path), F_OK), 0);
    assert_int_equal(shear_catalog_discard(path, &err), SHEAR_OK);
    assert_int_equal(shear_catalog_discard("/nowhere/a.fits", &err), SHEAR_E_IO);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(goes_on_after_a_kill),
        cmocka_unit_test(goes_on_after_a_stop),
        cmocka_unit_test(what_cannot_be_gone_on_with),
        cmocka_unit_test(forgotten),
    };
    return cmocka_run_group_tests(tests, catalog_setup, catalog_teardown);
}
