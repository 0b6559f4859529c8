/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups: many operations, one commit, all or nothing. Failures of the disk in them:
 * test_store_faults.c. */
#include "store/database.h"
#include "store_audit.h"
#include "store_test.h"

#include "store_vfs.h"

#include <stdlib.h>

static int64_t count_submitted(fixture *f) {
    shear_error err = {0};
    store_totals totals;
    FX_OK(store_total(f->s, &totals, &err));
    return totals.submitted;
}

static void a_group_is_kept_as_a_whole(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    FX_OK(store_begin(f->s, &err));
    const int64_t one = fx_submit(f, "a");
    const int64_t two = fx_submit(f, "a");
    assert_int_equal(fx_state(f, two), STORE_QUEUED); /* seen within the group */
    assert_int_equal(fx_next(f), one);
    FX_OK(store_commit(f->s, &err));
    fx_close(f);
    fx_open(f);
    assert_int_equal(store_opened(f->s)->requeued, 1);
    assert_int_equal(count_submitted(f), 2);
}

static void a_group_given_up_leaves_nothing(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    fx_submit(f, "a");
    FX_OK(store_begin(f->s, &err));
    fx_submit(f, "a");
    store_rollback(f->s);
    assert_int_equal(count_submitted(f), 1);
    store_rollback(f->s); /* nothing is open: nothing happens */
    FX_OK(store_begin(f->s, &err));
    fx_submit(f, "a");
    fx_close(f); /* in the middle */
    fx_open(f);
    assert_int_equal(count_submitted(f), 1);
}

static void a_failed_operation_leaves_the_group(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_finished end;
    int64_t id = 0;
    bool known = false;
    FX_OK(store_begin(f->s, &err));
    const int64_t one = fx_submit(f, "a");
    store_spec spec = fx_spec(f, "a");
    FX_CODE(STORE_QUEUE_FULL, store_submit(f->s, &spec, 1, &id, &known, &err));
    const store_work work = {.sums = NULL, .now_ms = 1};
    FX_CODE(STORE_WRONG_STATE, store_finish(f->s, one, &work, &end, &err));
    FX_CODE(STORE_NOT_FOUND, store_retry(f->s, 99, 10, &err));
    fx_submit(f, "b");
    FX_OK(store_commit(f->s, &err));
    assert_int_equal(count_submitted(f), 2);
}

/* Its attempt is closed already when the job's row refuses to change: that must be undone, too,
 * alone and in a group. */
static void an_operation_is_undone_from_the_middle(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    const int64_t id = fx_running(f, "a", "c");
    const store_failure failure = fx_failure(f, STORE_DATA, STORE_NEVER);
    assert_int_equal(sqlite3_exec(f->s->db,
                                  "CREATE TEMP TRIGGER refuse BEFORE UPDATE OF state ON jobs"
                                  " WHEN NEW.state = 4 BEGIN SELECT raise(ABORT, 'refused'); END",
                                  NULL, NULL, NULL),
                     SQLITE_OK);
    FX_CODE(SHEAR_E_INTERNAL, store_fail(f->s, id, &failure, &end, &err));
    FX_OK(store_audit(f->s, &err));
    FX_OK(store_begin(f->s, &err));
    fx_submit(f, "b");
    FX_CODE(SHEAR_E_INTERNAL, store_fail(f->s, id, &failure, &end, &err));
    assert_int_equal(end, 0);
    fx_submit(f, "b");
    FX_OK(store_commit(f->s, &err));
    FX_OK(store_audit(f->s, &err));
    assert_int_equal(fx_state(f, id), STORE_RUNNING);
    assert_int_equal(count_submitted(f), 3);
}

static void groups_do_not_nest(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    FX_CODE(SHEAR_E_INTERNAL, store_commit(f->s, &err));
    FX_OK(store_begin(f->s, &err));
    FX_CODE(SHEAR_E_INTERNAL, store_begin(f->s, &err));
    fx_submit(f, "a");
    FX_OK(store_commit(f->s, &err));
    FX_CODE(SHEAR_E_INTERNAL, store_commit(f->s, &err));
    assert_int_equal(count_submitted(f), 1);
}

/* The point of it all: one sync for many operations, and one for each alone. */
static void a_group_takes_one_sync(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    fx_submit(f, "a"); /* the log's header is written */
    store_vfs_arm(VFS_SOUND, 0);
    FX_OK(store_begin(f->s, &err));
    fx_submit(f, "a");
    fx_submit(f, "a");
    FX_OK(store_commit(f->s, &err));
    const int64_t two_together = store_vfs_syncs();
    assert_int_equal(two_together, 1);
    store_vfs_arm(VFS_SOUND, 0);
    fx_submit(f, "a");
    fx_submit(f, "a");
    assert_int_equal(store_vfs_syncs(), 2);
    store_vfs_arm(VFS_SOUND, 0);
    fx_state(f, 1); /* looking takes none */
    assert_int_equal(store_vfs_syncs(), 0);
    assert_int_equal(store_vfs_calls(), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_group_is_kept_as_a_whole),
        STORE_TEST(a_group_given_up_leaves_nothing),
        STORE_TEST(a_failed_operation_leaves_the_group),
        STORE_TEST(an_operation_is_undone_from_the_middle),
        STORE_TEST(groups_do_not_nest),
        STORE_TEST(a_group_takes_one_sync),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
