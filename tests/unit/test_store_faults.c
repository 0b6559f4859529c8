/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The disk fails at the n-th call of every operation, for all n: an I/O error, a full disk, a power
 * cut. After it the database says what it said before the operation, or what it says after it,
 * never something between; an operation that was acknowledged has happened. */
#include "store_actions.h"
#include "store_audit.h"
#include "store_faults.h"
#include "store_test.h"

#include <stdlib.h>

enum { MAX_CALLS = 1000 };

/* What a sound run says: before and after the operation, and the same after a restart. */
typedef struct reference {
    uint64_t before, after, before_restart, after_restart;
} reference;

static reference sound_run(fixture *f, action act, int mode) {
    reference r;
    shear_error err = {0};
    begin(f, mode);
    r.before = said_by(f->s);
    r.before_restart = restart(f);
    fx_close(f);
    begin(f, mode);
    assert_true(said_by(f->s) == r.before); /* all this is deterministic */
    FX_OK(act(f->s, &err));
    r.after = said_by(f->s);
    FX_OK(store_audit(f->s, &err));
    r.after_restart = restart(f);
    FX_OK(store_audit(f->s, &err));
    fx_close(f);
    assert_true(r.after != r.before);
    return r;
}

static void restarts(fixture *f, const reference *r, int code) {
    shear_error err = {0};
    const uint64_t said = restart(f);
    assert_true(said == r->after_restart || (code != SHEAR_OK && said == r->before_restart));
    FX_OK(store_check(f->s, &err));
}

/* False when the operation ended before its n-th call. Where it failed, the store mostly is left
 * open: it goes on as if nothing had been, and the operation succeeds in the end. */
static bool strike(fixture *f, action act, const reference *r, int mode, enum store_vfs_fault fault,
                   int n) {
    shear_error err = {0};
    if (f->s == NULL)
        begin(f, mode);
    store_vfs_arm(fault, n);
    const int code = act(f->s, &err);
    const bool fired = store_vfs_fired();
    assert_true(code == SHEAR_OK || (fired && code == meaning_of(fault)));
    /* In the plain mode an operation that met a failure says so; in the busy one it may have been
     * only the log's way into the database, which is tried again later. */
    assert_true(code != SHEAR_OK || !fired || mode == BUSY);
    if (fault == VFS_POWER_CUT) {
        fx_close(f);
        store_vfs_restart(f->path);
    } else {
        store_vfs_arm(VFS_SOUND, 0);
        assert_true(said_by(f->s) == (code == SHEAR_OK ? r->after : r->before));
    }
    if (code == SHEAR_OK || n % 4 == 0 || fault == VFS_POWER_CUT) {
        restarts(f, r, code);
        fx_close(f);
    }
    return fired;
}

static void strike_from(fixture *f, int first, enum store_vfs_fault fault, int mode) {
    keep_empty(f);
    sums_1 = fx_sums(1);
    sums_2 = fx_sums(2);
    store_vfs_remember(fault == VFS_POWER_CUT);
    for (int i = first; i < N_ACTIONS; i++) {
        const reference r = sound_run(f, actions[i], mode);
        int n = 1;
        while (n < MAX_CALLS && strike(f, actions[i], &r, mode, fault, n))
            n++;
        assert_true(n > 2 && n < MAX_CALLS); /* a write and a sync at least */
    }
    free(sums_1);
    free(sums_2);
    store_vfs_remember(false);
    store_vfs_arm(VFS_SOUND, 0);
    fx_open(f);
}

static void io_errors(void **state) {
    strike_from(*state, 0, VFS_IO_ERROR, PLAIN);
}

static void io_errors_busy(void **state) {
    strike_from(*state, N_ACTIONS - 3, VFS_IO_ERROR, BUSY);
}

static void full_disk(void **state) {
    strike_from(*state, N_ACTIONS - 3, VFS_FULL, PLAIN);
}

static void full_disk_busy(void **state) {
    strike_from(*state, N_ACTIONS - 1, VFS_FULL, BUSY);
}

static void power_cuts(void **state) {
    strike_from(*state, 0, VFS_POWER_CUT, PLAIN);
}

static void power_cuts_busy(void **state) {
    strike_from(*state, N_ACTIONS - 2, VFS_POWER_CUT, BUSY);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(io_errors),      STORE_TEST(io_errors_busy), STORE_TEST(full_disk),
        STORE_TEST(full_disk_busy), STORE_TEST(power_cuts),     STORE_TEST(power_cuts_busy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
