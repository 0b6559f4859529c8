/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A service that dies, or whose disk fails, before or after each single change of the file system:
 * afterwards every file has ended exactly once, under one key, with its report. */
#include "spool_fixture.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- the n-th change ---- */

enum fault { NO_FAULT, KILL_BEFORE, KILL_AFTER, FAIL };

static struct { int kind, at, calls; } fault;

/* To be called before each change; true: it fails. */
static bool falls_here(void) {
    fault.calls++;
    if (fault.kind == NO_FAULT || fault.calls != fault.at)
        return false;
    if (fault.kind == KILL_BEFORE)
        kill(getpid(), SIGKILL);
    if (fault.kind == FAIL)
        errno = ENOSPC;
    return fault.kind == FAIL;
}

/* To be called after it. */
static void came_through(void) {
    if (fault.kind == KILL_AFTER && fault.calls == fault.at)
        kill(getpid(), SIGKILL);
}

#define CHANGE(call)                                                                               \
    if (falls_here()) {                                                                            \
        return -1;                                                                                 \
    }                                                                                              \
    const __typeof__(call) result = (call);                                                        \
    came_through();                                                                                \
    return result

int __real_renameat2(int, const char *, int, const char *, unsigned);
int __wrap_renameat2(int, const char *, int, const char *, unsigned);
int __wrap_renameat2(int from, const char *name, int to, const char *new_name, unsigned flags) {
    CHANGE(__real_renameat2(from, name, to, new_name, flags));
}

/* Nothing is lost with a process: a real one would cost time only. */
int __wrap_fsync(int);
int __wrap_fsync(int fd) {
    CHANGE(fcntl(fd, F_GETFD) < 0 ? -1 : 0);
}

int __real_unlinkat(int, const char *, int);
int __wrap_unlinkat(int, const char *, int);
int __wrap_unlinkat(int directory, const char *name, int flags) {
    CHANGE(__real_unlinkat(directory, name, flags));
}

int __real_symlinkat(const char *, int, const char *);
int __wrap_symlinkat(const char *, int, const char *);
int __wrap_symlinkat(const char *text, int directory, const char *name) {
    CHANGE(__real_symlinkat(text, directory, name));
}

ssize_t __real_write(int, const void *, size_t);
ssize_t __wrap_write(int, const void *, size_t);
ssize_t __wrap_write(int fd, const void *bytes, size_t n) {
    struct stat st;
    if (fstat(fd, &st) != 0 || !S_ISREG(st.st_mode)) {
        return __real_write(fd, bytes, n); /* of libuv's */
    }
    CHANGE(__real_write(fd, bytes, n));
}

/* ---- a service, in a process of its own ---- */

enum { EXIT_NO_SPOOL = 3, N_FILES = 4, LIFE_S = 20 };

static const struct {
    const char *name, *content;
} files[N_FILES] = {{"a.fits", "A"}, {"b.fits.gz", "B"}, {"a.fits.json", "C"}, {"z.json", "D"}};

typedef struct service {
    spool *spool;
    int ledger; /* who was told under which key */
} service;

static int64_t room(void *context) {
    (void)context;
    return 2;
}

static void log_nothing(void *context, enum spool_level level, const char *text) {
    (void)context;
    (void)level;
    (void)text;
}

/* A job that failed is tried again once, and fails again. */
static int end_again(service *v, const spool_file *file, const spool_place *failed,
                     const char *report) {
    const int code = spool_restore(v->spool, file->active_name, failed, NULL);
    if (code != SHEAR_OK) {
        return SHEAR_OK; /* it lies in failed/; or in active/, and the next start tells it */
    }
    return spool_dispose(v->spool, file->active_name, false, report, NULL, NULL);
}

