/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/operation.h"

#include "store/query.h"

static int run(store *s, enum sql which, shear_error *err) {
    return query_run(query_on(s, which), err);
}

static bool in_transaction(const store *s) {
    return sqlite3_get_autocommit(s->db) == 0;
}

static void roll_back(store *s) {
    if (in_transaction(s))
        run(s, SQL_ROLLBACK, NULL);
}

/* SQLite rolls back a whole transaction after some errors, even those of a query between two
 * operations. */
static bool is_lost(store *s) {
    s->group_lost = s->group_lost || !in_transaction(s);
    return s->group_lost;
}

static int fail_lost(const store *s, shear_error *err) {
    const bool full = s->lost_code == SHEAR_E_FULL;
    return shear_fail(err, s->lost_code,
                      full ? "make room on the file system of the state directory"
                           : "repeat the operation",
                      "%s: the group of changes was given up after %s", s->path,
                      full ? "the disk was full" : "an error of the disk");
}

int operation_begin(store *s, shear_error *err) {
    if (!s->in_group)
        return run(s, SQL_BEGIN, err);
    return is_lost(s) ? fail_lost(s, err) : run(s, SQL_SAVEPOINT, err);
}

static int commit(store *s, shear_error *err) {
    const int code = run(s, SQL_COMMIT, err);
    if (code != SHEAR_OK)
        roll_back(s);
    return code;
}

static void undo_in_group(store *s, int code) {
    s->lost_code = code == SHEAR_E_FULL && !s->group_lost ? SHEAR_E_FULL : s->lost_code;
    if (is_lost(s) || run(s, SQL_ROLLBACK_TO, NULL) != SHEAR_OK ||
        run(s, SQL_RELEASE, NULL) != SHEAR_OK) {
        roll_back(s);
        s->group_lost = true;
    }
}

int operation_end(store *s, int code, shear_error *err) {
    if (!s->in_group && code != SHEAR_OK) {
        roll_back(s);
        return code;
    }
    if (!s->in_group)
        return commit(s, err);
    code = code != SHEAR_OK ? code : run(s, SQL_RELEASE, err);
    if (code != SHEAR_OK)
        undo_in_group(s, code);
    return code;
}

int store_begin(store *s, shear_error *err) {
    if (s->in_group) {
        return shear_fail(err, SHEAR_E_INTERNAL, "this is a bug: please report it",
                          "%s: a group of changes within another", s->path);
    }
    const int code = run(s, SQL_BEGIN, err);
    s->in_group = code == SHEAR_OK;
    s->group_lost = false;
    s->lost_code = SHEAR_E_IO;
    return code;
}

int store_commit(store *s, shear_error *err) {
    if (!s->in_group) {
        return shear_fail(err, SHEAR_E_INTERNAL, "this is a bug: please report it",
                          "%s: no group of changes is open", s->path);
    }
    s->in_group = false;
    return is_lost(s) ? fail_lost(s, err) : commit(s, err);
}

void store_rollback(store *s) {
    if (s->in_group) {
        s->in_group = false;
        roll_back(s);
    }
}
