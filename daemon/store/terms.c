/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/terms.h"

#include "base/cleanup.h"
#include "store/field_row.h"
#include "store/operation.h"
#include "store/query.h"

#include <inttypes.h>
#include <string.h>

/* Size of a row of the database, far below SQLite's limit. */
enum { PART_STAMPS = 1 << 14, PART_BYTES = PART_STAMPS * SHEAR_SYMMETRY_BYTES };
enum { OLD_STAMP_BYTES = 48 };

CLEANUP_DEFINE(shear_symmetry, shear_symmetry_free)

int terms_check(const unsigned char *bytes, size_t size, shear_error *err) {
    CLEANUP(shear_symmetry_release) shear_symmetry *terms = NULL;
    if (bytes == NULL)
        return SHEAR_OK;
    TRY(shear_symmetry_new(&terms, err));
    const int code = shear_symmetry_add_bytes(terms, bytes, size, err);
    return code != SHEAR_E_FORMAT
               ? code
               : shear_fail(err, SHEAR_E_INTERNAL, "this is a bug: please report it",
                            "%zu bytes are no terms of stamps", size);
}

/* Drop the checkpoint's terms from from_block on; *end is the block before which the rest ends. */
static int cut(store *s, int64_t job, int64_t from_block, int64_t *end, shear_error *err) {
    TRY(query_run(QUERY(s, SQL_CHECKPOINT_TERMS_CUT, query_int(job), query_int(from_block)), err));
    return query_number(QUERY(s, SQL_CHECKPOINT_TERMS_END, query_int(job)), 0, end, err);
}

int terms_add_checkpoint(store *s, int64_t job, const store_progress *p, shear_error *err) {
    int64_t end = 0;
    OPERATION_ASSERT_OPEN(s);
    TRY(cut(s, job, p->from_block, &end, err));
    if (end != p->from_block) {
        return shear_fail(err, STORE_WRONG_STATE, NULL,
                          "job %" PRId64 ": terms up to block %" PRId64
                          " are kept, and those that follow begin at %" PRId64,
                          job, end, p->from_block);
    }
    if (p->next_block == p->from_block)
        return SHEAR_OK;
    return query_run(QUERY(s, SQL_CHECKPOINT_TERMS_ADD, query_int(job), query_int(p->next_block),
                           query_blob(p->terms, p->terms_size)),
                     err);
}

int terms_add_contribution(store *s, const unsigned char *bytes, size_t size, shear_error *err) {
    const int64_t contribution = sqlite3_last_insert_rowid(s->db);
    OPERATION_ASSERT_OPEN(s);
    int64_t part = 0;
    size_t at = 0;
    do {
        const size_t n = size - at < PART_BYTES ? size - at : PART_BYTES;
        TRY(query_run(QUERY(s, SQL_TERMS_ADD, query_int(contribution), query_int(part),
                            query_blob(bytes + at, n), query_int(SHEAR_SYMMETRY_BYTES)),
                      err));
        part++;
        at += PART_BYTES;
    } while (at < size);
    return SHEAR_OK;
}

/* Add terms as version 0.1 stored them: without the last number, which is 0. */
static int add_old(const unsigned char *bytes, size_t size, shear_symmetry *terms,
                   shear_error *err) {
    unsigned char stamp[SHEAR_SYMMETRY_BYTES] = {0};
    if (size % OLD_STAMP_BYTES != 0)
        return SHEAR_E_FORMAT;
    for (size_t at = 0; at < size; at += OLD_STAMP_BYTES) {
        memcpy(stamp, bytes + at, OLD_STAMP_BYTES);
        TRY(shear_symmetry_add_bytes(terms, stamp, sizeof stamp, err));
    }
    return SHEAR_OK;
}

static int add_part(query *q, shear_symmetry *terms, shear_error *err) {
    size_t size = 0;
    const unsigned char *bytes = query_get_blob(q, &size);
    return query_get_int(q) == OLD_STAMP_BYTES ? add_old(bytes, size, terms, err)
                                               : shear_symmetry_add_bytes(terms, bytes, size, err);
}

static int add_rows(query *q, shear_symmetry *terms, shear_error *err) {
    for (;;) {
        bool row = false;
        int code = query_step(q, &row, err);
        if (!row)
            return code;
        TRY(add_part(q, terms, err));
    }
}

/* Add all rows of a query that returns blobs and the size of a stamp in them. After an error
 * `terms` is unchanged. */
static int read_all(query *q, shear_symmetry *terms, shear_error *err) {
    const size_t before = shear_symmetry_count(terms);
    const int code = add_rows(q, terms, err);
    query_end(q);
    if (code != SHEAR_OK)
        shear_symmetry_truncate(terms, before);
    return code;
}

int store_checkpoint_load_terms(store *s, int64_t id, shear_symmetry *terms, shear_error *err) {
    /* schema version 6 has dropped terms of another size */
    query q = QUERY(s, SQL_CHECKPOINT_TERMS, query_int(id), query_int(SHEAR_SYMMETRY_BYTES));
    return read_all(&q, terms, err);
}

int store_field_terms(store *s, const char *name, const char *settings_digest,
                      shear_symmetry *terms, shear_error *err) {
    int64_t field = 0;
    TRY(field_row_find(s, name, settings_digest, &field, err));
    query q = QUERY(s, SQL_FIELD_TERMS, query_int(field));
    return read_all(&q, terms, err);
}