/* The job is done the moment it is found; where it cannot be ended, it is told again. */
static void found(void *context, const spool_file *file) {
    service *v = context;
    char content = '?';
    char report[16];
    spool_place place;
    int fd = -1;
    if (spool_open_file(v->spool, file->active_name, &fd, NULL) != SHEAR_OK ||
        read(fd, &content, 1) != 1) {
        _exit(4);
    }
    close(fd);
    dprintf(v->ledger, "%c %s\n", content, file->key);
    snprintf(report, sizeof report, "of %c", content);
    int code = spool_dispose(v->spool, file->active_name, content != 'B', report, &place, NULL);
    if (code == SHEAR_OK && content == 'B')
        code = end_again(v, file, &place, report);
    if (code != SHEAR_OK && spool_refuse(v->spool, file->active_name, NULL) != SHEAR_OK)
        _exit(5);
}

static int serve(const char *directory, const char *ledger) {
    const spool_tuning tuning = {.settle_ms = 0, .scan_ms = 2};
    uv_loop_t loop;
    service v = {NULL, open(ledger, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600)};
    const spool_callbacks callbacks = {room, found, log_nothing, &v, NULL};
    alarm(LIFE_S);
    if (v.ledger < 0 || uv_loop_init(&loop) != 0)
        return 6;
    fault.calls = 0;
    if (spool_open(&v.spool, &loop, directory, &tuning, &callbacks, NULL) != SHEAR_OK)
        return EXIT_NO_SPOOL;
    for (spool_stats stats = {0}; stats.scans == 0 || stats.waiting + stats.active > 0;
         stats = spool_get_stats(v.spool)) {
        uv_run(&loop, UV_RUN_ONCE);
    }
    spool_close(v.spool);
    uv_run(&loop, UV_RUN_DEFAULT);
    const bool reached = fault.kind == NO_FAULT || fault.calls >= fault.at;
    return uv_loop_close(&loop) != 0 ? 7 : reached ? 0 : 2;
}

/* Returns 0: it has done everything; 2: also before the fault came; EXIT_NO_SPOOL; or -1: killed.
 */
static int live(const spool_fixture *f, int kind, int at) {
    char ledger[256];
    int status = 0;
    snprintf(ledger, sizeof ledger, "%s/ledger", f->root);
    const pid_t child = fork();
    if (child == 0) {
        fault.kind = kind;
        fault.at = at;
        _exit(serve(f->directory, ledger));
    }
    assert_true(child > 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    if (WIFSIGNALED(status)) {
        assert_int_equal(WTERMSIG(status), SIGKILL);
        return -1;
    }
    return WEXITSTATUS(status);
}

/* ---- what must be true in the end ---- */

static void check_ledger(const spool_fixture *f) {
    char path[256];
    char keys['D' + 1][SPOOL_KEY_SIZE] = {""};
    char key[SPOOL_KEY_SIZE];
    char content = ' ';
    snprintf(path, sizeof path, "%s/ledger", f->root);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fscanf(file, " %c %34s", &content, key) == 2) {
        assert_true(content >= 'A' && content <= 'D');
        if (keys[(int)content][0] != '\0') {
            assert_string_equal(keys[(int)content], key); /* one file, one key */
        }
        memcpy(keys[(int)content], key, sizeof key);
    }
    fclose(file);
    assert_int_equal(unlink(path), 0);
    for (char c = 'A'; c <= 'D'; c++)
        assert_int_equal(strlen(keys[(int)c]), SPOOL_KEY_SIZE - 1);
}

/* The name is NAME, or numbered where a report took it first (a.fits and a.fits.json). */
static void check_ended(const spool_fixture *f, const char *folder, const char *name,
                        const char *numbered, char content) {
    char path[128];
    char text[16];
    const char *names[] = {name, numbered};
    for (size_t i = 0; i < 2; i++) {
        const char want[] = {content, '\0'};
        char have[2] = "";
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        const int fd = open(fixture_path(f, path), O_RDONLY);
        const bool it = fd >= 0 && read(fd, have, 1) == 1 && strcmp(have, want) == 0;
        if (fd >= 0)
            close(fd);
        if (it) {
            snprintf(path, sizeof path, "%s/%s.json", folder, names[i]);
            snprintf(text, sizeof text, "of %c", content);
            fixture_expect(f, path, text);
            return;
        }
    }
    fail_msg("%s is not in %s/", name, folder);
}

