/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Is the database sound, and does what it says agree? These read everything: not for every day. */
#include "store/query.h"
#include "store/sums_text.h"

#include "shear/sums.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char damaged[] = "stop the service and restore the database from a copy";

static int finish_check(store *s, sqlite3_stmt *stmt, int rc, const char *doing, shear_error *err) {
    const int code = rc == SQLITE_DONE ? SHEAR_OK : database_fail(s->db, s->path, rc, doing, err);
    sqlite3_finalize(stmt);
    return code;
}

int store_check(store *s, shear_error *err) {
    static const char doing[] = "checking the database's pages";
    sqlite3_stmt *stmt = NULL;
    int rc = sqlite3_prepare_v2(s->db, "PRAGMA quick_check(1)", -1, &stmt, NULL);
    if (rc == SQLITE_OK) {
        rc = sqlite3_step(stmt);
    }
    if (rc == SQLITE_ROW) {
        const char *verdict = (const char *)sqlite3_column_text(stmt, 0);
        if (verdict == NULL || strcmp(verdict, "ok") != 0) {
            shear_fail(err, SHEAR_E_FORMAT, damaged, "%s: is damaged: %s", s->path,
                       verdict != NULL ? verdict : "no verdict");
            sqlite3_finalize(stmt);
            return SHEAR_E_FORMAT;
        }
        rc = sqlite3_step(stmt);
    }
    return finish_check(s, stmt, rc, doing, err);
}

/* Each finds what must not be: its first column is a number that tells where. */
static const char *const contradictions[][2] = {
    {"PRAGMA foreign_key_check", "a row refers to one that is not there"},
    {"SELECT c.state FROM counts c"
     " WHERE c.n <> (SELECT count(*) FROM jobs j WHERE j.state = c.state)",
     "the number of jobs in a state is wrong"},
    {"SELECT id FROM jobs WHERE (state = 3) <> (outcome <> 0)"
     " OR (state >= 3) <> (finished_ms <> 0) OR (outcome = 2) <> (duplicate_of <> 0)",
     "a job's state and outcome contradict each other"},
    {"SELECT j.id FROM jobs j LEFT JOIN contributions c ON c.job = j.id"
     " WHERE (j.outcome = 1) <> (c.job IS NOT NULL)",
     "a counted job has no contribution, or another one has"},
    {"SELECT id FROM contributions WHERE field NOT IN (SELECT id FROM fields)"
     " AND field NOT IN (SELECT field FROM forgotten)",
     "a contribution has no field"},
    {"SELECT field FROM forgotten JOIN fields f ON f.id = field", "a forgotten field is there"},
    {"SELECT j.id FROM jobs j JOIN contributions c ON c.job = j.id JOIN fields f ON f.id = c.field"
     " WHERE j.field <> f.name OR j.settings <> f.settings OR j.content <> c.content"
     " OR j.n_stamps <> c.n_stamps OR j.n_used <> c.n_used",
     "a job and its contribution differ"},
    {"SELECT id FROM jobs j WHERE (state = 1) <> ((SELECT count(*) FROM attempts a"
     " WHERE a.job = j.id AND a.ending = 0 AND a.number = j.attempt) = 1)",
     "a job runs without an open attempt, or the other way round"},
    {"SELECT job FROM checkpoints JOIN jobs ON id = job WHERE state IN (3, 5)",
     "a checkpoint is left of a job that is over"},
    {"SELECT id FROM fields f WHERE (jobs, n_stamps, n_used, elapsed_us) IS NOT (SELECT count(*),"
     " sum(n_stamps), sum(n_used), sum(elapsed_us) FROM contributions WHERE field = f.id)",
     "a field's numbers are not its contributions'"},
    {"SELECT 1 FROM totals WHERE counted <> retracted + (SELECT count(*) FROM contributions)"
     " OR submitted <> retired + (SELECT count(*) FROM jobs)"
     " OR fields <> (SELECT count(*) FROM fields)",
     "the totals are wrong"},
    {"SELECT 1 FROM settings t WHERE uses <> (SELECT count(*) FROM jobs WHERE settings = t.digest)"
     " + (SELECT count(*) FROM fields WHERE settings = t.digest)",
     "the uses of a set of settings are wrong"},
    {"SELECT contribution FROM contribution_terms JOIN contributions c ON c.id = contribution"
     " GROUP BY contribution HAVING sum(length(bytes) / stamp_bytes) <> c.n_used"
     " OR max(length(bytes) % stamp_bytes) <> 0",
     "a contribution has not the terms of its stamps"},
    {"SELECT id FROM credentials c"
     " WHERE uses <> (SELECT count(*) FROM jobs WHERE credentials = c.id)",
     "the uses of credentials are wrong"},
    {"SELECT j.id FROM jobs j LEFT JOIN credentials c ON c.id = j.credentials"
     " WHERE j.credentials IS NOT NULL AND c.id IS NULL",
     "a job's credentials are not there"},
};

