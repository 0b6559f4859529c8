/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Terms of stamps beside checkpoints and contributions: pieces follow each other without a gap, go
 * with their checkpoint, and what was counted is all there. */
#include "store/database.h"
#include "store_audit.h"
#include "store_test.h"

#include <stdlib.h>
#include <string.h>

enum { N = 16 };

/* Terms of n stamps, numbered from `first`: bytes, malloc'd. */
static unsigned char *bytes_of(int first, int n) {
    shear_symmetry *terms = NULL;
    shear_error err = {0};
    unsigned char *bytes = malloc((size_t)n * SHEAR_SYMMETRY_BYTES + 1);
    FX_OK(shear_symmetry_new(&terms, &err));
    for (int i = 0; i < n; i++) {
        const shear_row row = {.n1 = first + i, .d = 1.0, .weight = 1.0};
        FX_OK(shear_symmetry_add(terms, &row, 1.5, &err));
    }
    shear_symmetry_bytes(terms, 0, bytes);
    shear_symmetry_free(terms);
    return bytes;
}

static size_t size_of(int n) {
    return (size_t)n * SHEAR_SYMMETRY_BYTES;
}

/* A checkpoint of blocks [from, to), which brings n stamps numbered from `first`. */
static int save(fixture *f, int64_t id, int64_t from, int64_t to, int first, int n) {
    shear_error err = {0};
    char *sums = fx_sums(3);
    unsigned char *bytes = bytes_of(first, n);
    const store_progress progress = {from, to, sums, bytes, size_of(n)};
    const int code = store_checkpoint(f->s, id, &progress, &err);
    free(bytes);
    free(sums);
    return code;
}

/* The terms are those of n stamps numbered from 0, after what was in them before. */
static void assert_terms(const shear_symmetry *terms, int n) {
    unsigned char *expected = bytes_of(0, n);
    unsigned char *bytes = malloc(size_of(n) + 1);
    assert_int_equal(shear_symmetry_count(terms), n);
    shear_symmetry_bytes(terms, 0, bytes);
    assert_memory_equal(bytes, expected, size_of(n));
    free(bytes);
    free(expected);
}

static void assert_saved(fixture *f, int64_t id, int n) {
    shear_error err = {0};
    shear_symmetry *terms = NULL;
    FX_OK(shear_symmetry_new(&terms, &err));
    FX_OK(store_checkpoint_load_terms(f->s, id, terms, &err));
    assert_terms(terms, n);
    shear_symmetry_free(terms);
}

static void assert_counted(fixture *f, const char *field, int n) {
    shear_error err = {0};
    shear_symmetry *terms = NULL;
    FX_OK(shear_symmetry_new(&terms, &err));
    FX_OK(store_field_terms(f->s, field, "d0", terms, &err));
    assert_terms(terms, n);
    shear_symmetry_free(terms);
}

/* End a job with the terms of its 16 stamps, numbered from `first`. */
static store_finished finish(fixture *f, int64_t id, int first) {
    shear_error err = {0};
    store_finished end;
    char *sums = fx_sums(3);
    unsigned char *bytes = bytes_of(first, N);
    const store_work work = {
        .sums = sums, .now_ms = fx_now(f), .terms = bytes, .terms_size = size_of(N)};
    FX_OK(store_finish(f->s, id, &work, &end, &err));
    free(bytes);
    free(sums);
    return end;
}

static void pieces_follow_each_other(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t block = 0;
    char *sums = NULL;
    const int64_t id = fx_running(f, "a", "c");
    assert_saved(f, id, 0);
    assert_int_equal(save(f, id, 0, 2, 0, 5), SHEAR_OK);
    assert_int_equal(save(f, id, 2, 3, 5, 4), SHEAR_OK);
    assert_int_equal(save(f, id, 3, 3, 9, 0), SHEAR_OK); /* nothing new */
    assert_saved(f, id, 9);
    assert_int_equal(save(f, id, 4, 5, 0, 1), STORE_WRONG_STATE); /* block 3 is not there */
    FX_OK(store_checkpoint_load(f->s, id, &block, &sums, &err));
    assert_int_equal(block, 3);
    free(sums);
    assert_saved(f, id, 9);
    assert_int_equal(save(f, id, 2, 6, 5, 2), SHEAR_OK); /* again from a piece's end */
    assert_saved(f, id, 7);
    assert_int_equal(save(f, id, 0, 1, 0, 3), SHEAR_OK); /* from block 0 again */
    assert_saved(f, id, 3);
    fx_close(f);
    fx_open(f);
    assert_saved(f, id, 3);
}

