/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contributions are taken back: the database's fields are then, byte for byte, those of a
 * database that never had it. */
#include "store/database.h"
#include "store_audit.h"
#include "store_test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static unsigned char *terms_of(int seed, int n) {
    shear_symmetry *terms = NULL;
    shear_error err = {0};
    unsigned char *bytes = malloc((size_t)n * SHEAR_SYMMETRY_BYTES + 1);
    FX_OK(shear_symmetry_new(&terms, &err));
    for (int i = 0; i < n; i++) {
        const shear_row row = {.n1 = 100 * seed + i, .d = 1.0, .weight = 1.0};
        FX_OK(shear_symmetry_add(terms, &row, 1.5, &err));
    }
    shear_symmetry_bytes(terms, 0, bytes);
    shear_symmetry_free(terms);
    return bytes;
}

/* A counted job of that content, at a time of its own, with or without terms. */
static int64_t count_one(fixture *f, const char *field, const char *content, unsigned seed,
                         bool with_terms) {
    enum { USED = 16 };
    shear_error err = {0};
    store_finished end;
    char account[32];
    const int64_t id = fx_running(f, field, content);
    const int n = USED - (int)(seed % 3);
    char *sums = fx_sums(seed);
    unsigned char *terms = with_terms ? terms_of((int)seed, n) : NULL;
    snprintf(account, sizeof account, "{\"path\":\"%u\"}", seed);
    const store_work work = {.sums = sums,
                             .result = "{}",
                             .catalog = "/c/1.shear.fits",
                             .elapsed_us = 10 + seed,
                             .now_ms = 100000 + seed * 7919 % 1000,
                             .account = account,
                             .has_truth = seed % 2 == 0,
                             .true_g1 = 0.01 * seed,
                             .terms = terms,
                             .terms_size = (size_t)n * SHEAR_SYMMETRY_BYTES};
    FX_OK(store_finish(f->s, id, &work, &end, &err));
    assert_int_equal(end.outcome, STORE_COUNTED);
    free(terms);
    free(sums);
    return id;
}

/* Everything that fields and contributions say, but for the numbers of rows and jobs. */
static char *dump(fixture *f) {
    static const char *const queries[] = {
        "SELECT name, settings, jobs, n_stamps, n_used, updated_ms, elapsed_us, sums FROM fields"
        " ORDER BY name, settings",
        "SELECT f.name, f.settings, content, c.n_stamps, c.n_used, counted_ms, c.sums,"
        " c.elapsed_us, account, true_g1, true_g2, top_size, top_stamp,"
        " (SELECT group_concat(hex(bytes)) FROM contribution_terms WHERE contribution = c.id)"
        " FROM contributions c JOIN fields f ON f.id = field ORDER BY f.name, f.settings, c.id",
        "SELECT count(*), sum(length(bytes)) FROM contribution_terms", "SELECT fields FROM totals"};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    for (size_t i = 0; i < sizeof queries / sizeof queries[0]; i++) {
        sqlite3_stmt *stmt = NULL;
        assert_int_equal(sqlite3_prepare_v2(f->s->db, queries[i], -1, &stmt, NULL), SQLITE_OK);
        while (sqlite3_step(stmt) == SQLITE_ROW) {
            for (int c = 0; c < sqlite3_column_count(stmt); c++) {
                const char *value = (const char *)sqlite3_column_text(stmt, c);
                fprintf(out, "%s|", value != NULL ? value : "null");
            }
            fputc('\n', out);
        }
        sqlite3_finalize(stmt);
    }
    fclose(out);
    return text;
}

static void assert_same(fixture *f, fixture *other) {
    char *a = dump(f);
    char *b = dump(other);
    assert_string_equal(a, b);
    free(a);
    free(b);
}

static uint64_t draw(uint64_t *random, uint64_t n) {
    uint64_t z = *random += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (z ^ (z >> 31)) % n;
}

/* Some of many, in any order, of two fields, some with terms. */
static void as_if_never_counted(void **state) {
    enum { MANY = 24 };
    fixture *f = *state;
    shear_error err = {0};
    uint64_t random = 17;
    for (int round = 0; round < 8; round++) {
        fixture other;
        int64_t ids[MANY];
        bool out[MANY];
        char content[16];
        fx_init(&other);
        fx_open(&other);
        for (unsigned i = 0; i < MANY; i++) {
            out[i] = draw(&random, 8) < (unsigned)round + 1; /* all of them in the last */
            snprintf(content, sizeof content, "c%u", i);
            const char *field = i % 5 == 0 ? "b" : "a";
            ids[i] = count_one(f, field, content, i, i % 2 == 0);
            if (!out[i])
                count_one(&other, field, content, i, i % 2 == 0);
        }
        for (unsigned i = 0, at = (unsigned)draw(&random, MANY); i < MANY; i++) {
            at = (at + 7) % MANY; /* 7 and 24 have no divisor in common */
            if (out[at])
                FX_OK(store_retract(f->s, ids[at], &err));
        }
        assert_same(f, &other);
        FX_OK(store_audit(f->s, &err));
        for (unsigned i = 0; i < MANY; i++) {
            FX_OK(store_retract(f->s, ids[i], &err)); /* the others too; again is no error */
        }
        FX_OK(store_audit(f->s, &err));
        fx_deinit(&other);
    }
    char *text = dump(f);
    assert_string_equal(text, "0|null|\n0|\n");
    free(text);
}

