/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store_fill.h"

#include "base/cleanup.h"
#include "shear/sums.h"

#include <sqlite3.h>

char *store_fill_sums(void) {
    shear_block_sums block;
    shear_field_sums *sums = NULL;
    char *text = NULL;
    shear_block_sums_init(&block);
    block.n_stamps = SHEAR_BLOCK;
    block.n_used = SHEAR_BLOCK;
    for (int i = 0; i < SHEAR_N_TERMS; i++) {
        block.hi[i] = 1e3 / (i + 1.7);
        block.lo[i] = 1e-14 / (i + 1.3);
    }
    if (shear_field_sums_new(&sums, NULL) == SHEAR_OK) {
        shear_field_sums_add(sums, &block);
        shear_field_sums_format(sums, &text, NULL);
    }
    shear_field_sums_free(sums);
    return text;
}

int store_fill_submit(store *s, const char *source, int priority, int64_t created_ms, int64_t *id,
                      shear_error *err) {
    bool known = false;
    const store_spec spec = {.field = "field-0000000",
                             .source = source,
                             .settings = "{\"beta\":4}",
                             .settings_digest = "0123456789abcdef0123456789abcdef",
                             .priority = priority,
                             .owner = 1000,
                             .created_ms = created_ms};
    return store_submit(s, &spec, INT64_MAX, id, &known, err);
}

/* Create one real job, from which the others are copied. */
static int make_pattern(store *s, shear_error *err) {
    CLEANUP(store_job_deinit) store_job job = {0};
    store_finished end;
    int64_t id = 0;
    int64_t of = 0;
    CLEANUP(release_free) char *sums = store_fill_sums();
    const store_input input = {NULL, "00000000000000000000000000000001", SHEAR_BLOCK};
    const store_work work = {.sums = sums,
                             .result = "{\"g1\":0.0123,\"g2\":-0.0045,\"g1_err\":0.001}",
                             .catalog = "/survey/out/field-0000000.csv",
                             .elapsed_us = 1000,
                             .now_ms = 2};
    if (sums == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory");
    TRY(store_fill_submit(s, "/survey/night-001/field-0000000.fits", 0, 1, &id, err));
    TRY(store_next(s, 1, &job, err));
    TRY(store_set_input(s, id, &input, &of, err));
    return store_finish(s, id, &work, &end, err);
}

/* ?1: jobs, ?2: fields. Job n belongs to field (n - 1) mod fields. Triggers are disabled; the
 * totals are set at the end. */
static const char *const statements[] = {
    "PRAGMA journal_mode = OFF",
    "PRAGMA synchronous = OFF",
    "PRAGMA cache_size = -1000000",
    "BEGIN",
    "UPDATE fields SET jobs = (?1 - 1) / ?2 + 1",
    "WITH RECURSIVE n(i) AS (SELECT 1 WHERE ?2 > 1 UNION ALL SELECT i + 1 FROM n WHERE i < ?2 - 1)"
    " INSERT INTO fields(id, name, settings, jobs, n_stamps, n_used, updated_ms, sums)"
    " SELECT i + 1, printf('field-%07d', i), settings, (?1 - 1 - i) / ?2 + 1,"
    "  16 * ((?1 - 1 - i) / ?2 + 1), 16 * ((?1 - 1 - i) / ?2 + 1), 2, sums FROM n, fields f"
    "  WHERE f.id = 1",
    "WITH RECURSIVE n(i) AS (SELECT 2 UNION ALL SELECT i + 1 FROM n WHERE i < ?1)"
    " INSERT INTO jobs(id, state, outcome, origin, priority, forced, owner, attempts, attempt,"
    "  created_ms, started_ms, finished_ms, n_stamps, n_used, elapsed_us, field, field_asked,"
    "  source, settings, content, result, catalogue)"
    " SELECT i, state, outcome, origin, priority, forced, owner, attempts, attempt, i, i, i,"
    "  n_stamps, n_used, elapsed_us, printf('field-%07d', (i - 1) % ?2),"
    "  printf('field-%07d', (i - 1) % ?2), source, settings, printf('%032x', i), result, catalogue"
    "  FROM n, jobs j WHERE j.id = 1",
    "WITH RECURSIVE n(i) AS (SELECT 2 UNION ALL SELECT i + 1 FROM n WHERE i < ?1)"
    " INSERT INTO attempts(job, number, started_ms, ended_ms, ending) SELECT i, 1, i, i, 1 FROM n",
    "WITH RECURSIVE n(i) AS (SELECT 2 UNION ALL SELECT i + 1 FROM n WHERE i < ?1)"
    " INSERT INTO contributions(id, field, job, content, n_stamps, n_used, counted_ms, sums)"
    " SELECT i, (i - 1) % ?2 + 1, i, printf('%032x', i), 16, 16, i, sums"
    "  FROM n, contributions c WHERE c.id = 1",
    "UPDATE counts SET n = ?1 WHERE state = 3",
    "UPDATE totals SET submitted = ?1, counted = ?1, attempts = ?1, fields = ?2, n_stamps = 16 * "
    "?1,"
    " n_used = 16 * ?1, elapsed_us = 1000 * ?1",
    "UPDATE settings SET uses = ?1 + ?2",
    "UPDATE sqlite_sequence SET seq = ?1 WHERE name = 'jobs'",
    "COMMIT",
};

static int run(sqlite3 *db, const char *sql, int64_t jobs, int64_t fields) {
    sqlite3_stmt *stmt = NULL;
    int rc = sqlite3_prepare_v2(db, sql, -1, &stmt, NULL);
    if (rc == SQLITE_OK) {
        sqlite3_bind_int64(stmt, 1, jobs); /* not all statements have these parameters */
        sqlite3_bind_int64(stmt, 2, fields);
        do {
            rc = sqlite3_step(stmt);
        } while (rc == SQLITE_ROW);
    }
    sqlite3_finalize(stmt);
    return rc == SQLITE_DONE ? SQLITE_OK : rc;
}

static int multiply(const char *path, int64_t jobs, int64_t fields, shear_error *err) {
    sqlite3 *db = NULL;
    int rc = sqlite3_open(path, &db);
    sqlite3_db_config(db, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, NULL);
    for (size_t i = 0; i < sizeof statements / sizeof statements[0] && rc == SQLITE_OK; i++)
        rc = run(db, statements[i], jobs, fields);
    const int code = rc == SQLITE_OK ? SHEAR_OK
                                     : shear_fail(err, SHEAR_E_IO, NULL, "%s: cannot be filled: %s",
                                                  path, sqlite3_errmsg(db));
    sqlite3_close(db);
    return code;
}

int store_fill(const char *path, int64_t jobs, int64_t fields, shear_error *err) {
    store *s = NULL;
    TRY(store_open(&s, path, NULL, 1, err));
    const int code = make_pattern(s, err);
    store_close(s);
    TRY(code);
    return multiply(path, jobs, fields, err);
}
