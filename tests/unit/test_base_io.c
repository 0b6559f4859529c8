/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Complete reads and writes, through pipes that transfer little at a time; clocks. */
#include "base/cleanup.h"
#include "base/clock.h"
#include "base/io.h"
#include "test.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MANY = 300000 }; /* more than a pipe holds */

static unsigned char sent[MANY], received[MANY + 1];

static void *send_all(void *fd) {
    const int error = io_write(*(int *)fd, sent, MANY);
    close(*(int *)fd);
    return error == 0 ? NULL : fd;
}

static void a_pipe_carries_all(void **state) {
    (void)state;
    int ends[2];
    pthread_t sender;
    void *failed = NULL;
    for (int i = 0; i < MANY; i++)
        sent[i] = (unsigned char)(i % 251);
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(fcntl(ends[1], F_SETFL, O_NONBLOCK), 0);
    assert_int_equal(pthread_create(&sender, NULL, send_all, &ends[1]), 0);
    assert_int_equal(io_read(ends[0], received, MANY + 1), MANY);
    assert_memory_equal(received, sent, MANY);
    pthread_join(sender, &failed);
    assert_null(failed);
    close(ends[0]);
}

static void a_nameless_file_is_read_where_one_wants(void **state) {
    (void)state;
    char text[8] = "";
    struct stat st;
    CLEANUP(release_fd) const int fd = io_open_nameless(".");
    assert_true(fd >= 0);
    assert_int_equal(io_write(fd, "abcdef", 6), 0);
    assert_int_equal(fstat(fd, &st), 0);
    assert_int_equal(st.st_nlink, 0);
    assert_int_equal(io_read_at(fd, text, 3, 2), 3);
    assert_string_equal(text, "cde");
    assert_int_equal(io_read_at(fd, text, 7, 4), 2);
    assert_memory_equal(text, "ef", 2);
    assert_int_equal(io_read(fd, text, 3), 0);
}

static void errors_are_told(void **state) {
    (void)state;
    char byte;
    assert_int_equal(io_read(-1, &byte, 1), -1);
    assert_int_equal(errno, EBADF);
    assert_int_equal(io_read_at(-1, &byte, 1, 0), -1);
    assert_int_equal(errno, EBADF);
    assert_int_equal(io_write(-1, "x", 1), EBADF);
    assert_int_equal(io_write(-1, "x", 0), 0);
    assert_int_equal(io_finish(-1, 0), EBADF);
    assert_int_equal(io_finish(-1, EPIPE), EPIPE);
    assert_int_equal(io_open_nameless("/no/such/directory"), -1);
    assert_int_equal(errno, ENOENT);
}

static void clocks_agree(void **state) {
    (void)state;
    const int64_t ns = clock_ns(CLOCK_MONOTONIC);
    const int64_t us = clock_us(CLOCK_MONOTONIC);
    const int64_t ms = clock_ms(CLOCK_MONOTONIC);
    const double s = clock_s(CLOCK_MONOTONIC);
    assert_true(ns / 1000 <= us && us / 1000 <= ms);
    assert_true(1e-3 * (double)ms <= s + 1e-6);
    assert_true(s - 1e-9 * (double)ns < 60.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pipe_carries_all),
        cmocka_unit_test(a_nameless_file_is_read_where_one_wants),
        cmocka_unit_test(errors_are_told),
        cmocka_unit_test(clocks_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
