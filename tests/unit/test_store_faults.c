/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The disk fails at the n-th call of every operation, for all n: an I/O error, a full disk, a power
 * cut. After it the database says what it said before the operation, or what it says after it,
 * never something between; an operation that was acknowledged has happened. */
#include "store/database.h"
#include "store_test.h"
#include "store_vfs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { START_MS = 1000, REOPEN_MS = 5000, MAX_CALLS = 1000 };

/* ---- All that the database says, as one number ---- */

static void mix(uint64_t *hash, const void *bytes, size_t n) {
    for (size_t i = 0; i < n; i++)
        *hash = (*hash ^ ((const unsigned char *)bytes)[i]) * 0x100000001b3u;
}

static void mix_rows(store *s, const char *sql, uint64_t *hash) {
    sqlite3_stmt *stmt = NULL;
    assert_int_equal(sqlite3_prepare_v2(s->db, sql, -1, &stmt, NULL), SQLITE_OK);
    while (sqlite3_step(stmt) == SQLITE_ROW) {
        for (int i = 0; i < sqlite3_column_count(stmt); i++) {
            const char *text = (const char *)sqlite3_column_text(stmt, i);
            mix(hash, text != NULL ? text : "null", text != NULL ? strlen(text) + 1 : 5);
        }
    }
    assert_int_equal(sqlite3_finalize(stmt), SQLITE_OK);
}

static uint64_t said_by(store *s) {
    static const char *const tables[] = {
        "SELECT * FROM jobs ORDER BY id",
        "SELECT * FROM attempts ORDER BY job, number",
        "SELECT * FROM checkpoints ORDER BY job",
        "SELECT * FROM fields ORDER BY id",
        "SELECT * FROM contributions ORDER BY id",
        "SELECT * FROM forgotten ORDER BY id",
        "SELECT * FROM settings ORDER BY digest",
        "SELECT * FROM counts ORDER BY state",
        "SELECT * FROM totals",
        "SELECT * FROM checkpoint_terms ORDER BY job, end_block",
        "SELECT * FROM contribution_terms ORDER BY contribution, part",
        "SELECT * FROM sqlite_sequence",
        "SELECT * FROM sqlite_schema ORDER BY name"};
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++)
        mix_rows(s, tables[i], &hash);
    return hash;
}

/* ---- The operations: each acts on a store that fill() made; job 1 is done, 2 failed, 3 waiting, 4
 * and 5 run, 6 is queued ---- */

static char *sums_1;
static char *sums_2;

static void fill(fixture *f) {
    shear_error err = {0};
    enum store_state end = STORE_QUEUED;
    f->now = START_MS;
    FX_OK(store_begin(f->s, &err)); /* for speed */
    fx_done(f, "a", "c1", 1);
    const int64_t failed = fx_running(f, "a", "c2");
    const store_failure bad = fx_failure(f, STORE_DATA, STORE_NEVER);
    FX_OK(store_fail(f->s, failed, &bad, &end, &err));
    const int64_t waiting = fx_running(f, "a", "c3");
    const store_failure passing = fx_failure(f, STORE_TRANSIENT, INT64_MAX);
    FX_OK(store_fail(f->s, waiting, &passing, &end, &err));
    const int64_t running = fx_running(f, "a", "c4");
    FX_OK(store_checkpoint(f->s, running, 2, sums_2, &err));
    fx_running(f, "new", "c5");
    fx_submit(f, "a");
    FX_OK(store_commit(f->s, &err));
}

static int submit_one(store *s, const char *digest, shear_error *err) {
    int64_t id = 0;
    bool known = false;
    const store_spec spec = {.field = "b",
                             .source = "/data/b.fits",
                             .settings = "{}",
                             .settings_digest = digest,
                             .key = digest,
                             .created_ms = 2000};
    const int code = store_submit(s, &spec, 100, &id, &known, err);
    assert_true((id != 0) == (code == SHEAR_OK));
    return code;
}

static int act_submit(store *s, shear_error *err) {
    return submit_one(s, "new settings", err);
}

static int act_next(store *s, shear_error *err) {
    store_job job;
    const int code = store_next(s, 2000, &job, err);
    assert_true((job.id != 0) == (code == SHEAR_OK));
    store_job_deinit(&job);
    return code;
}

static int act_learn(store *s, shear_error *err) {
    int64_t of = 0;
    const store_input learned = {"c", "changed", 32};
    return store_set_input(s, 4, &learned, &of, err);
}

/* Any terms are as good as others: of the 14 stamps that sums_2 has used. */
static const unsigned char terms[14 * SHEAR_SYMMETRY_BYTES];

static int act_checkpoint(store *s, shear_error *err) {
    const store_progress progress = {0, 7, sums_1, terms, sizeof terms / 2};
    return store_checkpoint_terms(s, 4, &progress, err);
}

static int finish(store *s, int64_t id, shear_error *err) {
    store_finished end;
    const store_work work = {.sums = sums_2,
                             .result = "{}",
                             .catalog = "/out/c.csv",
                             .elapsed_us = 5,
                             .now_ms = 2000,
                             .account = "{}",
                             .has_truth = true,
                             .true_g1 = 0.1,
                             .terms = terms,
                             .terms_size = sizeof terms};
    const int code = store_finish(s, id, &work, &end, err);
    assert_true((end.state == STORE_DONE) == (code == SHEAR_OK));
    return code;
}

static int act_finish(store *s, shear_error *err) {
    return finish(s, 4, err);
}

static int act_finish_new_field(store *s, shear_error *err) {
    return finish(s, 5, err);
}