static void pieces_go_with_their_checkpoint(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    int64_t of = 0;
    const int64_t done = fx_running(f, "a", "c");
    const int64_t cancelled = fx_running(f, "a", "d");
    const int64_t changed = fx_running(f, "a", "e");
    for (int64_t id = done; id <= changed; id++)
        assert_int_equal(save(f, id, 0, 2, 0, 5), SHEAR_OK);
    finish(f, done, 0);
    assert_saved(f, done, 0);
    FX_OK(store_cancel(f->s, cancelled, fx_now(f), &end, &err));
    FX_OK(store_release(f->s, cancelled, fx_now(f), &end, &err));
    assert_int_equal(end, STORE_CANCELLED);
    assert_saved(f, cancelled, 0);
    const store_input learned = {.content = "other", .n_stamps = -1};
    FX_OK(store_set_input(f->s, changed, &learned, &of, &err));
    assert_saved(f, changed, 0);
}

static void what_was_counted_is_there(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    shear_symmetry *terms = NULL;
    assert_int_equal(finish(f, fx_running(f, "a", "c"), 0).outcome, STORE_COUNTED);
    assert_counted(f, "a", N);
    assert_int_equal(finish(f, fx_running(f, "b", "c"), 0).outcome, STORE_COUNTED);
    assert_int_equal(finish(f, fx_running(f, "a", "c"), 7).outcome, STORE_DUPLICATE);
    assert_int_equal(finish(f, fx_running(f, "a", "d"), N).outcome, STORE_COUNTED);
    assert_counted(f, "a", 2 * N);
    assert_counted(f, "b", N);
    fx_done(f, "plain", "c", 1); /* without terms */
    assert_counted(f, "plain", 0);
    FX_OK(shear_symmetry_new(&terms, &err));
    FX_CODE(STORE_NOT_FOUND, store_field_terms(f->s, "none", "d0", terms, &err));
    shear_symmetry_free(terms);
    int64_t gone = 0;
    const store_retention all = {INT64_MAX, 0, 100};
    FX_OK(store_retire(f->s, &all, &gone, &err));
    fx_close(f);
    fx_open(f);
    assert_counted(f, "a", 2 * N);
}

/* More than fits a part of the database. */
static void many_stamps(void **state) {
    enum { MANY = 40000 };
    fixture *f = *state;
    shear_error err = {0};
    store_finished end;
    shear_field_sums *sums = NULL;
    char *text = NULL;
    shear_block_sums block = {
        .n_stamps = MANY, .n_used = MANY, .framed = {[SHEAR_FRAME_PIXEL] = MANY}};
    FX_OK(shear_field_sums_new(&sums, &err));
    shear_field_sums_add(sums, &block);
    FX_OK(shear_field_sums_format(sums, &text, &err));
    unsigned char *bytes = bytes_of(0, MANY);
    const store_work work = {
        .sums = text, .now_ms = fx_now(f), .terms = bytes, .terms_size = size_of(MANY)};
    FX_OK(store_finish(f->s, fx_running(f, "a", "c"), &work, &end, &err));
    assert_counted(f, "a", MANY);
    free(bytes);
    free(text);
    shear_field_sums_free(sums);
}

static void nonsense_is_refused(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_finished end;
    char *sums = fx_sums(3);
    const int64_t id = fx_running(f, "a", "c");
    static const unsigned char odd[SHEAR_SYMMETRY_BYTES + 1];
    const store_progress torn = {0, 2, sums, odd, sizeof odd};
    const store_progress back = {3, 2, sums, odd, 0};
    FX_CODE(SHEAR_E_INTERNAL, store_checkpoint(f->s, id, &torn, &err));
    FX_CODE(SHEAR_E_INTERNAL, store_checkpoint(f->s, id, &back, &err));
    const store_work work = {
        .sums = sums, .now_ms = fx_now(f), .terms = odd, .terms_size = sizeof odd};
    FX_CODE(SHEAR_E_INTERNAL, store_finish(f->s, id, &work, &end, &err));
    assert_int_equal(fx_state(f, id), STORE_RUNNING);
    free(sums);
}

static void missing_terms_are_found(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    finish(f, fx_running(f, "a", "c"), 0);
    FX_OK(store_audit(f->s, &err));
    assert_int_equal(sqlite3_exec(f->s->db,
                                  "SAVEPOINT lie; UPDATE contribution_terms SET bytes = x'00'",
                                  NULL, NULL, NULL),
                     SQLITE_OK);
    FX_CODE(SHEAR_E_FORMAT, store_audit(f->s, &err));
    sqlite3_exec(f->s->db, "ROLLBACK TO lie; RELEASE lie", NULL, NULL, NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(pieces_follow_each_other),  STORE_TEST(pieces_go_with_their_checkpoint),
        STORE_TEST(what_was_counted_is_there), STORE_TEST(many_stamps),
        STORE_TEST(nonsense_is_refused),       STORE_TEST(missing_terms_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
