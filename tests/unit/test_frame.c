/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Framing: the lines do not depend on how the bytes arrive in pieces. */
#include "scarce.h"
#include "sheard/frame.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIMIT = 12, LOG_SIZE = 4096 };

/* A diary of events: "L<line>" "T" "N" "M" */
static void note(char *diary, enum sheard_frame_event event, const char *line, size_t length) {
    const size_t used = strlen(diary);
    switch (event) {
    case SHEARD_FRAME_LINE:
        snprintf(diary + used, LOG_SIZE - used, "L<%.*s>", (int)length, line);
        break;
    case SHEARD_FRAME_TOO_LONG:
        snprintf(diary + used, LOG_SIZE - used, "T");
        break;
    case SHEARD_FRAME_NUL:
        snprintf(diary + used, LOG_SIZE - used, "N");
        break;
    default:
        snprintf(diary + used, LOG_SIZE - used, "M");
        break;
    }
}

/* Each piece in memory of exactly its size, so that a sanitizer sees a byte read too far. */
static void feed(sheard_frame *f, const char *bytes, size_t n, char *diary) {
    char *piece = malloc(n > 0 ? n : 1);
    assert_non_null(piece);
    memcpy(piece, bytes, n);
    const char *at = piece;
    size_t left = n;
    for (;;) {
        const char *line = NULL;
        size_t length = 0;
        const enum sheard_frame_event event = sheard_frame_next(f, &at, &left, &line, &length);
        assert_true(f->size <= f->limit && f->used <= f->size);
        if (event == SHEARD_FRAME_MORE)
            break;
        note(diary, event, line, length);
    }
    assert_int_equal(left, 0);
    assert_ptr_equal(at, piece + n);
    free(piece);
}

/* Lines of all kinds, and the events they are. */
static const char stream[] = "one\n"
                             "\n"
                             "two\r\n"
                             "\r\n"
                             "123456789012\n"   /* LIMIT */
                             "1234567890123\n"  /* one more */
                             "12345678901\r\n"  /* LIMIT with the \r */
                             "123456789012\r\n" /* one more */
                             "a\0b\n"
                             "\0\n"
                             "12345678901\0\n"  /* NUL is byte number LIMIT */
                             "123456789012\0\n" /* NUL is the first byte too many */
                             "way beyond the limit, and a \0 as well, in one line\n"
                             "\rx\r\r\n"
                             "three\n"
                             "cut";
static const char expected[] = "L<one>L<two>L<123456789012>TL<12345678901>TNNNTTL<\rx\r>L<three>";
enum { STREAM_SIZE = sizeof stream - 1 };

static void whole(char *diary) {
    sheard_frame f;
    sheard_frame_init(&f, LIMIT);
    feed(&f, stream, STREAM_SIZE, diary);
    assert_int_equal(sheard_frame_pending(&f), 3);
    sheard_frame_deinit(&f);
}

static void test_events(void **state) {
    (void)state;
    char diary[LOG_SIZE] = "";
    whole(diary);
    assert_string_equal(diary, expected);
}

static void test_every_cut(void **state) {
    (void)state;
    for (size_t cut = 0; cut <= STREAM_SIZE; cut++) {
        for (size_t again = cut; again <= STREAM_SIZE; again++) {
            char diary[LOG_SIZE] = "";
            sheard_frame f;
            sheard_frame_init(&f, LIMIT);
            feed(&f, stream, cut, diary);
            feed(&f, stream + cut, again - cut, diary);
            feed(&f, stream + again, STREAM_SIZE - again, diary);
            assert_string_equal(diary, expected);
            assert_int_equal(sheard_frame_pending(&f), 3);
            sheard_frame_deinit(&f);
        }
    }
}

static void test_pieces_of_one_size(void **state) {
    (void)state;
    for (size_t size = 1; size <= STREAM_SIZE; size++) {
        char diary[LOG_SIZE] = "";
        sheard_frame f;
        sheard_frame_init(&f, LIMIT);
        for (size_t at = 0; at < STREAM_SIZE; at += size)
            feed(&f, stream + at, size < STREAM_SIZE - at ? size : STREAM_SIZE - at, diary);
        assert_string_equal(diary, expected);
        sheard_frame_deinit(&f);
    }
}

/* A caller that stops after a line (too many requests in flight) goes on later where it was. */
static void test_one_event_at_a_time(void **state) {
    (void)state;
    sheard_frame f;
    sheard_frame_init(&f, LIMIT);
    const char *at = "a\nb\nc";
    size_t left = 5;
    const char *line = NULL;
    size_t length = 0;
    assert_int_equal(sheard_frame_next(&f, &at, &left, &line, &length), SHEARD_FRAME_LINE);
    assert_int_equal(left, 3);
    assert_memory_equal(line, "a", length);
    assert_int_equal(sheard_frame_next(&f, &at, &left, &line, &length), SHEARD_FRAME_LINE);
    assert_memory_equal(line, "b", length);
    assert_int_equal(sheard_frame_next(&f, &at, &left, &line, &length), SHEARD_FRAME_MORE);
    assert_null(line);
    at = "d\n";
    left = 2;
    assert_int_equal(sheard_frame_next(&f, &at, &left, &line, &length), SHEARD_FRAME_LINE);
    assert_int_equal(length, 2);
    assert_memory_equal(line, "cd", 2);
    assert_int_equal(sheard_frame_pending(&f), 0);
    sheard_frame_deinit(&f);
}

/* Lines that come whole are not copied; a long one that came in pieces is not kept. */
static void test_memory(void **state) {
    (void)state;
    enum { LONG = 100000 };
    sheard_frame f;
    sheard_frame_init(&f, LONG);
    char diary[LOG_SIZE] = "";
    feed(&f, "whole\n", 6, diary);
    assert_null(f.kept);
    char *bytes = malloc(LONG);
    assert_non_null(bytes);
    memset(bytes, 'x', LONG);
    for (int i = 0; i < 10; i++)
        feed(&f, bytes, LONG / 10, diary);
    assert_int_equal(sheard_frame_pending(&f), LONG);
    assert_true(f.size == LONG);
    feed(&f, "\nnext\n", 6, diary);
    assert_null(f.kept);
    for (int i = 0; i < 1000; i++) { /* a flood without an end */
        feed(&f, bytes, LONG, diary);
        assert_true(f.size <= LONG);
    }
    diary[0] = '\0';
    feed(&f, "\nafter\n", 7, diary);
    assert_string_equal(diary, "L<after>");
    free(bytes);
    sheard_frame_deinit(&f);
    sheard_frame_deinit(&f);
}

static void test_no_memory(void **state) {
    (void)state;
    char diary[LOG_SIZE] = "";
    sheard_frame f;
    sheard_frame_init(&f, LIMIT);
    const char *at = "abc";
    size_t left = 3;
    const char *line = NULL;
    size_t length = 0;
    scarce_after(1, false);
    assert_int_equal(sheard_frame_next(&f, &at, &left, &line, &length), SHEARD_FRAME_NOMEM);
    assert_true(scarce_end());
    feed(&f, "def\nnext\n", 9, diary); /* the rest of that line is skipped */
    assert_string_equal(diary, "L<next>");
    sheard_frame_deinit(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_events),
        cmocka_unit_test(test_every_cut),
        cmocka_unit_test(test_pieces_of_one_size),
        cmocka_unit_test(test_one_event_at_a_time),
        cmocka_unit_test(test_memory),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
