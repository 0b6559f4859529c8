/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forget a field: remove its rows in one operation that marks their contributions, then these one
 * by one, because there may be very many. */
#include "store/operation.h"

#include "base/cleanup.h"
#include "store/row.h"

#include <inttypes.h>
#include <string.h>

typedef struct forgotten_row {
    int64_t id; /* 0: there is none */
    int64_t jobs;
    char *digest;
} forgotten_row;

#define ROW(member) ROW_MEMBER(forgotten_row, member)
static const row_type forgotten_row_type = ROW_TYPE(forgotten_row, ROW(id), ROW(digest), ROW(jobs));

static void forgotten_row_deinit(forgotten_row *r) {
    row_deinit(&forgotten_row_type, r);
}

/* Replace *r by the next row of the name, by digest; id 0: there is none. */
static int next_row(store *s, const char *name, forgotten_row *r, shear_error *err) {
    CLEANUP(forgotten_row_deinit) forgotten_row before = *r;
    const char *after = before.digest != NULL ? before.digest : "";
    return row_get(QUERY(s, SQL_FIELD_ROWS, query_text(name), query_text(after)),
                   &forgotten_row_type, r, NULL, err);
}

/* Fail if unfinished jobs belong to the field with these settings (NULL: any), even if nothing was
 * counted with them yet. */
static int check_finished(store *s, const char *name, const char *digest, shear_error *err) {
    int64_t n = 0;
    const parameter field = query_text(name);
    query q = digest != NULL ? QUERY(s, SQL_FIELD_UNFINISHED, field, query_text(digest))
                             : QUERY(s, SQL_FIELD_PENDING, field);
    TRY(query_number(q, 0, &n, err));
    if (n == 0)
        return SHEAR_OK;
    return shear_fail(err, STORE_WRONG_STATE, "wait for them, or cancel them",
                      "%" PRId64 " unfinished jobs belong to field '%.*s'", n, STORE_FIELD_MAX,
                      name);
}

static int forget_row(store *s, const char *name, const forgotten_row *r, store_forgotten *out,
                      shear_error *err) {
    TRY(query_run(QUERY(s, SQL_FORGOTTEN_ADD, query_int(r->id), query_text(name)), err));
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

#define REMOVAL(member) ROW_MEMBER(store_removal, member)
static const row_type removal_type =
    ROW_TYPE(store_removal, REMOVAL(forgotten), REMOVAL(field), REMOVAL(contribution), REMOVAL(job),
             REMOVAL(kept), REMOVAL(catalog));

void store_removal_deinit(store_removal *removal) {
    row_deinit(&removal_type, removal);
}

int store_next_removal(store *s, store_removal *next, shear_error *err) {
    return row_get(query_on(s, SQL_FORGOTTEN_NEXT), &removal_type, next, NULL, err);
}

static int remove_contribution(store *s, const store_removal *removal, bool catalog_gone,
                               shear_error *err) {
    if (removal->contribution == 0)
        return query_run_id(s, SQL_FORGOTTEN_DROP, removal->forgotten, err);
    TRY(query_run_id(s, SQL_CONTRIBUTION_DROP, removal->contribution, err));
    if (!removal->kept)
        return SHEAR_OK;
    TRY(query_run_id(s, SQL_JOB_RETRACT, removal->job, err));
    if (removal->catalog == NULL || !catalog_gone)
        return SHEAR_OK;
    return query_run_id(s, SQL_CATALOG_GONE, removal->job, err);
}

int store_remove(store *s, const store_removal *removal, bool catalog_gone, shear_error *err) {
    return OPERATION(s, remove_contribution(s, removal, catalog_gone, err), err);
}
