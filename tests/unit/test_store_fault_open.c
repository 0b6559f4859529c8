/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The disk fails while the store is opened; a full disk can be read. */
#include "store_actions.h"
#include "store_audit.h"
#include "store_faults.h"
#include "store_test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void a_full_disk_can_be_read(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_counts counts;
    const int64_t id = fx_submit(f, "a");
    store_vfs_arm(VFS_FULL, 1);
    for (int i = 0; i < 3; i++) {
        const int code = act_submit(f->s, &err);
        assert_int_equal(code, SHEAR_E_FULL);
        assert_true(store_is_transient(code));
        assert_non_null(strstr(err.message, "full"));
        assert_int_not_equal(err.advice[0], '\0');
        assert_int_equal(fx_state(f, id), STORE_QUEUED);
        FX_OK(store_count(f->s, &counts, &err));
        assert_int_equal(counts.unfinished, 1);
    }
    store_vfs_arm(VFS_SOUND, 0);
    FX_OK(act_submit(f->s, &err));
}

/* Open at a path while the disk fails at the n-th call; then open it in peace: as if nothing had
 * been. */
static bool open_under(fixture *f, enum store_vfs_fault fault, int n, uint64_t wanted) {
    shear_error err = {0};
    f->now = REOPEN_MS + 1;
    store_vfs_arm(fault, n);
    const int code = store_open(&f->s, f->path, &f->options, f->now, &err);
    const bool fired = store_vfs_fired();
    assert_true(code == SHEAR_OK || (fired && code == meaning_of(fault)));
    assert_true((f->s != NULL) == (code == SHEAR_OK));
    fx_close(f);
    store_vfs_arm(VFS_SOUND, 0);
    f->now = REOPEN_MS;
    fx_open(f);
    assert_true(said_by(f->s) == wanted);
    FX_OK(store_check(f->s, &err));
    fx_close(f);
    return fired;
}

static void opening_a_new_one(void **state) {
    fixture *f = *state;
    const uint64_t wanted = said_by(f->s);
    fx_close(f);
    for (enum store_vfs_fault fault = VFS_IO_ERROR; fault <= VFS_FULL; fault++) {
        bool fired = true;
        int n = 0;
        while (fired) {
            n++;
            assert_int_equal(unlink(f->path), 0);
            fired = open_under(f, fault, n, wanted);
        }
        assert_true(n > 10);
    }
    fx_open(f);
}

/* The database of a service that died: its log is hot, its jobs are running. */
static void opening_a_dead_one(void **state) {
    fixture *f = *state;
    char log[310];
    char kept[310];
    char kept_log[310];
    snprintf(log, sizeof log, "%s-wal", f->path);
    snprintf(kept, sizeof kept, "%s.kept", f->path);
    snprintf(kept_log, sizeof kept_log, "%s.kept-log", f->path);
    sums_2 = fx_sums(2);
    fill(f);
    copy(f->path, kept);
    copy(log, kept_log);
    const uint64_t wanted = restart(f);
    fx_close(f);
    for (enum store_vfs_fault fault = VFS_IO_ERROR; fault <= VFS_FULL; fault++) {
        bool fired = true;
        int n = 0;
        while (fired) {
            n++;
            copy(kept, f->path);
            copy(kept_log, log);
            fired = open_under(f, fault, n, wanted);
        }
        assert_true(n > 2);
    }
    free(sums_2);
    fx_open(f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_full_disk_can_be_read),
        STORE_TEST(opening_a_new_one),
        STORE_TEST(opening_a_dead_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