static void the_job_is_retracted(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_job job;
    store_counts counts;
    store_totals totals;
    const int64_t id = count_one(f, "a", "c", 3, false);
    FX_OK(store_retract(f->s, id, &err));
    FX_OK(store_job_get(f->s, id, &job, &err));
    assert_int_equal(job.state, STORE_RETRACTED);
    assert_int_equal(job.outcome, STORE_NO_OUTCOME);
    assert_string_equal(job.content, "c");
    store_job_deinit(&job);
    FX_OK(store_count(f->s, &counts, &err));
    assert_int_equal(counts.jobs[STORE_RETRACTED], 1);
    assert_int_equal(counts.jobs[STORE_DONE], 0);
    assert_int_equal(counts.unfinished, 0);
    FX_OK(store_total(f->s, &totals, &err));
    assert_int_equal(totals.counted, 1); /* that happened */
    assert_int_equal(totals.retracted, 1);
    enum store_state state_now = STORE_QUEUED;
    FX_CODE(STORE_WRONG_STATE, store_cancel(f->s, id, 1, &state_now, &err));
    FX_CODE(STORE_WRONG_STATE, store_retry(f->s, id, 10, &err));
    store_field_page page;
    FX_CODE(STORE_NOT_FOUND, store_field_get(f->s, "a", &page, &err));
}

/* Its content counts again; what was found a duplicate of it stays that. */
static void counts_again(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_finished end;
    const int64_t first = count_one(f, "a", "c", 3, true);
    const int64_t duplicate = fx_running(f, "a", "c");
    const store_work empty = {.now_ms = fx_now(f)};
    FX_OK(store_finish(f->s, duplicate, &empty, &end, &err));
    assert_int_equal(end.outcome, STORE_DUPLICATE);
    FX_CODE(STORE_WRONG_STATE, store_retract(f->s, duplicate, &err));
    assert_non_null(strstr(err.message, "duplicate of job 1"));
    FX_OK(store_retract(f->s, first, &err));
    FX_CODE(STORE_WRONG_STATE, store_retract(f->s, duplicate, &err));
    assert_int_equal(fx_state(f, duplicate), STORE_DONE);
    count_one(f, "a", "c", 3, true);
}

static void only_what_was_counted(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    enum store_state now = STORE_QUEUED;
    FX_CODE(STORE_NOT_FOUND, store_retract(f->s, 1, &err));
    const int64_t id = fx_running(f, "a", "c");
    FX_CODE(STORE_WRONG_STATE, store_retract(f->s, id, &err));
    const store_failure failure = fx_failure(f, STORE_DATA, STORE_NEVER);
    FX_OK(store_fail(f->s, id, &failure, &now, &err));
    FX_CODE(STORE_WRONG_STATE, store_retract(f->s, id, &err));
}

/* In a group that is given up, nothing has happened. */
static void is_undone_with_its_group(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_forgotten gone;
    const int64_t id = count_one(f, "a", "c", 3, true);
    count_one(f, "a", "d", 4, true);
    char *before = dump(f);
    FX_OK(store_begin(f->s, &err));
    FX_OK(store_retract(f->s, id, &err));
    FX_OK(store_forget(f->s, "a", NULL, &gone, &err));
    assert_int_equal(gone.contributions, 1);
    store_rollback(f->s);
    char *after = dump(f);
    assert_string_equal(before, after);
    assert_int_equal(fx_state(f, id), STORE_DONE);
    free(before);
    free(after);
}

static void whole_fields(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_forgotten gone;
    int64_t retired = 0;
    count_one(f, "a", "c", 3, true);
    const store_retention rule = {INT64_MAX, -1, 10};
    FX_OK(store_retire(f->s, &rule, &retired, &err));
    assert_int_equal(retired, 1); /* its contribution stays, and can be taken back all the same */
    const int64_t id = count_one(f, "a", "d", 4, false);
    count_one(f, "b", "d", 5, false);
    FX_CODE(STORE_NOT_FOUND, store_forget(f->s, "none", NULL, &gone, &err));
    FX_CODE(STORE_NOT_FOUND, store_forget(f->s, "a", "other", &gone, &err));
    const int64_t running = fx_running(f, "a", "e");
    FX_CODE(STORE_WRONG_STATE, store_forget(f->s, "a", NULL, &gone, &err));
    assert_non_null(strstr(err.message, "1 unfinished"));
    enum store_state now = STORE_QUEUED;
    FX_OK(store_cancel(f->s, running, fx_now(f), &now, &err));
    FX_OK(store_release(f->s, running, fx_now(f), &now, &err));
    FX_OK(store_forget(f->s, "a", "d0", &gone, &err));
    assert_int_equal(gone.rows, 1);
    assert_int_equal(gone.contributions, 2);
    assert_int_equal(fx_leave(f, INT64_MAX), 1);
    assert_int_equal(fx_state(f, id), STORE_RETRACTED);
    FX_CODE(STORE_NOT_FOUND, store_forget(f->s, "a", NULL, &gone, &err));
    fixture other;
    fx_init(&other);
    fx_open(&other);
    count_one(&other, "b", "d", 5, false);
    assert_same(f, &other);
    fx_deinit(&other);
}

