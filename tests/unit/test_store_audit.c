/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The audit finds damage, and every kind of contradiction. */
#include "store/database.h"
#include "store_audit.h"
#include "store_test.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void run_sql(fixture *f, const char *sql) {
    char *message = NULL;
    if (sqlite3_exec(f->s->db, sql, NULL, NULL, &message) != SQLITE_OK)
        fail_msg("%s: %s", sql, message);
}

static void a_good_one_passes(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    fx_done(f, "a", "1", 1);
    fx_done(f, "a", "1", 1);
    fx_done(f, "a", "2", 2);
    fx_done(f, "b", "2", 2);
    FX_OK(store_check(f->s, &err));
    FX_OK(store_audit(f->s, &err));
}

static void contradictions_are_found(void **state) {
    static const char *const lies[] = {
        "UPDATE counts SET n = n + 1 WHERE state = 3",
        "UPDATE jobs SET outcome = 0 WHERE id = 1",
        "UPDATE jobs SET finished_ms = 0 WHERE id = 1",
        "UPDATE jobs SET duplicate_of = 9 WHERE id = 1",
        "DELETE FROM contributions WHERE job = 1",
        "UPDATE contributions SET job = 2 WHERE job = 1",
        "UPDATE contributions SET content = 'other' WHERE job = 1",
        "UPDATE contributions SET n_stamps = 17 WHERE job = 1",
        ("UPDATE contributions SET sums = (SELECT sums FROM contributions WHERE job = 3) WHERE job "
         "= 1"),
        "UPDATE fields SET sums = (SELECT sums FROM contributions WHERE job = 3)",
        "UPDATE fields SET sums = 'shear-sums 2'",
        "UPDATE contributions SET top_size = NULL WHERE job = 3",
        "UPDATE contributions SET top_size = top_size / 2 WHERE job = 3",
        "UPDATE contributions SET top_stamp = top_stamp + 1 WHERE job = 3",
        "UPDATE fields SET jobs = jobs + 1",
        "UPDATE fields SET n_used = n_used - 1",
        "UPDATE fields SET name = 'other'",
        "UPDATE attempts SET ending = 0 WHERE job = 1",
        "UPDATE attempts SET ending = 1 WHERE job = 4",
        "DELETE FROM attempts WHERE job = 4",
        "INSERT INTO checkpoints VALUES (1, 0, 'x')",
        "UPDATE totals SET counted = 0",
        "UPDATE totals SET submitted = submitted + 1",
        "UPDATE totals SET fields = fields + 1",
        "UPDATE settings SET uses = uses + 1",
        "PRAGMA foreign_keys = OFF; INSERT INTO checkpoints VALUES (99, 0, 'x')",
        "DELETE FROM fields",
        "INSERT INTO forgotten(field, name) SELECT id, name FROM fields",
    };
    fixture *f = *state;
    shear_error err = {0};
    fx_done(f, "a", "1", 1);
    fx_done(f, "a", "1", 1);
    fx_done(f, "a", "3", 3);
    fx_running(f, "a", "4");
    FX_OK(store_audit(f->s, &err));
    for (size_t i = 0; i < sizeof lies / sizeof lies[0]; i++) {
        run_sql(f, "SAVEPOINT lie");
        if (strncmp(lies[i], "PRAGMA", 6) == 0) { /* only outside a transaction */
            run_sql(f, "ROLLBACK TO lie; RELEASE lie; PRAGMA foreign_keys = OFF; SAVEPOINT lie");
        }
        run_sql(f, lies[i]);
        if (store_audit(f->s, &err) != SHEAR_E_FORMAT)
            fail_msg("not found: %s", lies[i]);
        run_sql(f, "ROLLBACK TO lie; RELEASE lie; PRAGMA foreign_keys = ON");
        FX_OK(store_audit(f->s, &err));
    }
}

/* Bytes of a page overwritten behind SQLite's back: refused at opening, or found by the check. */
static void damage_is_found(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    char noise[600];
    memset(noise, 0xa5, sizeof noise);
    for (unsigned i = 0; i < 20; i++) {
        char content[2] = {(char)('a' + i), '\0'};
        fx_done(f, "a", content, i);
    }
    const int64_t pages = 8;
    for (int64_t page = 1; page < pages; page++) {
        char copy[4096];
        fx_close(f);
        const int fd = open(f->path, O_RDWR);
        assert_int_equal(pread(fd, copy, sizeof copy, page * 4096), sizeof copy);
        assert_int_equal(pwrite(fd, noise, sizeof noise, page * 4096), sizeof noise);
        int code = store_open(&f->s, f->path, &f->options, fx_now(f), &err);
        if (code == SHEAR_OK)
            code = store_check(f->s, &err);
        assert_int_equal(code, SHEAR_E_FORMAT);
        assert_false(store_is_transient(code));
        fx_close(f);
        assert_int_equal(pwrite(fd, copy, sizeof copy, page * 4096), sizeof copy);
        close(fd);
        fx_open(f);
        FX_OK(store_check(f->s, &err));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_good_one_passes),
        STORE_TEST(contradictions_are_found),
        STORE_TEST(damage_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
