/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opening: whose database, which version, one owner, its settings. */
#include "store/database.h"
#include "store/schema.h"
#include "store/sums_text.h"
#include "store_audit.h"
#include "store_fixture.h"
#include "test.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static int setup(void **state) {
    fixture *f = calloc(1, sizeof *f);
    fx_init(f);
    *state = f;
    return 0;
}

static int teardown(void **state) {
    fx_deinit(*state);
    free(*state);
    return 0;
}

/* A statement on the file, with SQLite alone. */
static void run_sql(const char *path, const char *sql) {
    sqlite3 *db = NULL;
    char *message = NULL;
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    if (sqlite3_exec(db, sql, NULL, NULL, &message) != SQLITE_OK)
        fail_msg("%s: %s", sql, message);
    sqlite3_close(db);
}

static int64_t ask(sqlite3 *db, const char *sql) {
    shear_error err = {0};
    int64_t value = 0;
    FX_OK(database_number(db, "", sql, &value, &err));
    return value;
}

static char *read_all(const char *path, size_t *size) {
    FILE *in = fopen(path, "rb");
    assert_non_null(in);
    char *bytes = calloc(1, 1 << 22);
    *size = fread(bytes, 1, 1 << 22, in);
    fclose(in);
    return bytes;
}

static void makes_a_private_database(void **state) {
    fixture *f = *state;
    struct stat st;
    umask(0);
    fx_open(f);
    assert_true(store_opened(f->s)->created);
    assert_int_equal(store_opened(f->s)->migrated_from, SCHEMA_VERSION);
    assert_int_equal(stat(f->path, &st), 0);
    assert_int_equal(st.st_mode & 0777, 0600);
    fx_submit(f, "a"); /* its log is there now, and as private */
    char log[310];
    snprintf(log, sizeof log, "%s-wal", f->path);
    assert_int_equal(stat(log, &st), 0);
    assert_int_equal(st.st_mode & 0777, 0600);
    snprintf(log, sizeof log, "%s-shm", f->path);
    assert_int_equal(access(log, F_OK), -1);
    fx_close(f);
    fx_open(f);
    assert_false(store_opened(f->s)->created);
    assert_int_equal(store_opened(f->s)->requeued, 0);
}

static void is_durable(void **state) {
    fixture *f = *state;
    sqlite3_stmt *stmt = NULL;
    fx_open(f);
    assert_int_equal(ask(f->s->db, "PRAGMA synchronous"), 2);
    assert_int_equal(ask(f->s->db, "PRAGMA foreign_keys"), 1);
    assert_int_equal(ask(f->s->db, "PRAGMA application_id"), SCHEMA_APPLICATION);
    assert_int_equal(ask(f->s->db, "PRAGMA user_version"), SCHEMA_VERSION);
    assert_int_equal(sqlite3_prepare_v2(f->s->db, "PRAGMA journal_mode", -1, &stmt, NULL), 0);
    assert_int_equal(sqlite3_step(stmt), SQLITE_ROW);
    assert_string_equal((const char *)sqlite3_column_text(stmt, 0), "wal");
    sqlite3_finalize(stmt);
}

