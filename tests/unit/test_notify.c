/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "notify/notify.h"

#include "test.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static char dir[64];
static char name[96];

/* systemd's end of the socket `name` (a path, or @ and an abstract name). */
static int receive_on(void) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const size_t n = strlen(name);
    memcpy(address.sun_path, name, n);
    if (name[0] == '@')
        address.sun_path[0] = '\0';
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address,
                          (socklen_t)(offsetof(struct sockaddr_un, sun_path) + n)),
                     0);
    setenv("NOTIFY_SOCKET", name, 1);
    return fd;
}

static const char *received(int fd) {
    static char text[2048];
    const ssize_t n = recv(fd, text, sizeof text - 1, 0);
    assert_true(n >= 0);
    text[n] = '\0';
    return text;
}

static void check_messages(int fd) {
    shear_error err = {0};
    notify n;
    struct timespec now;
    long long usec = 0;
    assert_int_equal(notify_init(&n, &err), SHEAR_OK);
    assert_null(getenv("NOTIFY_SOCKET"));
    assert_int_equal(notify_ready(&n, NULL, &err), SHEAR_OK);
    assert_string_equal(received(fd), "READY=1\n");
    assert_int_equal(notify_ready(&n, "3 jobs", &err), SHEAR_OK);
    assert_string_equal(received(fd), "READY=1\nSTATUS=3 jobs");
    assert_int_equal(notify_ready(&n, "a\nREADY=1\x7f", &err), SHEAR_OK);
    assert_string_equal(received(fd), "READY=1\nSTATUS=a?READY=1?");
    assert_int_equal(notify_stopping(&n, "draining", &err), SHEAR_OK);
    assert_string_equal(received(fd), "STOPPING=1\nSTATUS=draining");
    assert_int_equal(notify_watchdog(&n, &err), SHEAR_OK);
    assert_string_equal(received(fd), "WATCHDOG=1");
    clock_gettime(CLOCK_MONOTONIC, &now);
    assert_int_equal(notify_reloading(&n, &err), SHEAR_OK);
    assert_int_equal(sscanf(received(fd), "RELOADING=1\nMONOTONIC_USEC=%lld", &usec), 1);
    const long long before = (long long)now.tv_sec * 1000000 + now.tv_nsec / 1000;
    assert_in_range(usec, before, before + 10000000);
    notify_deinit(&n);
    notify_deinit(&n);
    assert_int_equal(notify_ready(&n, NULL, &err), SHEAR_OK);
    assert_int_equal(recv(fd, &usec, 1, 0), -1);
}

static void test_path(void **state) {
    (void)state;
    snprintf(name, sizeof name, "%s/notify", dir);
    const int fd = receive_on();
    check_messages(fd);
    close(fd);
    setenv("NOTIFY_SOCKET", name, 1);
    notify n;
    shear_error err = {0};
    assert_int_equal(notify_init(&n, &err), SHEAR_OK);
    assert_int_equal(notify_ready(&n, NULL, &err), SHEAR_E_IO); /* nobody is there any more */
    notify_deinit(&n);
    unlink(name);
}

static void test_abstract(void **state) {
    (void)state;
    snprintf(name, sizeof name, "@sheard-test-%d", (int)getpid());
    const int fd = receive_on();
    check_messages(fd);
    close(fd);
}

static void test_full_socket_does_not_wait(void **state) {
    (void)state;
    shear_error err = {0};
    notify n;
    snprintf(name, sizeof name, "%s/full", dir);
    const int fd = receive_on();
    assert_int_equal(notify_init(&n, &err), SHEAR_OK);
    int code = SHEAR_OK;
    for (int i = 0; i < 100000 && code == SHEAR_OK; i++)
        code = notify_watchdog(&n, &err);
    assert_int_equal(code, SHEAR_E_IO);
    notify_deinit(&n);
    close(fd);
    unlink(name);
}

static void test_nobody_listens(void **state) {
    (void)state;
    notify n;
    unsetenv("NOTIFY_SOCKET");
    setenv("WATCHDOG_USEC", "1000000", 1);
    assert_int_equal(notify_init(&n, NULL), SHEAR_OK);
    assert_int_equal(n.watchdog_ms, 0);
    assert_int_equal(notify_ready(&n, "x", NULL), SHEAR_OK);
    assert_int_equal(notify_watchdog(&n, NULL), SHEAR_OK);
    notify_deinit(&n);
}

static void test_bad_names(void **state) {
    (void)state;
    char longest[160];
    memset(longest, 'x', sizeof longest);
    longest[0] = '/';
    longest[109] = '\0';
    const char *const names[] = {"relative", "vsock:2:1", "/", "@", longest};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        notify n;
        shear_error err = {0};
        setenv("NOTIFY_SOCKET", names[i], 1);
        assert_int_equal(notify_init(&n, &err), SHEAR_E_SETTING);
        assert_int_equal(notify_ready(&n, NULL, &err), SHEAR_OK);
    }
}

static void test_watchdog(void **state) {
    (void)state;
    static const struct {
        const char *usec;
        bool own;
        int64_t ms;
    } cases[] = {{"30000000", true, 30000},
                 {"500", true, 1},
                 {"30000000", false, 0},
                 {"0", true, 0},
                 {"x", true, 0},
                 {"5s", true, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char pid[16];
        notify n;
        snprintf(pid, sizeof pid, "%d", (int)getpid() + !cases[i].own);
        setenv("NOTIFY_SOCKET", "@x", 1);
        setenv("WATCHDOG_USEC", cases[i].usec, 1);
        setenv("WATCHDOG_PID", pid, 1);
        assert_int_equal(notify_init(&n, NULL), SHEAR_OK);
        assert_int_equal(n.watchdog_ms, cases[i].ms);
        assert_null(getenv("WATCHDOG_USEC"));
        assert_null(getenv("WATCHDOG_PID"));
        notify_deinit(&n);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_path),
        cmocka_unit_test(test_abstract),
        cmocka_unit_test(test_full_socket_does_not_wait),
        cmocka_unit_test(test_nobody_listens),
        cmocka_unit_test(test_bad_names),
        cmocka_unit_test(test_watchdog),
    };
    snprintf(dir, sizeof dir, "/tmp/sheard-test-XXXXXX");
    if (mkdtemp(dir) == NULL)
        return 1;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    return rmdir(dir) != 0 || failed != 0;
}
