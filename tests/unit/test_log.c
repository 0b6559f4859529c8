/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "log/log.h"

#include "test.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int ends[2];
static int64_t clock_ms;

static int64_t now(void) {
    return clock_ms;
}

/* What has been written since the last call. */
static const char *written(void) {
    static char text[1 << 16];
    assert_true(log_drain(60000));
    const ssize_t n = read(ends[0], text, sizeof text - 1);
    text[n > 0 ? n : 0] = '\0';
    return text;
}

static int setup(void **state) {
    (void)state;
    log_options o;
    log_options_init(&o);
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(fcntl(ends[0], F_SETFL, O_NONBLOCK), 0);
    o.fd = ends[1];
    o.style = LOG_JOURNAL;
    o.now_ms = now;
    clock_ms = INT64_C(1769860800123);
    log_open(&o);
    return 0;
}

static int teardown(void **state) {
    (void)state;
    close(ends[0]);
    close(ends[1]);
    return 0;
}

static void reopen(int style) {
    log_options o;
    log_options_init(&o);
    o.fd = ends[1];
    o.style = (enum log_style)style;
    o.now_ms = now;
    log_open(&o);
}

static void test_levels(void **state) {
    (void)state;
    log_set_level(LOG_LEVEL_DEBUG);
    log_error("e %d", 1);
    log_warning("w");
    log_notice("n");
    log_info("i");
    log_debug("d");
    assert_string_equal(written(), "<3>e 1\n<4>w\n<5>n\n<6>i\n<7>d\n");
    log_set_level(LOG_LEVEL_WARNING);
    assert_true(log_is_on(LOG_LEVEL_WARNING));
    assert_false(log_is_on(LOG_LEVEL_NOTICE));
    log_notice("not this");
    log_warning("but this");
    assert_string_equal(written(), "<4>but this\n");
}

static void test_time_stamps(void **state) {
    (void)state;
    reopen(LOG_TIMED);
    log_warning("x");
    assert_string_equal(written(), "2026-01-31T12:00:00.123Z warning: x\n");
}

/* Only where the descriptor is the journal's. */
static void test_journal_stream(void **state) {
    (void)state;
    struct stat st;
    char text[64];
    assert_int_equal(fstat(ends[1], &st), 0);
    snprintf(text, sizeof text, "%llu:%llu", (unsigned long long)st.st_dev,
             (unsigned long long)st.st_ino);
    setenv("JOURNAL_STREAM", text, 1);
    reopen(LOG_AUTO);
    log_info("x");
    assert_string_equal(written(), "<6>x\n");
    const char *const others[] = {"", "1", "1:2", ":", "1:2x"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        setenv("JOURNAL_STREAM", others[i], 1);
        reopen(LOG_AUTO);
        log_info("x");
        assert_non_null(strstr(written(), "Z info: x\n"));
    }
    unsetenv("JOURNAL_STREAM");
}

