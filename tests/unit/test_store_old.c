/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A database of schema version 5 (before 0.2): its sums have no noise parts and no stamp that
 * counts most, its stamps' terms are shorter. What was counted stays, and can be joined
 * and taken back as before. */
#include "store/database.h"
#include "store/schema.h"
#include "store/sums_text.h"
#include "store_audit.h"
#include "store_test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { USED = 16, OLD_BYTES = 48, OLD_JOBS = 2 };

static int setup(void **state) {
    fixture *f = calloc(1, sizeof *f);
    fx_init(f);
    *state = f;
    return 0;
}

static int teardown(void **state) {
    fx_deinit(*state);
    free(*state);
    return 0;
}

/* Terms of 16 stamps as they are now, numbered from `first`: n1 tells the number. */
static void new_terms(int first, unsigned char bytes[USED * SHEAR_SYMMETRY_BYTES]) {
    shear_symmetry *terms = NULL;
    shear_error err = {0};
    FX_OK(shear_symmetry_new(&terms, &err));
    for (int i = 0; i < USED; i++) {
        const shear_row row = {.n1 = first + i, .d = 1.0, .u = 0.5, .v = 0.25, .weight = 1.0};
        FX_OK(shear_symmetry_add(terms, &row, 1.5, &err));
    }
    shear_symmetry_bytes(terms, 0, bytes);
    shear_symmetry_free(terms);
}

/* The same as they were: without the last number, as SQL's hexadecimal digits. */
static void old_terms(int first, char hex[2 * USED * OLD_BYTES + 1]) {
    unsigned char bytes[USED * SHEAR_SYMMETRY_BYTES];
    new_terms(first, bytes);
    for (int i = 0, at = 0; i < USED; i++) {
        for (int k = 0; k < OLD_BYTES; k++, at += 2)
            snprintf(hex + at, 3, "%02x", bytes[i * SHEAR_SYMMETRY_BYTES + k]);
    }
}

static char *packed_old(unsigned seed) {
    shear_error err = {0};
    char *packed = NULL;
    char *text = fx_old_sums(seed);
    FX_OK(sums_pack(text, &packed, &err));
    free(text);
    return packed;
}

static char *packed_join(void) {
    shear_error err = {0};
    char *old[OLD_JOBS] = {fx_old_sums(0), fx_old_sums(3)};
    char *text = fx_join((const char *const *)old, OLD_JOBS);
    char *packed = NULL;
    FX_OK(sums_pack(text, &packed, &err));
    free(text);
    free(old[0]);
    free(old[1]);
    return packed;
}

static const char rows[] =
    "INSERT INTO settings(digest, text) VALUES ('d0', '{}');"
    "INSERT INTO jobs(id, owner, source, settings, origin, priority, forced, created_ms, field,"
    "  content) VALUES (1, 7, '/1', 'd0', 1, 0, 0, 5, 'a', 'c1'),"
    "  (2, 7, '/2', 'd0', 1, 0, 0, 5, 'a', 'c2'), (3, 7, '/3', 'd0', 1, 0, 0, 5, 'a', 'c3');"
    "UPDATE jobs SET state = 1, attempts = 1, attempt = 1, started_ms = 6;"
    "INSERT INTO attempts(job, number, started_ms) VALUES (1, 1, 6), (2, 1, 6), (3, 1, 6);"
    "INSERT INTO fields(id, name, settings, sums, n_stamps, n_used, updated_ms, jobs)"
    "  VALUES (1, 'a', 'd0', '%s', 32, 32, 9, 2);"
    "INSERT INTO contributions(id, field, job, content, sums, n_stamps, n_used, counted_ms)"
    "  VALUES (1, 1, 1, 'c1', '%s', 16, 16, 9), (2, 1, 2, 'c2', '%s', 16, 16, 9);"
    "INSERT INTO contribution_terms(contribution, part, bytes)"
    "  VALUES (1, 0, x'%s'), (2, 0, x'%s');"
    "UPDATE attempts SET ending = 1, ended_ms = 9 WHERE job < 3;"
    "UPDATE jobs SET state = 3, outcome = 1, n_stamps = 16, n_used = 16, finished_ms = 9"
    "  WHERE id < 3;"
    "INSERT INTO checkpoints(job, next_block, sums) VALUES (3, 1, '%s');"
    "INSERT INTO checkpoint_terms(job, end_block, bytes) VALUES (3, 1, x'%s');"
    "COMMIT";

/* Two jobs counted in one field; one was stopped after its first block. */
static void make_version_5(const char *path) {
    shear_error err = {0};
    sqlite3 *db = NULL;
    char *packed[OLD_JOBS] = {packed_old(0), packed_old(3)};
    char *joined = packed_join();
    char terms[OLD_JOBS][2 * USED * OLD_BYTES + 1];
    char *sql = NULL;
    old_terms(0, terms[0]);
    old_terms(USED, terms[1]);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    FX_OK(database_exec(db, path, "BEGIN", &err));
    FX_OK(schema_migrate(db, path, schema_steps, 0, 5, &err));
    assert_true(asprintf(&sql, rows, joined, packed[0], packed[1], terms[0], terms[1], packed[0],
                         terms[0]) > 0);
    FX_OK(database_exec(db, path, sql, &err));
    free(sql);
    free(joined);
    free(packed[0]);
    free(packed[1]);
    sqlite3_close(db);
}