static void check_end(const spool_fixture *f) {
    assert_int_equal(fixture_count(f, "incoming"), 0);
    assert_int_equal(fixture_count(f, "active"), 0);
    assert_int_equal(fixture_count(f, "done"), 6);
    assert_int_equal(fixture_count(f, "failed"), 2);
    check_ended(f, "done", "a.fits", "a.1.fits", 'A');
    check_ended(f, "failed", "b.fits.gz", "", 'B');
    check_ended(f, "done", "a.fits.json", "a.fits.1.json", 'C');
    check_ended(f, "done", "z.json", "", 'D');
    check_ledger(f);
}

static void begin(const spool_fixture *f) {
    static const char *const folders[] = {"", "incoming", "active", "done", "failed"};
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++)
        mkdir(fixture_path(f, folders[i]), 0700);
    for (int i = 0; i < N_FILES; i++) {
        char path[64];
        snprintf(path, sizeof path, "incoming/%s", files[i].name);
        fixture_write(f, path, files[i].content);
    }
}

static void empty(const spool_fixture *f) {
    static const char *const ended[] = {
        "done/a.fits",           "done/a.1.fits",          "done/a.fits.json",
        "done/a.1.fits.json",    "done/a.fits.1.json",     "done/a.fits.json.json",
        "done/z.json",           "done/z.json.json",       "failed/b.fits.gz",
        "failed/b.fits.gz.json", "done/a.fits.1.json.json"};
    for (size_t i = 0; i < sizeof ended / sizeof ended[0]; i++)
        unlink(fixture_path(f, ended[i]));
}

/* Each change once; until a run comes to its end before the fault. */
static void loop_over_changes(spool_fixture *f, int kind, int second_kind) {
    int at = 1;
    for (int code = -1; code != 2; at++) {
        begin(f);
        code = live(f, kind, at);
        if (kind == FAIL) {
            assert_true(code == 0 || code == 2 || code == EXIT_NO_SPOOL);
        } else {
            assert_true(code == -1 || code == 2);
        }
        if (second_kind != NO_FAULT)
            live(f, second_kind, 1 + at * 7 % 23);
        assert_int_equal(live(f, NO_FAULT, 0), 0);
        check_end(f);
        empty(f);
    }
    assert_true(at > 8 * N_FILES); /* so many changes there are, at least */
}

static void killed_before_each_change(void **state) {
    loop_over_changes(*state, KILL_BEFORE, NO_FAULT);
}

static void killed_after_each_change(void **state) {
    loop_over_changes(*state, KILL_AFTER, NO_FAULT);
}

static void killed_again_while_recovering(void **state) {
    loop_over_changes(*state, KILL_AFTER, KILL_AFTER);
}

static void each_change_fails_once(void **state) {
    loop_over_changes(*state, FAIL, NO_FAULT);
}

/* From outside, at any moment. */
static void killed_at_random(void **state) {
    spool_fixture *f = *state;
    char ledger[256];
    snprintf(ledger, sizeof ledger, "%s/ledger", f->root);
    srand(3);
    for (int i = 0; i < 100; i++) {
        begin(f);
        const pid_t child = fork();
        if (child == 0)
            _exit(serve(f->directory, ledger));
        assert_true(child > 0);
        usleep((useconds_t)(rand() % 4000));
        kill(child, SIGKILL);
        assert_int_equal(waitpid(child, NULL, 0), child);
        assert_int_equal(live(f, NO_FAULT, 0), 0);
        check_end(f);
        empty(f);
    }
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(killed_before_each_change),
        TEST(killed_after_each_change),
        TEST(killed_again_while_recovering),
        TEST(each_change_fails_once),
        TEST(killed_at_random),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