static int find_contradiction(store *s, const char *sql, const char *meaning, shear_error *err) {
    sqlite3_stmt *stmt = NULL;
    int rc = sqlite3_prepare_v2(s->db, sql, -1, &stmt, NULL);
    if (rc == SQLITE_OK) {
        rc = sqlite3_step(stmt);
    }
    if (rc == SQLITE_ROW) {
        const char *where = (const char *)sqlite3_column_text(stmt, 0);
        shear_fail(err, SHEAR_E_FORMAT, damaged, "%s: %s (%s)", s->path, meaning,
                   where != NULL ? where : "null");
        sqlite3_finalize(stmt);
        return SHEAR_E_FORMAT;
    }
    return finish_check(s, stmt, rc, meaning, err);
}

static int parse_packed(const char *packed, shear_field_sums **sums, shear_error *err) {
    char *text = NULL;
    *sums = NULL;
    int code = sums_unpack(packed, &text, err);
    if (code == SHEAR_OK) {
        code = shear_field_sums_parse(sums, text, err);
    }
    free(text);
    return code;
}

/* Does the row (sums, top_size, top_stamp) tell the stamp that counts most of its sums? */
static bool top_agrees(sqlite3_stmt *row, const shear_field_sums *sums) {
    const shear_influence top = shear_field_sums_top(sums);
    return sqlite3_column_type(row, 1) == SQLITE_NULL
               ? isnan(top.size)
               : sqlite3_column_double(row, 1) == top.size &&
                     sqlite3_column_int64(row, 2) == top.stamp;
}

/* sums += those of the row. */
static int add_row(store *s, sqlite3_stmt *row, shear_field_sums *sums, shear_error *err) {
    shear_field_sums *one = NULL;
    int code = parse_packed((const char *)sqlite3_column_text(row, 0), &one, err);
    if (code == SHEAR_OK && !top_agrees(row, one)) {
        code = shear_fail(err, SHEAR_E_FORMAT, damaged,
                          "%s: the stamp that counts most is not that of the sums", s->path);
    }
    if (code == SHEAR_OK) {
        shear_field_sums_join(sums, one);
    }
    shear_field_sums_free(one);
    return code;
}

/* The exact join of a field's contributions, as text. */
static int join_contributions(store *s, int64_t field, char **text, shear_error *err) {
    static const char sql[] =
        "SELECT sums, top_size, top_stamp FROM contributions WHERE field = ?1";
    sqlite3_stmt *stmt = NULL;
    shear_field_sums *sums = NULL;
    *text = NULL;
    int code = shear_field_sums_new(&sums, err);
    int rc = sqlite3_prepare_v2(s->db, sql, -1, &stmt, NULL);
    if (rc == SQLITE_OK) {
        sqlite3_bind_int64(stmt, 1, field);
        rc = sqlite3_step(stmt);
    }
    while (rc == SQLITE_ROW && code == SHEAR_OK) {
        code = add_row(s, stmt, sums, err);
        rc = sqlite3_step(stmt);
    }
    if (code == SHEAR_OK && rc != SQLITE_DONE) {
        code = database_fail(s->db, s->path, rc, sql, err);
    }
    if (code == SHEAR_OK) {
        code = shear_field_sums_format(sums, text, err);
    }
    sqlite3_finalize(stmt);
    shear_field_sums_free(sums);
    return code;
}

/* The packed sums as text of the present version: what was counted once may be of an older one. */
static int read_packed(const char *packed, char **text, shear_error *err) {
    shear_field_sums *sums = NULL;
    *text = NULL;
    int code = parse_packed(packed, &sums, err);
    if (code == SHEAR_OK) {
        code = shear_field_sums_format(sums, text, err);
    }
    shear_field_sums_free(sums);
    return code;
}

static int audit_field(store *s, int64_t field, const char *name, const char *packed,
                       shear_error *err) {
    char *joined = NULL;
    char *kept = NULL;
    int code = join_contributions(s, field, &joined, err);
    if (code == SHEAR_OK) {
        code = read_packed(packed, &kept, err);
    }
    if (code == SHEAR_OK && strcmp(joined, kept) != 0) {
        code = shear_fail(err, SHEAR_E_FORMAT, damaged,
                          "%s: the sums of field '%s' are not those of its contributions", s->path,
                          name);
    }
    free(joined);
    free(kept);
    return code;
}

static int audit_fields(store *s, shear_error *err) {
    static const char sql[] = "SELECT id, name, sums FROM fields";
    sqlite3_stmt *stmt = NULL;
    int code = SHEAR_OK;
    int rc = sqlite3_prepare_v2(s->db, sql, -1, &stmt, NULL);
    if (rc == SQLITE_OK) {
        rc = sqlite3_step(stmt);
    }
    while (rc == SQLITE_ROW && code == SHEAR_OK) {
        code = audit_field(s, sqlite3_column_int64(stmt, 0),
                           (const char *)sqlite3_column_text(stmt, 1),
                           (const char *)sqlite3_column_text(stmt, 2), err);
        rc = sqlite3_step(stmt);
    }
    if (code != SHEAR_OK) {
        sqlite3_finalize(stmt);
        return code;
    }
    return finish_check(s, stmt, rc, sql, err);
}

int store_audit(store *s, shear_error *err) {
    const size_t n = sizeof contradictions / sizeof contradictions[0];
    int code = SHEAR_OK;
    for (size_t i = 0; i < n && code == SHEAR_OK; i++) {
        code = find_contradiction(s, contradictions[i][0], contradictions[i][1], err);
    }
    return code == SHEAR_OK ? audit_fields(s, err) : code;
}