/* The terms of the field are those of 16 stamps from each of these numbers on. */
static void assert_terms(fixture *f, const int *first, int n) {
    shear_error err = {0};
    shear_symmetry *terms = NULL;
    unsigned char expected[USED * SHEAR_SYMMETRY_BYTES];
    unsigned char bytes[3 * USED * SHEAR_SYMMETRY_BYTES];
    FX_OK(shear_symmetry_new(&terms, &err));
    FX_OK(store_field_terms(f->s, "a", "d0", terms, &err));
    assert_int_equal(shear_symmetry_count(terms), n * USED);
    shear_symmetry_bytes(terms, 0, bytes);
    for (int i = 0; i < n; i++) {
        new_terms(first[i], expected);
        assert_memory_equal(bytes + (size_t)i * sizeof expected, expected, sizeof expected);
    }
    shear_symmetry_free(terms);
}

static shear_influence field_top(fixture *f) {
    shear_error err = {0};
    store_field_page page;
    shear_field_sums *sums = NULL;
    FX_OK(store_field_get(f->s, "a", &page, &err));
    FX_OK(shear_field_sums_parse(&sums, page.fields[0].sums, &err));
    const shear_influence top = shear_field_sums_top(sums);
    shear_field_sums_free(sums);
    store_field_page_deinit(&page);
    return top;
}

/* The stopped job ends: with new sums and terms. */
static int64_t finish_stopped(fixture *f) {
    enum { SEED = 6 };
    shear_error err = {0};
    store_finished end;
    unsigned char terms[USED * SHEAR_SYMMETRY_BYTES];
    char *sums = fx_sums(SEED);
    const int64_t id = fx_next(f);
    new_terms(100, terms);
    const store_work work = {
        .sums = sums, .now_ms = fx_now(f), .terms = terms, .terms_size = sizeof terms};
    FX_OK(store_finish(f->s, id, &work, &end, &err));
    assert_int_equal(end.outcome, STORE_COUNTED);
    free(sums);
    return id;
}

static void begins_stopped_jobs_anew(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t block = -1;
    char *sums = NULL;
    shear_symmetry *terms = NULL;
    make_version_5(f->path);
    fx_open(f);
    assert_int_equal(store_opened(f->s)->migrated_from, 5);
    FX_CODE(STORE_NOT_FOUND, store_checkpoint_load(f->s, 3, &block, &sums, &err));
    FX_OK(shear_symmetry_new(&terms, &err));
    FX_OK(store_checkpoint_load_terms(f->s, 3, terms, &err));
    assert_int_equal(shear_symmetry_count(terms), 0);
    shear_symmetry_free(terms);
    FX_OK(store_audit(f->s, &err));
}

/* Old and new in one field, taken back one after the other: the stamp that counts most is known
 * again when the last old one has left. */
static void joins_and_takes_back(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    make_version_5(f->path);
    fx_open(f);
    FX_OK(store_audit(f->s, &err));
    assert_terms(f, (const int[]){0, USED}, 2);
    assert_true(isnan(field_top(f).size));
    assert_int_equal(finish_stopped(f), 3);
    FX_OK(store_audit(f->s, &err));
    assert_terms(f, (const int[]){0, USED, 100}, 3);
    assert_true(isnan(field_top(f).size));
    FX_OK(store_retract(f->s, 1, &err));
    FX_OK(store_audit(f->s, &err));
    assert_terms(f, (const int[]){USED, 100}, 2);
    assert_true(isnan(field_top(f).size));
    FX_OK(store_retract(f->s, 2, &err));
    FX_OK(store_audit(f->s, &err));
    assert_terms(f, (const int[]){100}, 1);
    assert_true(field_top(f).size == fx_top(6).size);
    assert_int_equal(field_top(f).stamp, fx_top(6).stamp);
    fx_close(f);
    fx_open(f);
    FX_OK(store_audit(f->s, &err));
}

/* Sums of a field as version 0.1 wrote them, which nothing was joined to since. */
static void reads_the_old_text(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    char *packed = packed_old(3);
    char *sql = NULL;
    make_version_5(f->path);
    fx_open(f);
    FX_OK(store_retract(f->s, 1, &err));
    assert_true(asprintf(&sql, "UPDATE fields SET sums = '%s'", packed) > 0);
    FX_OK(database_exec(f->s->db, f->path, sql, &err));
    FX_OK(store_audit(f->s, &err));
    finish_stopped(f);
    FX_OK(store_audit(f->s, &err));
    free(sql);
    free(packed);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(begins_stopped_jobs_anew, setup, teardown),
        cmocka_unit_test_setup_teardown(joins_and_takes_back, setup, teardown),
        cmocka_unit_test_setup_teardown(reads_the_old_text, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