static int act_fail(store *s, shear_error *err) {
    enum store_state end = STORE_QUEUED;
    const store_failure f = {STORE_TRANSIENT, "io", "no room", NULL, 9000, 2000};
    return store_fail(s, 4, &f, &end, err);
}

static int act_release(store *s, shear_error *err) {
    enum store_state end = STORE_QUEUED;
    return store_release(s, 4, 2000, &end, err);
}

static int act_cancel(store *s, shear_error *err) {
    enum store_state end = STORE_QUEUED;
    return store_cancel(s, 6, 2000, &end, err);
}

static int act_retry(store *s, shear_error *err) {
    return store_retry(s, 2, 100, err);
}

static int act_retire(store *s, shear_error *err) {
    int64_t gone = 0;
    const store_retention rule = {INT64_MAX, 0, 10};
    const int code = store_retire(s, &rule, &gone, err);
    assert_true((gone > 0) == (code == SHEAR_OK));
    return code;
}

static int act_retract(store *s, shear_error *err) {
    return store_retract(s, 1, err);
}

static int forget_new_field(store *s, shear_error *err) {
    store_forgotten gone;
    const int code = store_forget(s, "new", NULL, &gone, err);
    assert_true((gone.contributions == 1) == (code == SHEAR_OK));
    return code;
}

static int leave(store *s, shear_error *err) {
    store_removal next;
    int code = store_next_removal(s, &next, err);
    if (code == SHEAR_OK)
        code = store_remove(s, &next, true, err);
    store_removal_deinit(&next);
    return code;
}

typedef int (*action)(store *s, shear_error *err);

/* A group that is given up at its first failure. */
static int act_in_group(store *s, const action *parts, size_t n, shear_error *err) {
    int code = store_begin(s, err);
    for (size_t i = 0; i < n && code == SHEAR_OK; i++) {
        code = parts[i](s, err);
        if (code != SHEAR_OK) {
            store_rollback(s);
            return code;
        }
    }
    return code == SHEAR_OK ? store_commit(s, err) : code;
}

static int act_group(store *s, shear_error *err) {
    static const action parts[] = {act_finish, act_submit, act_retry, act_finish_new_field,
                                   act_retire};
    return act_in_group(s, parts, sizeof parts / sizeof parts[0], err);
}

static int act_forget(store *s, shear_error *err) {
    static const action parts[] = {act_finish_new_field, forget_new_field, leave};
    return act_in_group(s, parts, sizeof parts / sizeof parts[0], err);
}

/* In the order of the pages they touch: where the failure's kind matters little, the last ones do.
 */
static const action actions[] = {act_checkpoint, act_learn,  act_next,    act_submit,
                                 act_release,    act_cancel, act_retry,   act_fail,
                                 act_finish,     act_retire, act_retract, act_finish_new_field,
                                 act_forget,     act_group};
enum { N_ACTIONS = sizeof actions / sizeof actions[0] };

/* ---- One failure ---- */

/* What a sound run says: before and after the operation, and the same after a restart. */
typedef struct reference {
    uint64_t before, after, before_restart, after_restart;
} reference;

/* How the store runs: a log that is brought into the database at every commit, and a cache so small
 * that the log is written long before the commit, make the disk busier. */
enum { PLAIN, BUSY };

static void copy(const char *from, const char *to) {
    char bytes[65536];
    unlink(to); /* some file systems write a file out that replaces another by truncating it */
    FILE *in = fopen(from, "rb");
    FILE *out = fopen(to, "wb");
    assert_true(in != NULL && out != NULL);
    for (size_t n = fread(bytes, 1, sizeof bytes, in); n > 0;
         n = fread(bytes, 1, sizeof bytes, in)) {
        assert_int_equal(fwrite(bytes, 1, n, out), n);
    }
    fclose(in);
    assert_int_equal(fclose(out), 0);
}

static char *with_ending(fixture *f, const char *ending) {
    static char name[400];
    snprintf(name, sizeof name, "%s%s", f->path, ending);
    return name;
}

/* From a copy of the empty database: making it takes longer than all the rest. */
static void begin(fixture *f, int mode) {
    static const char *const endings[] = {"-wal", "-journal", "-wal.synced"};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
        unlink(with_ending(f, endings[i]));
    copy(with_ending(f, ".empty"), f->path);
    copy(f->path, with_ending(f, ".synced"));
    store_vfs_arm(VFS_SOUND, 0);
    fx_open(f);
    fill(f);
    if (mode == BUSY) {
        assert_int_equal(sqlite3_exec(f->s->db,
                                      "PRAGMA wal_autocheckpoint = 1; PRAGMA cache_size = 4", NULL,
                                      NULL, NULL),
                         SQLITE_OK);
    }
}

static uint64_t restart(fixture *f) {
    fx_close(f);
    f->now = REOPEN_MS;
    fx_open(f);
    return said_by(f->s);
}

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

static int meaning_of(enum store_vfs_fault fault) {
    return fault == VFS_FULL ? SHEAR_E_FULL : SHEAR_E_IO;
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

static void keep_empty(fixture *f) {
    fx_close(f);
    copy(f->path, with_ending(f, ".empty"));
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

/* ---- A group whose caller goes on after a failure in it ---- */

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

/* ---- Reading and opening ---- */

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
        STORE_TEST(io_errors),
        STORE_TEST(io_errors_busy),
        STORE_TEST(full_disk),
        STORE_TEST(full_disk_busy),
        STORE_TEST(power_cuts),
        STORE_TEST(power_cuts_busy),
        STORE_TEST(a_group_is_all_or_nothing),
        STORE_TEST(a_read_can_lose_a_group),
        STORE_TEST(a_full_disk_can_be_read),
        STORE_TEST(opening_a_new_one),
        STORE_TEST(opening_a_dead_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
