/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The disk fails within a group whose caller goes on: all of the group is durable, or nothing. */
#include "store/database.h"
#include "store_actions.h"
#include "store_audit.h"
#include "store_faults.h"
#include "store_test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STUBBORN = 24 };

/* Submits of several pages each, so that the log is written before the commit; bit i tells that the
 * i-th was acknowledged. What fails, fails with `failure`. Returns what the commit said. */
static int stubborn_group(store *s, int failure, unsigned *acknowledged) {
    static char source[9000];
    shear_error err = {0};
    *acknowledged = 0;
    memset(source, 'x', sizeof source - 1);
    if (store_begin(s, &err) != SHEAR_OK)
        return failure;
    for (unsigned i = 0; i < STUBBORN; i++) {
        char key[8];
        int64_t id = 0;
        bool known = false;
        snprintf(key, sizeof key, "s%u", i);
        const store_spec spec = {
            .source = source, .settings = "{}", .settings_digest = "d0", .key = key};
        const int code = store_submit(s, &spec, 100, &id, &known, &err);
        assert_true(code == SHEAR_OK || code == failure);
        *acknowledged |= code == SHEAR_OK ? 1u << i : 0;
    }
    return store_commit(s, &err);
}

static unsigned keys_there(store *s) {
    sqlite3_stmt *stmt = NULL;
    unsigned found = 0;
    sqlite3_prepare_v2(s->db,
                       "SELECT substr(idempotency_key, 2) FROM jobs"
                       " WHERE idempotency_key IS NOT NULL",
                       -1, &stmt, NULL);
    while (sqlite3_step(stmt) == SQLITE_ROW)
        found |= 1u << sqlite3_column_int(stmt, 0);
    sqlite3_finalize(stmt);
    return found;
}

static void a_group_is_all_or_nothing(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    bool fired = true;
    int lost = 0; /* groups that were given up in the middle */
    sums_2 = fx_sums(2);
    keep_empty(f);
    for (int n = 1; fired; n += 7) {
        for (enum store_vfs_fault fault = VFS_IO_ERROR; fault <= VFS_FULL; fault++) {
            unsigned acknowledged = 0;
            begin(f, BUSY);
            store_vfs_arm(fault, n);
            const int code = stubborn_group(f->s, meaning_of(fault), &acknowledged);
            assert_true(code == SHEAR_OK || code == meaning_of(fault));
            fired = store_vfs_fired();
            lost += code != SHEAR_OK && acknowledged != (1u << STUBBORN) - 1;
            store_vfs_arm(VFS_SOUND, 0);
            assert_int_equal(keys_there(f->s), code == SHEAR_OK ? acknowledged : 0);
            restart(f);
            const unsigned there = keys_there(f->s);
            assert_true(there == acknowledged || (code != SHEAR_OK && there == 0));
            FX_OK(store_check(f->s, &err));
            fx_close(f);
        }
    }
    assert_true(lost > 5);
    free(sums_2);
    fx_open(f);
}

/* A failing read, too, makes SQLite give up a transaction. The group is lost then, whoever read:
 * nothing of it may stay, also not what is added afterwards. */
static void a_read_can_lose_a_group(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_totals totals;
    store_field_page page;
    int64_t id = 0;
    bool known = false;
    const store_field_filter every = {0};
    fx_submit(f, "a");
    const store_spec spec = fx_spec(f, "a");
    FX_OK(store_begin(f->s, &err));
    fx_submit(f, "b");
    assert_int_equal(sqlite3_exec(f->s->db, "PRAGMA shrink_memory", NULL, NULL, NULL), SQLITE_OK);
    store_vfs_arm(VFS_READ_ERROR, 1);
    FX_CODE(SHEAR_E_IO, store_fields(f->s, &every, 10, &page, &err));
    assert_true(store_vfs_fired());
    store_vfs_arm(VFS_SOUND, 0);
    FX_CODE(SHEAR_E_IO, store_submit(f->s, &spec, 100, &id, &known, &err));
    FX_OK(store_fields(f->s, &every, 10, &page, &err)); /* reading goes on */
    store_field_page_deinit(&page);
    FX_CODE(SHEAR_E_IO, store_commit(f->s, &err));
    FX_OK(store_total(f->s, &totals, &err));
    assert_int_equal(totals.submitted, 1);
    fx_submit(f, "c"); /* and so does all the rest */

    FX_OK(store_begin(f->s, &err)); /* nothing follows the failing read */
    fx_submit(f, "b");
    assert_int_equal(sqlite3_exec(f->s->db, "PRAGMA shrink_memory", NULL, NULL, NULL), SQLITE_OK);
    store_vfs_arm(VFS_READ_ERROR, 1);
    FX_CODE(SHEAR_E_IO, store_fields(f->s, &every, 10, &page, &err));
    store_vfs_arm(VFS_SOUND, 0);
    FX_CODE(SHEAR_E_IO, store_commit(f->s, &err));
    FX_OK(store_total(f->s, &totals, &err));
    assert_int_equal(totals.submitted, 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_group_is_all_or_nothing),
        STORE_TEST(a_read_can_lose_a_group),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
