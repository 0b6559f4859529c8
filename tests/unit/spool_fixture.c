/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spool_fixture.h"

#include "remove_tree.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const uint64_t patience_ms = 30000; /* before a test that waits is called a failure */

static int64_t on_room(void *context) {
    return ((spool_fixture *)context)->room;
}

static void on_found(void *context, const spool_file *file) {
    spool_fixture *f = context;
    if (f->refusals > 0) {
        f->refusals--;
        assert_int_equal(spool_refuse(f->spool, file->active_name, NULL), SHEAR_OK);
        return;
    }
    assert_true(f->n_found < FIXTURE_FOUND_MAX);
    assert_int_equal(file->owner, geteuid());
    found_file *one = &f->found[f->n_found++];
    snprintf(one->active_name, sizeof one->active_name, "%s", file->active_name);
    snprintf(one->key, sizeof one->key, "%s", file->key);
    snprintf(one->name, sizeof one->name, "%s", file->name);
    one->again = file->again;
    f->room--;
}

static void on_log(void *context, enum spool_level level, const char *text) {
    spool_fixture *f = context;
    const size_t n = strlen(f->log);
    f->n_logs[level]++;
    snprintf(f->log + n, sizeof f->log - n, "%s\n", text);
}

int fixture_setup(void **state) {
    spool_fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    const char *base = getenv("TMPDIR");
    snprintf(f->root, sizeof f->root, "%.80s/sheard-spool-XXXXXX", base != NULL ? base : "/tmp");
    assert_non_null(mkdtemp(f->root));
    snprintf(f->directory, sizeof f->directory, "%s/spool", f->root);
    assert_int_equal(uv_loop_init(&f->loop), 0);
    f->found = calloc(FIXTURE_FOUND_MAX, sizeof *f->found);
    assert_non_null(f->found);
    f->tuning = (spool_tuning){.settle_ms = 0, .scan_ms = 3600000};
    f->room = INT64_MAX;
    *state = f;
    return 0;
}

int fixture_teardown(void **state) {
    spool_fixture *f = *state;
    fixture_close(f);
    assert_int_equal(uv_loop_close(&f->loop), 0);
    remove_tree(f->root);
    free(f->found);
    free(f);
    return 0;
}

void fixture_open(spool_fixture *f) {
    shear_error err = {0};
    const spool_callbacks callbacks = {on_room, on_found, on_log, f, NULL};
    if (spool_open(&f->spool, &f->loop, f->directory, &f->tuning, &callbacks, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
}

void fixture_close(spool_fixture *f) {
    spool_close(f->spool);
    f->spool = NULL;
    uv_run(&f->loop, UV_RUN_DEFAULT); /* until its handles are closed */
}

/* One turn of a loop may wait after its timers: this one ends the wait. */
static void on_tick(uv_timer_t *timer) {
    (void)timer;
}

static bool run(spool_fixture *f, uint64_t ms, fixture_condition *condition, const void *argument) {
    uv_timer_t ticks;
    const uint64_t end_ns = uv_hrtime() + ms * 1000000;
    uv_timer_init(&f->loop, &ticks);
    uv_timer_start(&ticks, on_tick, 5, 5);
    bool met = condition != NULL && condition(f, argument);
    while (!met && uv_hrtime() < end_ns) {
        uv_run(&f->loop, UV_RUN_ONCE);
        met = condition != NULL && condition(f, argument);
    }
    uv_close((uv_handle_t *)&ticks, NULL);
    uv_run(&f->loop, UV_RUN_NOWAIT);
    return met;
}

void fixture_run_until(spool_fixture *f, fixture_condition *condition, const void *argument) {
    if (!run(f, patience_ms, condition, argument))
        fail_msg("waited in vain; messages so far: %s", f->log);
}

void fixture_run_for(spool_fixture *f, int64_t ms) {
    run(f, (uint64_t)ms, NULL, NULL);
}

static bool enough_found(const spool_fixture *f, const void *n) {
    return f->n_found >= *(const int *)n;
}

void fixture_run_until_found(spool_fixture *f, int n) {
    fixture_run_until(f, enough_found, &n);
    assert_int_equal(f->n_found, n);
}

static bool enough_scans(const spool_fixture *f, const void *n) {
    return spool_get_stats(f->spool).scans >= *(const int64_t *)n;
}

void fixture_run_until_scans(spool_fixture *f, int64_t more) {
    const int64_t n = spool_get_stats(f->spool).scans + more;
    fixture_run_until(f, enough_scans, &n);
}

const char *fixture_path(const spool_fixture *f, const char *name) {
    static char paths[4][FIXTURE_PATH];
    static unsigned turn;
    char *path = paths[turn++ % 4];
    snprintf(path, FIXTURE_PATH, "%s/%s", f->directory, name);
    return path;
}

void fixture_write(const spool_fixture *f, const char *name, const char *content) {
    FILE *file = fopen(fixture_path(f, name), "w");
    assert_non_null(file);
    assert_true(fputs(content, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

bool fixture_has(const spool_fixture *f, const char *name) {
    struct stat st;
    return lstat(fixture_path(f, name), &st) == 0;
}

void fixture_expect(const spool_fixture *f, const char *name, const char *content) {
    char text[1024];
    FILE *file = fopen(fixture_path(f, name), "r");
    if (file == NULL) {
        fail_msg("%s is not there", name);
        return;
    }
    const size_t n = fread(text, 1, sizeof text - 1, file);
    text[n] = '\0';
    fclose(file);
    assert_string_equal(text, content);
}

int fixture_count(const spool_fixture *f, const char *folder) {
    int n = 0;
    DIR *dir = opendir(fixture_path(f, folder));
    assert_non_null(dir);
    for (const struct dirent *e = readdir(dir); e != NULL; e = readdir(dir))
        n += strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0;
    closedir(dir);
    return n;
}

void fixture_end(spool_fixture *f, int found, bool good, const char *report) {
    shear_error err = {0};
    if (spool_dispose(f->spool, f->found[found].active_name, good, report, NULL, &err) !=
        SHEAR_OK) {
        fail_msg("%s", err.message);
    }
}

const found_file *fixture_find(const spool_fixture *f, const char *name) {
    for (int i = 0; i < f->n_found; i++) {
        if (strcmp(f->found[i].name, name) == 0)
            return &f->found[i];
    }
    return NULL;
}
