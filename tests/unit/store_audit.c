/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store_audit.h"

#include "base/cleanup.h"
#include "store/query.h"
#include "store/sums_text.h"

#include <math.h>
#include <string.h>

static const char damaged[] = "stop the service and restore the database from a copy";

/* A query with a statement that is not in sql.h, for one use. */
static query query_once(store *s, const char *sql, const char *doing) {
    query q = {.s = s, .doing = doing};
    q.rc = sqlite3_prepare_v2(s->db, sql, -1, &q.stmt, NULL);
    return q;
}

static void query_finalize(query *q) {
    sqlite3_finalize(q->stmt);
}

int store_check(store *s, shear_error *err) {
    bool row = false;
    CLEANUP(query_finalize)
    query q = query_once(s, "PRAGMA quick_check(1)", "checking the database's pages");
    const int code = query_step(&q, &row, err);
    if (!row)
        return code;
    const char *answer = query_peek_text(&q);
    if (answer == NULL || strcmp(answer, "ok") != 0) {
        return shear_fail(err, SHEAR_E_FORMAT, damaged, "%s: is damaged: %s", s->path,
                          answer != NULL ? answer : "no answer");
    }
    return query_step(&q, &row, err);
}

/* Queries for rows that must not exist; the first column says which one it is. */
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
    bool row = false;
    CLEANUP(query_finalize) query q = query_once(s, sql, meaning);
    const int code = query_step(&q, &row, err);
    if (!row)
        return code;
    const char *where = query_peek_text(&q);
    return shear_fail(err, SHEAR_E_FORMAT, damaged, "%s: %s (%s)", s->path, meaning,
                      where != NULL ? where : "null");
}

/* Add the sums of the row (sums, top_size, top_stamp), after checking that its stamp is the one
 * that counts most in these sums. */
static int add_row(store *s, query *q, shear_field_sums *sums, shear_error *err) {
    CLEANUP(shear_field_sums_release) shear_field_sums *one = NULL;
    TRY(sums_parse_packed(&one, query_peek_text(q), err));
    const double size = query_get_real(q);
    const int64_t stamp = query_get_int(q);
    const shear_influence top = shear_field_sums_top(one);
    const bool agrees = isnan(size) ? isnan(top.size) : size == top.size && stamp == top.stamp;
    if (!agrees) {
        return shear_fail(err, SHEAR_E_FORMAT, damaged,
                          "%s: the stamp that counts most is not that of the sums", s->path);
    }
    shear_field_sums_join(sums, one);
    return SHEAR_OK;
}

/* Return the exact join of a field's contributions, as text, malloc'd. */
static int join_contributions(store *s, int64_t field, char **text, shear_error *err) {
    static const char sql[] =
        "SELECT sums, top_size, top_stamp FROM contributions WHERE field = ?1";
    CLEANUP(shear_field_sums_release) shear_field_sums *sums = NULL;
    bool row = false;
    TRY(shear_field_sums_new(&sums, err));
    CLEANUP(query_finalize) query q = query_once(s, sql, sql);
    sqlite3_bind_int64(q.stmt, 1, field);
    for (;;) {
        TRY(query_step(&q, &row, err));
        if (!row)
            return shear_field_sums_format(sums, text, err);
        TRY(add_row(s, &q, sums, err));
    }
}

/* Convert packed sums to text of the present format; they may have been stored in an older one. */
static int read_packed(const char *packed, char **text, shear_error *err) {
    CLEANUP(shear_field_sums_release) shear_field_sums *sums = NULL;
    TRY(sums_parse_packed(&sums, packed, err));
    return shear_field_sums_format(sums, text, err);
}

static int audit_field(store *s, int64_t field, const char *name, const char *packed,
                       shear_error *err) {
    CLEANUP(release_free) char *joined = NULL;
    CLEANUP(release_free) char *kept = NULL;
    TRY(join_contributions(s, field, &joined, err));
    TRY(read_packed(packed, &kept, err));
    if (strcmp(joined, kept) != 0) {
        return shear_fail(err, SHEAR_E_FORMAT, damaged,
                          "%s: the sums of field '%s' are not those of its contributions", s->path,
                          name);
    }
    return SHEAR_OK;
}

static int audit_fields(store *s, shear_error *err) {
    static const char sql[] = "SELECT id, name, sums FROM fields";
    bool row = false;
    CLEANUP(query_finalize) query q = query_once(s, sql, sql);
    for (;;) {
        int code = query_step(&q, &row, err);
        if (!row)
            return code;
        const int64_t id = query_get_int(&q);
        const char *name = query_peek_text(&q);
        TRY(audit_field(s, id, name, query_peek_text(&q), err));
    }
}

int store_audit(store *s, shear_error *err) {
    const size_t n = sizeof contradictions / sizeof contradictions[0];
    for (size_t i = 0; i < n; i++)
        TRY(find_contradiction(s, contradictions[i][0], contradictions[i][1], err));
    return audit_fields(s, err);
}