static void has_one_owner(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store *other = (store *)f;
    fx_open(f);
    FX_CODE(STORE_LOCKED, store_open(&other, f->path, NULL, 1, &err));
    assert_null(other);
    assert_non_null(strstr(err.message, f->path));
    const pid_t child = fork();
    if (child == 0) { /* another process; not even to look */
        _exit(store_open(&other, f->path, NULL, 1, NULL));
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(WEXITSTATUS(status), STORE_LOCKED);
    fx_submit(f, "a"); /* the owner did not notice */
    fx_close(f);
    fx_open(f);
}

/* The lock beside the database is enough to keep others out, and without it there is no owner. */
static void has_a_lock_beside_it(void **state) {
    fixture *f = *state;
    char name[sizeof f->path + sizeof ".lock"];
    snprintf(name, sizeof name, "%s.lock", f->path);
    store *s = NULL;
    shear_error err = {0};
    const int fd = open(name, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    assert_true(fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) == 0);
    FX_CODE(STORE_LOCKED, store_open(&s, f->path, NULL, 1, &err));
    assert_true(access(f->path, F_OK) != 0); /* it was not even made */
    close(fd);
    fx_open(f);
    const int other = open(name, O_RDWR | O_CLOEXEC);
    assert_true(other >= 0 && flock(other, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK);
    fx_close(f);
    assert_int_equal(flock(other, LOCK_EX | LOCK_NB), 0);
    close(other);
}

/* Services that all start at once where no database is yet: one gets it, and it is good. */
static void one_of_many_gets_it(void **state) {
    enum { MANY = 8, ROUNDS = 20 };
    fixture *f = *state;
    for (int round = 0; round < ROUNDS; round++) {
        int go[2];
        int stay[2];
        int answers[2];
        int owners = 0;
        assert_true(pipe(go) == 0 && pipe(stay) == 0 && pipe(answers) == 0);
        for (int i = 0; i < MANY; i++) {
            if (fork() == 0) {
                char byte = 0;
                close(go[1]);
                close(stay[1]);
                (void)!read(go[0], &byte, 1); /* till its end is closed: all at once */
                byte = store_open(&f->s, f->path, NULL, 1, NULL) == SHEAR_OK ? 'y' : 'n';
                (void)!write(answers[1], &byte, 1);
                (void)!read(stay[0], &byte, 1); /* the owner is there till all have tried */
                _exit(0);
            }
        }
        close(go[0]);
        close(go[1]);
        close(stay[0]);
        for (int i = 0; i < MANY; i++) {
            char byte = 0;
            assert_int_equal(read(answers[0], &byte, 1), 1);
            owners += byte == 'y';
        }
        close(answers[0]);
        close(answers[1]);
        close(stay[1]);
        while (wait(NULL) > 0) {
        }
        assert_int_equal(owners, 1);
        fx_open(f);
        fx_submit(f, "a");
        fx_close(f);
        assert_int_equal(unlink(f->path), 0);
    }
}

static void waits_for_the_owner_to_leave(void **state) {
    fixture *f = *state;
    int ready[2];
    char byte = 0;
    assert_int_equal(pipe(ready), 0);
    const pid_t child = fork();
    if (child == 0) {
        fx_open(f);
        (void)!write(ready[1], "x", 1);
        usleep(50000);
        fx_close(f);
        _exit(0);
    }
    assert_int_equal(read(ready[0], &byte, 1), 1);
    close(ready[0]);
    close(ready[1]);
    f->options.busy_ms = 20000;
    fx_open(f);
    waitpid(child, NULL, 0);
}

static void refuses_and_leaves_as_it_was(fixture *f, int code) {
    shear_error err = {0};
    size_t before = 0;
    size_t after = 0;
    char *old = read_all(f->path, &before);
    FX_CODE(code, store_open(&f->s, f->path, NULL, 1, &err));
    assert_null(f->s);
    assert_int_not_equal(err.advice[0], '\0');
    char *new = read_all(f->path, &after);
    assert_int_equal(before, after);
    assert_memory_equal(old, new, before);
    free(old);
    free(new);
}

static void refuses_a_newer_one(void **state) {
    fixture *f = *state;
    char mark[64];
    fx_open(f);
    fx_close(f);
    snprintf(mark, sizeof mark, "PRAGMA user_version = %d", SCHEMA_VERSION + 1);
    run_sql(f->path, mark);
    refuses_and_leaves_as_it_was(f, STORE_NEWER);
    run_sql(f->path, "PRAGMA user_version = -1");
    refuses_and_leaves_as_it_was(f, STORE_NEWER);
    snprintf(mark, sizeof mark, "PRAGMA user_version = %d", SCHEMA_VERSION);
    run_sql(f->path, mark);
    fx_open(f);
}

static void refuses_a_foreign_one(void **state) {
    fixture *f = *state;
    run_sql(f->path, "CREATE TABLE t(x)");
    refuses_and_leaves_as_it_was(f, SHEAR_E_FORMAT);
    run_sql(f->path, "PRAGMA application_id = 17; PRAGMA user_version = 1");
    refuses_and_leaves_as_it_was(f, SHEAR_E_FORMAT);
}

static void refuses_what_is_no_database(void **state) {
    fixture *f = *state;
    FILE *out = fopen(f->path, "w");
    for (int i = 0; i < 1000; i++)
        fputs("no database ", out);
    fclose(out);
    refuses_and_leaves_as_it_was(f, SHEAR_E_FORMAT);
}

static void says_why_it_cannot(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    char path[400];
    static char endless[5000];
    snprintf(path, sizeof path, "%s/none/state.db", f->dir);
    FX_CODE(SHEAR_E_IO, store_open(&f->s, path, NULL, 1, &err));
    assert_non_null(strstr(err.message, path));
    FX_CODE(SHEAR_E_IO, store_open(&f->s, f->dir, NULL, 1, &err));
    FX_CODE(SHEAR_E_IO, store_open(&f->s, "", NULL, 1, &err));
    memset(endless, 'x', sizeof endless - 1);
    FX_CODE(SHEAR_E_IO, store_open(&f->s, endless, NULL, 1, &err));
    const store_options options = {.vfs = "no-such-vfs"};
    FX_CODE(SHEAR_E_INTERNAL, store_open(&f->s, f->path, &options, 1, &err));
    assert_null(f->s);
    store_close(NULL);
}

/* Names that mean something else to SQLite are just names. */
static void takes_names_literally(void **state) {
    fixture *f = *state;
    static const char *const names[] = {":memory:", "file:x.db?mode=memory", "plain.db"};
    char here[4096];
    assert_non_null(getcwd(here, sizeof here));
    assert_int_equal(chdir(f->dir), 0);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        shear_error err = {0};
        FX_OK(store_open(&f->s, names[i], NULL, 1, &err));
        const int64_t id = fx_submit(f, "a");
        fx_close(f);
        assert_int_equal(access(names[i], F_OK), 0);
        FX_OK(store_open(&f->s, names[i], NULL, 1, &err));
        assert_int_equal(fx_state(f, id), STORE_QUEUED);
        fx_close(f);
    }
    assert_int_equal(chdir(here), 0);
}

/* Three made-up versions; the third step can be made to fail. */
static const char *const step_1[] = {"CREATE TABLE t(a)", "INSERT INTO t VALUES (1)", NULL};
static const char *const step_2[] = {"ALTER TABLE t ADD COLUMN b", "UPDATE t SET b = a + 1", NULL};
static const char *const step_3[] = {"INSERT INTO t VALUES (5, 6)", NULL};
static const char *const step_bad[] = {"INSERT INTO t VALUES (7, 8)", "INSERT INTO none VALUES (1)",
                                       NULL};

static void migrates_step_by_step(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    sqlite3 *db = NULL;
    const schema_step good[] = {step_1, step_2, step_3};
    const schema_step bad[] = {step_1, step_2, step_bad};
    assert_int_equal(sqlite3_open(f->path, &db), SQLITE_OK);
    FX_OK(database_exec(db, f->path, "BEGIN", &err));
    FX_OK(schema_migrate(db, f->path, good, 0, 1, &err));
    FX_OK(database_exec(db, f->path, "COMMIT", &err));
    assert_int_equal(ask(db, "PRAGMA user_version"), 1);

    FX_OK(database_exec(db, f->path, "BEGIN", &err));
    FX_CODE(SHEAR_E_INTERNAL, schema_migrate(db, f->path, bad, 1, 3, &err));
    assert_non_null(strstr(err.message, "schema version 2 to 3"));
    FX_OK(database_exec(db, f->path, "ROLLBACK", &err));
    assert_int_equal(ask(db, "PRAGMA user_version"), 1);
    assert_int_equal(ask(db, "SELECT count(*) FROM pragma_table_info('t')"), 1);

    FX_OK(database_exec(db, f->path, "BEGIN", &err));
    FX_OK(schema_migrate(db, f->path, good, 1, 3, &err));
    FX_OK(database_exec(db, f->path, "COMMIT", &err));
    assert_int_equal(ask(db, "PRAGMA user_version"), 3);
    assert_int_equal(ask(db, "PRAGMA application_id"), SCHEMA_APPLICATION);
    assert_int_equal(ask(db, "SELECT sum(10 * a + b) FROM t"), 12 + 56);
    sqlite3_close(db);
}

/* A database of ours from before the first version: marked, without tables. */
static void opens_an_older_one(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    char sql[64];
    snprintf(sql, sizeof sql, "PRAGMA application_id = %d", SCHEMA_APPLICATION);
    run_sql(f->path, sql);
    fx_open(f);
    assert_false(store_opened(f->s)->created);
    assert_int_equal(store_opened(f->s)->migrated_from, 0);
    FX_OK(store_audit(f->s, &err));
    fx_submit(f, "a");
}

/* A database of version 1, with a job in it. */
static void make_version_1(const char *path) {
    shear_error err = {0};
    sqlite3 *db = NULL;
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    FX_OK(database_exec(db, path, "BEGIN", &err));
    FX_OK(schema_migrate(db, path, schema_steps, 0, 1, &err));
    FX_OK(database_exec(db, path,
                        "INSERT INTO settings(digest, text) VALUES ('d0', '{}');"
                        "INSERT INTO jobs(owner, idempotency_key, source, settings, field,"
                        " field_asked, origin, priority, forced, created_ms)"
                        " VALUES (7, 'k', '/a', 'd0', 'f', 'f', 1, 3, 0, 5); COMMIT",
                        &err));
    assert_int_equal(ask(db, "PRAGMA user_version"), 1);
    sqlite3_close(db);
}

/* Its jobs go on, their groups not known; new ones have theirs beside them. */
static void opens_version_1(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    store_job job = {0};
    int64_t id = 0;
    bool known = false;
    make_version_1(f->path);
    fx_open(f);
    assert_int_equal(store_opened(f->s)->migrated_from, 1);
    assert_int_equal(store_opened(f->s)->version, SCHEMA_VERSION);
    FX_OK(store_audit(f->s, &err));
    FX_OK(store_job_get(f->s, 1, &job, &err));
    assert_string_equal(job.source, "/a");
    assert_int_equal(job.owner, 7);
    assert_int_equal(job.priority, 3);
    assert_null(job.groups);
    store_job_deinit(&job);
    store_spec spec = fx_spec(f, "f");
    spec.gid = 12;
    spec.groups = "4 12";
    FX_OK(store_submit(f->s, &spec, 10, &id, &known, &err));
    fx_close(f);
    fx_open(f);
    assert_int_equal(store_opened(f->s)->migrated_from, SCHEMA_VERSION);
    FX_OK(store_audit(f->s, &err));
    FX_OK(store_job_get(f->s, id, &job, &err));
    assert_int_equal(job.gid, 12);
    assert_string_equal(job.groups, "4 12");
    store_job_deinit(&job);
    assert_int_equal(fx_next(f), 1); /* the older one first: its priority is higher */
    assert_int_equal(fx_next(f), id);
}

/* What 0.1 left behind (version 3): dropped files, a job file and a client's job; one is counted.
 */
static void make_version_3(const char *path) {
    shear_error err = {0};
    sqlite3 *db = NULL;
    char *text = fx_old_sums(0);
    char *sums = NULL;
    char *sql = NULL;
    FX_OK(sums_pack(text, &sums, &err));
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    FX_OK(database_exec(db, path, "BEGIN", &err));
    FX_OK(schema_migrate(db, path, schema_steps, 0, 3, &err));
    assert_true(
        asprintf(
            &sql,
            "INSERT INTO settings(digest, text) VALUES ('d0', '{}');"
            "INSERT INTO jobs(id, owner, idempotency_key, source, settings, origin, priority, "
            "forced,"
            " created_ms) VALUES"
            " (1, 7, 'k1', '{\"path\":\"/s/active/k1-a-b.fits\"}', 'd0', 0, 0, 0, 5),"
            " (2, 7, 'k2', '{\"path\":\"/data/other.fits\"}', 'd0', 0, 0, 0, 5),"
            " (3, 7, 'k3', '{\"path\":\"/s/active/k3-c.fits\"}', 'd0', 1, 0, 0, 5),"
            " (4, 7, 'k4', 'not JSON', 'd0', 0, 0, 0, 5),"
            " (5, 7, 'k5', '{\"path\":\"/s/active/k5-\\u00e9.fits\"}', 'd0', 0, 0, 0, 5);"
            "UPDATE jobs SET state = 1, attempts = 1, attempt = 1, started_ms = 6, field = 'f',"
            " content = 'c' WHERE id = 3;"
            "INSERT INTO attempts(job, number, started_ms) VALUES (3, 1, 6);"
            "INSERT INTO fields(id, name, settings, sums, n_stamps, n_used, updated_ms, jobs)"
            " VALUES (1, 'f', 'd0', '%s', 16, 16, 9, 1);"
            "INSERT INTO contributions(field, job, content, sums, n_stamps, n_used, counted_ms)"
            " VALUES (1, 3, 'c', '%s', 16, 16, 9);"
            "UPDATE attempts SET ending = 1, ended_ms = 9 WHERE job = 3;"
            "UPDATE jobs SET state = 3, outcome = 1, n_stamps = 16, n_used = 16, finished_ms = 9"
            " WHERE id = 3; COMMIT",
            sums, sums) > 0);
    FX_OK(database_exec(db, path, sql, &err));
    free(sql);
    free(sums);
    free(text);
    sqlite3_close(db);
}

static void is_dropped(fixture *f, int64_t id, const char *name) {
    store_job job = {0};
    shear_error err = {0};
    FX_OK(store_job_get(f->s, id, &job, &err));
    if (name == NULL) {
        assert_null(job.dropped);
    } else {
        assert_string_equal(job.dropped, name);
    }
    assert_null(job.place);
    store_job_deinit(&job);
}

/* It opens as what it was, its own files known by their names, and the new state is possible. */
static void opens_version_3(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    int64_t id = 0;
    char identity[40];
    make_version_3(f->path);
    fx_open(f);
    assert_int_equal(store_opened(f->s)->migrated_from, 3);
    is_dropped(f, 1, "a-b.fits");
    is_dropped(f, 2, NULL); /* a job file: its name is learned when it is told again */
    is_dropped(f, 3, NULL);
    is_dropped(f, 4, NULL);
    is_dropped(f, 5, "\xc3\xa9.fits");
    FX_OK(store_find_dropped(f->s, 7, "k2", "job.json", &id, &err));
    assert_int_equal(id, 2);
    is_dropped(f, 2, "job.json");
    FX_OK(store_find_dropped(f->s, 7, "k3", "c.fits", &id, &err)); /* a client's */
    assert_int_equal(id, 0);
    FX_OK(store_find_dropped(f->s, 8, "k1", "a.fits", &id, &err));
    assert_int_equal(id, 0);
    assert_int_equal(ask(f->s->db, "SELECT counted FROM totals"), 1);
    assert_int_equal(
        sqlite3_exec(f->s->db, "UPDATE jobs SET state = 7 WHERE id = 3", NULL, NULL, NULL),
        SQLITE_CONSTRAINT_CHECK);
    assert_int_equal(sqlite3_exec(f->s->db,
                                  "SAVEPOINT x; UPDATE jobs SET state = 6 WHERE id = 3;"
                                  "ROLLBACK TO x; RELEASE x",
                                  NULL, NULL, NULL),
                     SQLITE_OK);
    FX_OK(store_audit(f->s, &err));
    FX_OK(store_check(f->s, &err));
    snprintf(identity, sizeof identity, "%s", store_identity(f->s));
    assert_int_equal(strspn(identity, "0123456789abcdef"), 32);
    fx_close(f);
    fx_open(f);
    assert_string_equal(store_identity(f->s), identity);
    store_forgotten gone;
    FX_OK(store_forget(f->s, "f", NULL, &gone, &err));
    FX_OK(store_audit(f->s, &err));
    assert_int_equal(fx_leave(f, INT64_MAX), 1);
}

static void has_an_identity_of_its_own(void **state) {
    fixture *f = *state;
    fixture other;
    fx_open(f);
    fx_init(&other);
    fx_open(&other);
    assert_string_not_equal(store_identity(f->s), store_identity(other.s));
    fx_deinit(&other);
}

/* Marked as the first version, but not its tables: no statement fits. */
static void refuses_other_tables(void **state) {
    fixture *f = *state;
    shear_error err = {0};
    char sql[96];
    snprintf(sql, sizeof sql, "PRAGMA application_id = %d; PRAGMA user_version = 1",
             SCHEMA_APPLICATION);
    run_sql(f->path, sql);
    FX_CODE(SHEAR_E_INTERNAL, store_open(&f->s, f->path, NULL, 1, &err));
}

static void names_are_stable(void **state) {
    (void)state;
    assert_string_equal(store_code_name(SHEAR_OK), "ok");
    assert_string_equal(store_code_name(SHEAR_E_IO), "io");
    assert_string_equal(store_code_name(STORE_QUEUE_FULL), "queue_full");
    assert_string_equal(store_code_name(STORE_KEY_REUSED), "key_reused");
    assert_string_equal(store_code_name(STORE_NOT_FOUND), "not_found");
    assert_string_equal(store_code_name(STORE_WRONG_STATE), "wrong_state");
    assert_string_equal(store_code_name(STORE_BAD_TEXT), "bad_text");
    assert_string_equal(store_code_name(STORE_LOCKED), "locked");
    assert_string_equal(store_code_name(STORE_NEWER), "newer");
    assert_string_equal(store_code_name(STORE_NEWER + 1), "unknown");
    assert_string_equal(store_state_name(STORE_QUEUED), "queued");
    assert_string_equal(store_state_name(STORE_CANCELLED), "cancelled");
    assert_string_equal(store_state_name(STORE_N_STATES), "unknown");
    assert_string_equal(store_state_name((enum store_state) - 1), "unknown");
    assert_true(store_is_transient(SHEAR_E_IO));
    assert_true(store_is_transient(SHEAR_E_FULL));
    assert_true(store_is_transient(SHEAR_E_NOMEM));
    assert_false(store_is_transient(SHEAR_E_FORMAT));
    assert_false(store_is_transient(STORE_LOCKED));
}

static void maps_every_error(void **state) {
    static const int map[][2] = {
        {SQLITE_FULL, SHEAR_E_FULL},           {SQLITE_IOERR_FSYNC, SHEAR_E_IO},
        {SQLITE_IOERR_WRITE, SHEAR_E_IO},      {SQLITE_CANTOPEN, SHEAR_E_IO},
        {SQLITE_READONLY, SHEAR_E_IO},         {SQLITE_NOMEM, SHEAR_E_NOMEM},
        {SQLITE_IOERR_NOMEM, SHEAR_E_NOMEM},   {SQLITE_CORRUPT, SHEAR_E_FORMAT},
        {SQLITE_NOTADB, SHEAR_E_FORMAT},       {SQLITE_IOERR_CORRUPTFS, SHEAR_E_FORMAT},
        {SQLITE_BUSY, STORE_LOCKED},           {SQLITE_BUSY_RECOVERY, STORE_LOCKED},
        {SQLITE_CONSTRAINT, SHEAR_E_INTERNAL}, {SQLITE_MISUSE, SHEAR_E_INTERNAL}};
    (void)state;
    for (size_t i = 0; i < sizeof map / sizeof map[0]; i++) {
        shear_error err = {0};
        FX_CODE(map[i][1], database_fail(NULL, "p", map[i][0], "testing", &err));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_stable),
        cmocka_unit_test(maps_every_error),
        cmocka_unit_test_setup_teardown(makes_a_private_database, setup, teardown),
        cmocka_unit_test_setup_teardown(is_durable, setup, teardown),
        cmocka_unit_test_setup_teardown(has_one_owner, setup, teardown),
        cmocka_unit_test_setup_teardown(has_a_lock_beside_it, setup, teardown),
        cmocka_unit_test_setup_teardown(one_of_many_gets_it, setup, teardown),
        cmocka_unit_test_setup_teardown(waits_for_the_owner_to_leave, setup, teardown),
        cmocka_unit_test_setup_teardown(refuses_a_newer_one, setup, teardown),
        cmocka_unit_test_setup_teardown(refuses_a_foreign_one, setup, teardown),
        cmocka_unit_test_setup_teardown(refuses_what_is_no_database, setup, teardown),
        cmocka_unit_test_setup_teardown(says_why_it_cannot, setup, teardown),
        cmocka_unit_test_setup_teardown(takes_names_literally, setup, teardown),
        cmocka_unit_test_setup_teardown(migrates_step_by_step, setup, teardown),
        cmocka_unit_test_setup_teardown(opens_version_1, setup, teardown),
        cmocka_unit_test_setup_teardown(opens_version_3, setup, teardown),
        cmocka_unit_test_setup_teardown(has_an_identity_of_its_own, setup, teardown),
        cmocka_unit_test_setup_teardown(opens_an_older_one, setup, teardown),
        cmocka_unit_test_setup_teardown(refuses_other_tables, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
