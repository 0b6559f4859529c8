/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a whole field is taken back: its rows at once, in one operation that tells the contributions
 * to go; then these, one by one, for there may be very many. */
#include "store/operation.h"
#include "store/query.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct field_row {
    int64_t id; /* 0: there is none */
    int64_t jobs;
    char *digest;
} field_row;

/* The first row of the name whose digest is after that of *r. */
static int next_row(store *s, const char *name, field_row *r, shear_error *err) {
    bool row = false;
    query q = query_on(s, SQL_FIELD_ROWS);
    query_text(&q, name);
    query_text(&q, r->digest != NULL ? r->digest : "");
    int code = query_step(&q, &row, err);
    field_row next = {0};
    if (row) {
        next.id = query_get_int(&q);
        next.digest = query_get_text(&q);
        next.jobs = query_get_int(&q);
        code = query_got(&q, err);
    }
    query_end(&q);
    free(r->digest);
    *r = next;
    return code;
}

/* With these settings (NULL: any; also such as nothing was counted with so far). */
static int check_finished(store *s, const char *name, const char *digest, shear_error *err) {
    bool row = false;
    query q = query_on(s, digest != NULL ? SQL_FIELD_UNFINISHED : SQL_FIELD_PENDING);
    query_text(&q, name);
    if (digest != NULL) {
        query_text(&q, digest);
    }
    int code = query_step(&q, &row, err);
    const int64_t n = row ? query_get_int(&q) : 0;
    query_end(&q);
    return code == SHEAR_OK && n > 0
               ? shear_fail(err, STORE_WRONG_STATE, "wait for them, or cancel them",
                            "%" PRId64 " unfinished jobs belong to field '%.*s'", n,
                            STORE_FIELD_MAX, name)
               : code;
}

static int forget_row(store *s, const char *name, const field_row *r, store_forgotten *out,
                      shear_error *err) {
    query q = query_on(s, SQL_FORGOTTEN_ADD);
    query_int(&q, r->id);
    query_text(&q, name);
    int code = query_run(&q, err);
    if (code == SHEAR_OK) {
        out->last = sqlite3_last_insert_rowid(s->db);
        code = query_run_id(s, SQL_FIELD_DROP, r->id, err);
    }
    out->rows++;
    out->contributions += r->jobs;
    return code;
}

static int forget(store *s, const char *name, const char *wanted, store_forgotten *out,
                  shear_error *err) {
    field_row r = {0};
    int code = next_row(s, name, &r, err);
    while (code == SHEAR_OK && r.id != 0) {
        if (wanted == NULL || strcmp(wanted, r.digest) == 0) {
            code = check_finished(s, name, wanted, err);
            if (code == SHEAR_OK) {
                code = forget_row(s, name, &r, out, err);
            }
        }
        if (code == SHEAR_OK) {
            code = next_row(s, name, &r, err);
        }
    }
    free(r.digest);
    if (code == SHEAR_OK && out->rows == 0) {
        code = shear_fail(err, STORE_NOT_FOUND, "list the fields to see their names and settings",
                          "nothing was counted in a field '%.*s'%s", STORE_FIELD_MAX, name,
                          wanted != NULL ? " with these settings" : "");
    }
    return code;
}

int store_forget(store *s, const char *name, const char *settings_digest, store_forgotten *out,
                 shear_error *err) {
    *out = (store_forgotten){0};
    int code = operation_begin(s, err);
    if (code == SHEAR_OK) {
        code = operation_end(s, forget(s, name, settings_digest, out, err), err);
    }
    if (code != SHEAR_OK) {
        *out = (store_forgotten){0};
    }
    return code;
}

/* ---- what was counted in them ---- */

void store_removal_deinit(store_removal *l) {
    free(l->field);
    free(l->catalog);
    *l = (store_removal){0};
}

int store_next_removal(store *s, store_removal *next, shear_error *err) {
    bool row = false;
    *next = (store_removal){0};
    query q = query_on(s, SQL_FORGOTTEN_NEXT);
    int code = query_step(&q, &row, err);
    if (row) {
        next->forgotten = query_get_int(&q);
        next->field = query_get_text(&q);
        next->contribution = query_get_int(&q);
        next->job = query_get_int(&q);
        next->kept = query_get_int(&q) != 0;
        next->catalog = query_get_text(&q);
        code = query_got(&q, err);
    }
    query_end(&q);
    if (code != SHEAR_OK) {
        store_removal_deinit(next);
    }
    return code;
}

static int leave(store *s, const store_removal *l, bool catalog_gone, shear_error *err) {
    if (l->contribution == 0) {
        return query_run_id(s, SQL_FORGOTTEN_DROP, l->forgotten, err);
    }
    int code = query_run_id(s, SQL_CONTRIBUTION_DROP, l->contribution, err);
    if (code == SHEAR_OK && l->kept) {
        code = query_run_id(s, SQL_JOB_RETRACT, l->job, err);
    }
    return code == SHEAR_OK && l->catalog != NULL && catalog_gone
               ? query_run_id(s, SQL_CATALOG_GONE, l->job, err)
               : code;
}

int store_remove(store *s, const store_removal *l, bool catalog_gone, shear_error *err) {
    const int code = operation_begin(s, err);
    return code == SHEAR_OK ? operation_end(s, leave(s, l, catalog_gone, err), err) : code;
}
