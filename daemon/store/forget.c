/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forget a field: remove its rows in one operation that marks their contributions, then these one
 * by one, because there may be very many. */
#include "store/operation.h"

#include "base/cleanup.h"
#include "store/query.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct forgotten_row {
    int64_t id; /* 0: there is none */
    int64_t jobs;
    char *digest;
} forgotten_row;

static void forgotten_row_deinit(forgotten_row *r) {
    free(r->digest);
    *r = (forgotten_row){0};
}

/* Replace *r by the next row of the name, by digest; id 0: there is none. */
static int next_row(store *s, const char *name, forgotten_row *r, shear_error *err) {
    bool row = false;
    CLEANUP(forgotten_row_deinit) forgotten_row before = *r;
    *r = (forgotten_row){0};
    CLEANUP(query_end) query q = query_on(s, SQL_FIELD_ROWS);
    query_text(&q, name);
    query_text(&q, before.digest != NULL ? before.digest : "");
    const int code = query_step(&q, &row, err);
    if (!row)
        return code;
    r->id = query_get_int(&q);
    r->digest = query_get_text(&q);
    r->jobs = query_get_int(&q);
    return query_got(&q, err);
}

/* Fail if unfinished jobs belong to the field with these settings (NULL: any), even if nothing was
 * counted with them yet. */
static int check_finished(store *s, const char *name, const char *digest, shear_error *err) {
    int64_t n = 0;
    query q = query_on(s, digest != NULL ? SQL_FIELD_UNFINISHED : SQL_FIELD_PENDING);
    query_text(&q, name);
    if (digest != NULL)
        query_text(&q, digest);
    const int code = query_number(&q, 0, &n, err);
    if (code != SHEAR_OK || n == 0)
        return code;
    return shear_fail(err, STORE_WRONG_STATE, "wait for them, or cancel them",
                      "%" PRId64 " unfinished jobs belong to field '%.*s'", n, STORE_FIELD_MAX,
                      name);
}

static int forget_row(store *s, const char *name, const forgotten_row *r, store_forgotten *out,
                      shear_error *err) {
    query q = query_on(s, SQL_FORGOTTEN_ADD);
    query_int(&q, r->id);
    query_text(&q, name);
    TRY(query_run(&q, err));
    out->last = sqlite3_last_insert_rowid(s->db);
    out->rows++;
    out->contributions += r->jobs;
    return query_run_id(s, SQL_FIELD_DROP, r->id, err);
}

static int forget(store *s, const char *name, const char *wanted, store_forgotten *out,
                  shear_error *err) {
    CLEANUP(forgotten_row_deinit) forgotten_row r = {0};
    for (;;) {
        TRY(next_row(s, name, &r, err));
        if (r.id == 0)
            break;
        if (wanted != NULL && strcmp(wanted, r.digest) != 0)
            continue;
        TRY(check_finished(s, name, wanted, err));
        TRY(forget_row(s, name, &r, out, err));
    }
    if (out->rows == 0) {
        return shear_fail(err, STORE_NOT_FOUND, "list the fields to see their names and settings",
                          "nothing was counted in a field '%.*s'%s", STORE_FIELD_MAX, name,
                          wanted != NULL ? " with these settings" : "");
    }
    return SHEAR_OK;
}

int store_forget(store *s, const char *name, const char *settings_digest, store_forgotten *out,
                 shear_error *err) {
    *out = (store_forgotten){0};
    const int code = OPERATION(s, forget(s, name, settings_digest, out, err), err);
    if (code != SHEAR_OK)
        *out = (store_forgotten){0};
    return code;
}

/* ---- contributions of forgotten fields ---- */

void store_removal_deinit(store_removal *removal) {
    free(removal->field);
    free(removal->catalog);
    *removal = (store_removal){0};
}

int store_next_removal(store *s, store_removal *next, shear_error *err) {
    bool row = false;
    *next = (store_removal){0};
    CLEANUP(query_end) query q = query_on(s, SQL_FORGOTTEN_NEXT);
    int code = query_step(&q, &row, err);
    if (!row)
        return code;
    next->forgotten = query_get_int(&q);
    next->field = query_get_text(&q);
    next->contribution = query_get_int(&q);
    next->job = query_get_int(&q);
    next->kept = query_get_int(&q) != 0;
    next->catalog = query_get_text(&q);
    code = query_got(&q, err);
    if (code != SHEAR_OK)
        store_removal_deinit(next);
    return code;
}

static int remove_contribution(store *s, const store_removal *removal, bool catalog_gone,
                               shear_error *err) {
    if (removal->contribution == 0)
        return query_run_id(s, SQL_FORGOTTEN_DROP, removal->forgotten, err);
    int code = query_run_id(s, SQL_CONTRIBUTION_DROP, removal->contribution, err);
    if (code != SHEAR_OK || !removal->kept)
        return code;
    code = query_run_id(s, SQL_JOB_RETRACT, removal->job, err);
    if (code != SHEAR_OK || removal->catalog == NULL || !catalog_gone)
        return code;
    return query_run_id(s, SQL_CATALOG_GONE, removal->job, err);
}

int store_remove(store *s, const store_removal *removal, bool catalog_gone, shear_error *err) {
    return OPERATION(s, remove_contribution(s, removal, catalog_gone, err), err);
}
