/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A reader that fails before it has read a request: its explanation arrives, in whatever order its
 * end and our request come. */
#include "fits_fixture.h"
#include "reader/reader.h"
#include "test.h"

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TRIES = 20 }; /* for the order of events */

/* What reader_start makes of `program` on a good file. */
static int start(const char *program, shear_error *err) {
    const char *path = fixture_path("good.fits");
    char scratch[512];
    fixture_write_good(path);
    snprintf(scratch, sizeof scratch, "%s", fixture_path("scratch"));
    mkdir(scratch, 0700);
    const reader_limits limits = {.program = program,
                                  .scratch = scratch,
                                  .memory_bytes = INT64_C(1) << 30,
                                  .cpu_seconds = 60,
                                  .unpacked_bytes = INT64_C(1) << 30,
                                  .shared_bytes = INT64_C(1) << 30,
                                  .timeout_ms = 60000};
    const shear_input input = shear_input_of_file(path);
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    assert_true(fd >= 0);
    reader *r = NULL;
    *err = (shear_error){0};
    const int code = reader_start(&r, &input, &fd, &limits, err);
    assert_true((code == SHEAR_OK) == (r != NULL));
    reader_stop(r);
    close(fd);
    unlink(path);
    return code;
}

/* A program that does this instead. */
static const char *script(const char *text) {
    const char *path = fixture_path("reader.sh");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "#!/bin/sh\n%s\n", text);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod(path, 0755), 0);
    return path;
}

static void expect(const char *which, int code, const char *words) {
    char program[600];
    snprintf(program, sizeof program, "%s", which);
    for (int i = 0; i < TRIES; i++) {
        shear_error err;
        assert_int_equal(start(program, &err), code);
        if (strstr(err.message, words) == NULL)
            fail_msg("'%s' does not tell '%s'", err.message, words);
        assert_true(strlen(err.advice) > 0);
    }
}

static void it_reads(void **state) {
    (void)state;
    shear_error err;
    const int code = start(SHEARD_READER, &err);
    assert_string_equal(err.message, "");
    assert_int_equal(code, SHEAR_OK);
}

static void it_is_not_there(void **state) {
    (void)state;
    expect("/nonexistent/sheard-reader", SHEAR_E_IO, "No such file");
    const char *plain = fixture_path("plain");
    fixture_save(plain, "x", 1);
    expect(plain, SHEAR_E_IO, "Permission denied");
}

/* The dynamic linker's way to end, and a shell's. */
static void a_library_is_missing(void **state) {
    (void)state;
    expect(script("echo 'sheard-reader: error while loading shared libraries: libx.so.1' >&2\n"
                  "exit 127"),
           SHEAR_E_IO, "loading shared libraries: libx.so.1");
    expect(script("exec /nonexistent/program"), SHEAR_E_IO, "/nonexistent/program");
}

/* Anything else that ends without an answer is the reader's fault, and its words are told, harmless
 * and cut. */
static void it_dies(void **state) {
    (void)state;
    expect(script("echo why >&2; exit 1"), READER_E_DIED, "ended with code 1; it said: why");
    expect(script("exit 0"), READER_E_DIED, "ended with code 0");
    expect(script("kill -SEGV $$"), READER_E_DIED, "signal 11");
    expect(script("printf '\\n\\033[31mred\\n\\377end\\n' >&2; exit 3"), READER_E_DIED,
           "it said: ?[31mred ?end");
    expect(script("i=0; while [ $i -lt 9000 ]; do echo 0123456789; i=$((i+1)); done >&2; exit 3"),
           READER_E_DIED, "it said: 0123456789 0123456789");
}

/* In this process and all its children, for good. */
static void forbid(long call) {
    struct sock_filter code[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (unsigned)call, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | 1 /* EPERM */),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    const struct sock_fprog program = {sizeof code / sizeof code[0], code};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) {
        _exit(77);
    }
}

/* The sandbox cannot be entered: as under a unit whose filter forbids a call that it needs. */
static void a_call_is_forbidden(void **state) {
    (void)state;
#ifdef SHEAR_SANITIZED
    skip(); /* a sanitizer's runtime makes calls of its own */
#endif
    const struct {
        long call;
        const char *words;
    } cases[] = {{SYS_landlock_create_ruleset, "sandbox: Landlock"},
                 {SYS_prctl, "sandbox: no new privileges"},
                 {SYS_prlimit64, "sandbox: core size"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const pid_t pid = fork();
        assert_true(pid >= 0);
        if (pid == 0) {
            int good = 0;
            forbid(cases[i].call);
            for (int n = 0; n < TRIES; n++) {
                shear_error err;
                const int code = start(SHEARD_READER, &err);
                good += code == SHEAR_E_IO && strstr(err.message, cases[i].words) != NULL &&
                        strstr(err.message, "not permitted") != NULL &&
                        strstr(err.advice, "filter") != NULL;
            }
            _exit(good == TRIES ? 0 : 1);
        }
        int status = 0;
        assert_int_equal(waitpid(pid, &status, 0), pid);
        if (WIFEXITED(status) && WEXITSTATUS(status) == 77)
            skip();
        assert_true(WIFEXITED(status));
        assert_int_equal(WEXITSTATUS(status), 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_reads),
        cmocka_unit_test(it_is_not_there),
        cmocka_unit_test(a_library_is_missing),
        cmocka_unit_test(it_dies),
        cmocka_unit_test(a_call_is_forbidden),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