/* The field is gone at once and begins again; whatever happens until its last contribution is
 * removed, the database is consistent. */
static void leaves_bit_by_bit(void **state) {
    enum { MANY = 5, STEPS = MANY + 2 }; /* one for the row, one that finds nothing */
    fixture *f = *state;
    shear_error err = {0};
    store_forgotten gone;
    store_field_page page;
    char content[16];
    for (unsigned i = 0; i < MANY; i++) {
        snprintf(content, sizeof content, "c%u", i);
        count_one(f, "a", content, i, true);
    }
    count_one(f, "b", "c0", 0, true);
    FX_OK(store_forget(f->s, "a", NULL, &gone, &err));
    assert_int_equal(gone.rows, 1);
    assert_int_equal(gone.contributions, MANY);
    FX_CODE(STORE_NOT_FOUND, store_field_get(f->s, "a", &page, &err));
    FX_CODE(STORE_NOT_FOUND, store_forget(f->s, "a", NULL, &gone, &err));
    fixture other;
    fx_init(&other);
    fx_open(&other);
    count_one(&other, "b", "c0", 0, true);
    for (int step = 0; step < STEPS; step++) {
        if (step == 1) { /* counted again, though its first contribution has not left yet */
            count_one(f, "a", "c4", 4, true);
            count_one(&other, "a", "c4", 4, true);
        }
        if (step == 2) { /* in its own right, out of turn */
            FX_OK(store_retract(f->s, MANY, &err));
            assert_int_equal(fx_state(f, MANY), STORE_RETRACTED);
        }
        FX_OK(store_audit(f->s, &err));
        fx_close(f);
        fx_open(f);
        assert_int_equal(fx_state(f, step + 1 < MANY ? step + 1 : 1),
                         step + 1 < MANY ? STORE_DONE : STORE_RETRACTED);
        assert_int_equal(fx_leave(f, 1), step + 1 < MANY ? 1 : 0);
    }
    assert_same(f, &other);
    FX_OK(store_audit(f->s, &err));
    fx_deinit(&other);
}

/* Their catalogs are known by the jobs' numbers alone. */
static void tells_retired_jobs(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_forgotten gone;
    store_removal next;
    int64_t retired = 0;
    const int64_t first = count_one(f, "a", "c", 3, false);
    const store_retention rule = {INT64_MAX, -1, 10};
    FX_OK(store_retire(f->s, &rule, &retired, &err));
    const int64_t second = count_one(f, "a", "d", 4, false);
    FX_OK(store_forget(f->s, "a", NULL, &gone, &err));
    FX_OK(store_next_removal(f->s, &next, &err));
    assert_int_equal(next.job, first);
    assert_false(next.kept);
    assert_null(next.catalog);
    assert_string_equal(next.field, "a");
    FX_OK(store_remove(f->s, &next, true, &err));
    store_removal_deinit(&next);
    FX_OK(store_next_removal(f->s, &next, &err));
    assert_int_equal(next.job, second);
    assert_true(next.kept);
    assert_string_equal(next.catalog, "/c/1.shear.fits");
    FX_OK(store_remove(f->s, &next, true, &err));
    store_removal_deinit(&next);
    int64_t id = 0;
    char *path = NULL;
    FX_OK(store_next_leftover(f->s, 0, &id, &path, &err));
    assert_int_equal(id, 0);
}

static void catalogs_are_told_until_they_are_gone(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t id = 0;
    char *path = NULL;
    const int64_t first = count_one(f, "a", "c", 3, false);
    const int64_t second = count_one(f, "a", "d", 4, false);
    FX_OK(store_next_leftover(f->s, 0, &id, &path, &err));
    assert_int_equal(id, 0);
    FX_OK(store_retract(f->s, first, &err));
    FX_OK(store_retract(f->s, second, &err));
    fx_close(f);
    fx_open(f);
    FX_OK(store_next_leftover(f->s, 0, &id, &path, &err));
    assert_int_equal(id, first);
    assert_string_equal(path, "/c/1.shear.fits");
    free(path);
    FX_OK(store_catalog_gone(f->s, first, &err));
    FX_OK(store_next_leftover(f->s, 0, &id, &path, &err));
    assert_int_equal(id, second);
    free(path);
    FX_OK(store_next_leftover(f->s, second, &id, &path, &err));
    assert_int_equal(id, 0);
    assert_null(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(as_if_never_counted),
        STORE_TEST(the_job_is_retracted),
        STORE_TEST(counts_again),
        STORE_TEST(only_what_was_counted),
        STORE_TEST(is_undone_with_its_group),
        STORE_TEST(whole_fields),
        STORE_TEST(leaves_bit_by_bit),
        STORE_TEST(tells_retired_jobs),
        STORE_TEST(catalogs_are_told_until_they_are_gone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