static void test_escapes(void **state) {
    (void)state;
    static const struct {
        const char *given, *line;
    } cases[] = {
        {"a\nb\tc\r\x1b[31m\x7f", "<6>a\\nb\\tc\\x0d\\x1b[31m\\x7f\n"},
        {"gr\xc3\xbc\xc3\x9f \xe2\x82\xac \xf0\x9f\x8c\x8c", NULL}, /* as it is */
        {"\xc2\x9b", "<6>\\xc2\\x9b\n"},                            /* a C1 control */
        {"\xe2\x80\xae", "<6>\\xe2\\x80\\xae\n"}, /* turns the direction of writing */
        {"\xe2\x80\xa8", "<6>\\xe2\\x80\\xa8\n"}, /* a line separator */
        {"\xff\xc0\x80 \xe2\x82", "<6>\\xff\\xc0\\x80 \\xe2\\x82\n"},
        {"\xed\xa0\x80", "<6>\\xed\\xa0\\x80\n"}, /* a surrogate */
        {"\xe0\x80\x80\xf4\x90\x80\x80", "<6>\\xe0\\x80\\x80\\xf4\\x90\\x80\\x80\n"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char same[64];
        snprintf(same, sizeof same, "<6>%s\n", cases[i].given);
        log_info("%s", cases[i].given);
        assert_string_equal(written(), cases[i].line ? cases[i].line : same);
    }
}

static void test_longest(void **state) {
    (void)state;
    char text[5000];
    memset(text, 1, sizeof text);
    text[sizeof text - 1] = '\0';
    log_info("%s", text);
    const char *line = written();
    assert_int_equal(strlen(line), 3 + 4 * 2047 + 1);
    assert_int_equal(line[strlen(line) - 1], '\n');
}

static size_t count_lines(const char *text) {
    size_t n = 0;
    for (; *text; text++)
        n += *text == '\n';
    return n;
}

static void test_repeats(void **state) {
    (void)state;
    for (int i = 0; i < 100; i++) {
        log_warning("the disk is full");
        log_error("job %d failed", i); /* these differ: all are written */
    }
    assert_int_equal(count_lines(written()), 105);
    log_error("the disk is full"); /* another level is another message */
    assert_string_equal(written(), "<3>the disk is full\n");
    clock_ms += 29999;
    log_info("a");
    assert_string_equal(written(), "<6>a\n");
    clock_ms += 1;
    log_info("b");
    assert_string_equal(written(), "<4>95 times more: the disk is full\n<6>b\n");
    log_warning("the disk is full");
    assert_string_equal(written(), "<4>the disk is full\n");
}

static void test_flush_and_a_clock_set_back(void **state) {
    (void)state;
    for (int i = 0; i < 7; i++)
        log_info("again");
    assert_int_equal(count_lines(written()), 5);
    log_flush();
    assert_string_equal(written(), "<6>2 times more: again\n");
    log_flush();
    assert_string_equal(written(), "");
    for (int i = 0; i < 6; i++)
        log_info("back");
    written();
    clock_ms -= 86400000;
    log_info("back");
    assert_string_equal(written(), "<6>1 times more: back\n<6>back\n");
}

/* More different messages that repeat than there is room for: none is lost. */
static void test_more_than_there_is_room_for(void **state) {
    (void)state;
    for (int i = 0; i < 60; i++) {
        for (int k = 0; k < 6; k++)
            log_info("message %d", i);
    }
    const size_t lines = count_lines(written());
    assert_int_equal(lines, 32 * 5 + 28 * 6);
    log_flush();
    assert_int_equal(count_lines(written()), 32);
}

static void *log_much(void *argument) {
    for (int i = 0; i < 200; i++)
        log_info("%s %d", (const char *)argument, i);
    return NULL;
}

static void test_threads(void **state) {
    (void)state;
    pthread_t threads[2];
    pthread_create(&threads[0], NULL, log_much, (void *)"one");
    pthread_create(&threads[1], NULL, log_much, (void *)"two");
    pthread_join(threads[0], NULL);
    pthread_join(threads[1], NULL);
    const char *p = written();
    assert_int_equal(count_lines(p), 400);
    for (; *p; p = strchr(p, '\n') + 1)
        assert_true(strncmp(p, "<6>one ", 7) == 0 || strncmp(p, "<6>two ", 7) == 0);
}

/* Nobody reads the pipe: who logs goes on; then all that was kept comes, whole and in order, and a
 * line where some are missing says how many. */
static void test_a_pipe_that_nobody_reads(void **state) {
    (void)state;
    enum { LINES = 20000, TAIL = 3 };
    static char text[1 << 20];
    for (int i = 0; i < LINES; i++)
        log_info("line %06d %032d", i, 0);
    const log_losses losses = log_get_losses();
    assert_true(losses.lines > 0 && losses.lines < LINES);
    assert_true(losses.waiting_bytes > 0);
    assert_int_equal(losses.since_ms, clock_ms);
    assert_false(log_drain(10));
    size_t n = 0;
    int told = 0;
    for (int spins = 0; told < 1 || log_get_losses().waiting_bytes > 0; spins++) {
        const ssize_t got = read(ends[0], text + n, sizeof text - 1 - n);
        n += got > 0 ? (size_t)got : 0;
        text[n] = '\0';
        log_flush();
        told = strstr(text, "lost here") != NULL;
        assert_true(spins < 60000);
        if (got <= 0)
            usleep(1000);
    }
    for (int i = 0; i < TAIL; i++)
        log_info("line %06d %032d", LINES + i, 0);
    assert_true(log_drain(60000));
    ssize_t got = 0;
    while ((got = read(ends[0], text + n, sizeof text - 1 - n)) > 0)
        n += (size_t)got;
    text[n] = '\0';
    long long next = 0;
    for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
        long long number = 0;
        if (sscanf(line, "<6>line %lld", &number) == 1) {
            assert_int_equal(number, next);
            assert_int_equal(strlen(line), 3 + 12 + 32);
            next++;
        } else {
            assert_int_equal(sscanf(line, "<4>%lld lines of the log were lost", &number), 1);
            next += number;
        }
    }
    assert_int_equal(next, LINES + TAIL);
    assert_int_equal(log_get_losses().lines, losses.lines);
}

/* Its reader is gone for good. */
static void test_a_pipe_whose_reader_is_gone(void **state) {
    (void)state;
    signal(SIGPIPE, SIG_IGN);
    close(ends[0]);
    for (int i = 0; i < 20000; i++)
        log_info("line %d of a pipe that leads nowhere", i);
    assert_true(log_drain(60000));
    ends[0] = open("/dev/null", O_RDONLY);
}

/* Flags of an open file are everybody's who shares it. */
static void test_flags_stay(void **state) {
    (void)state;
    const int before = fcntl(ends[1], F_GETFL);
    reopen(LOG_JOURNAL);
    log_info("x");
    assert_string_equal(written(), "<6>x\n");
    assert_int_equal(fcntl(ends[1], F_GETFL), before);
}

static void test_errno_is_kept(void **state) {
    (void)state;
    log_drain(60000);
    errno = ENOSPC;
    close(ends[1]);
    log_error("nowhere to go");
    assert_int_equal(errno, ENOSPC);
    log_drain(60000);
    ends[1] = dup(ends[0]);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)
int main(void) {
    const struct CMUnitTest tests[] = {
        TEST(test_levels),
        TEST(test_time_stamps),
        TEST(test_journal_stream),
        TEST(test_escapes),
        TEST(test_longest),
        TEST(test_repeats),
        TEST(test_flush_and_a_clock_set_back),
        TEST(test_more_than_there_is_room_for),
        TEST(test_threads),
        TEST(test_a_pipe_that_nobody_reads),
        TEST(test_a_pipe_whose_reader_is_gone),
        TEST(test_flags_stay),
        TEST(test_errno_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
