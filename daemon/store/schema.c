/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/schema.h"

#include "base/cleanup.h"

#include <stdio.h>

/* The numbers for state, outcome, origin, class and ending are those of codes.h.
 *
 * No statement may cost more because more jobs have finished: what is read often has an index that
 * holds only the few rows concerned (queue, waiting, pending), and what would have to be counted is
 * stored (counts, totals). */
static const char *const version_1[] = {
    /* uses: number of jobs and fields that refer to it */
    "CREATE TABLE settings("
    " digest TEXT NOT NULL PRIMARY KEY,"
    " text TEXT NOT NULL,"
    " uses INTEGER NOT NULL DEFAULT 0"
    ") STRICT, WITHOUT ROWID",

    /* AUTOINCREMENT: the id of a retired job is not used again. */
    "CREATE TABLE jobs("
    " id INTEGER PRIMARY KEY AUTOINCREMENT,"
    " state INTEGER NOT NULL DEFAULT 0 CHECK (state BETWEEN 0 AND 5),"
    " outcome INTEGER NOT NULL DEFAULT 0,"
    " origin INTEGER NOT NULL,"
    " priority INTEGER NOT NULL,"
    " forced INTEGER NOT NULL,"
    " cancel_asked INTEGER NOT NULL DEFAULT 0,"
    " owner INTEGER NOT NULL,"
    " attempts INTEGER NOT NULL DEFAULT 0,"
    " failures INTEGER NOT NULL DEFAULT 0,"
    " interrupted INTEGER NOT NULL DEFAULT 0,"
    " attempt INTEGER NOT NULL DEFAULT 0,"
    " created_ms INTEGER NOT NULL,"
    " started_ms INTEGER NOT NULL DEFAULT 0,"
    " finished_ms INTEGER NOT NULL DEFAULT 0,"
    " not_before_ms INTEGER NOT NULL DEFAULT 0,"
    " n_stamps INTEGER NOT NULL DEFAULT -1,"
    " n_used INTEGER NOT NULL DEFAULT -1,"
    " elapsed_us INTEGER NOT NULL DEFAULT 0,"
    " duplicate_of INTEGER NOT NULL DEFAULT 0,"
    " failure_class INTEGER NOT NULL DEFAULT 0,"
    " field TEXT," /* requested, or from the file */
    " field_asked TEXT,"
    " source TEXT NOT NULL,"
    " settings TEXT NOT NULL," /* digest */
    " idempotency_key TEXT,"
    " content TEXT,"
    " code TEXT,"
    " message TEXT,"
    " advice TEXT,"
    " result TEXT,"
    " catalogue TEXT"
    ") STRICT",
    /* For pages: each index ends in the id. */
    "CREATE INDEX jobs_state ON jobs(state)", "CREATE INDEX jobs_owner ON jobs(owner, state)",
    "CREATE INDEX jobs_field ON jobs(field, state)",
    "CREATE INDEX jobs_owner_field ON jobs(owner, field, state)",
    "CREATE UNIQUE INDEX jobs_key ON jobs(owner, idempotency_key)"
    " WHERE idempotency_key IS NOT NULL",
    "CREATE INDEX jobs_queue ON jobs(priority DESC, id) WHERE state = 0",
    "CREATE INDEX jobs_waiting ON jobs(not_before_ms) WHERE state = 2",
    "CREATE INDEX jobs_pending ON jobs(field, settings) WHERE state < 3",
    "CREATE INDEX jobs_finished ON jobs(finished_ms) WHERE state >= 3",

    "CREATE TABLE attempts("
    " job INTEGER NOT NULL REFERENCES jobs(id) ON DELETE CASCADE,"
    " number INTEGER NOT NULL,"
    " started_ms INTEGER NOT NULL,"
    " ended_ms INTEGER NOT NULL DEFAULT 0,"
    " ending INTEGER NOT NULL DEFAULT 0,"
    " failure_class INTEGER NOT NULL DEFAULT 0,"
    " code TEXT,"
    " message TEXT,"
    " PRIMARY KEY (job, number)"
    ") STRICT, WITHOUT ROWID",

    "CREATE TABLE checkpoints("
    " job INTEGER PRIMARY KEY REFERENCES jobs(id) ON DELETE CASCADE,"
    " next_block INTEGER NOT NULL,"
    " sums TEXT NOT NULL"
    ") STRICT",

    "CREATE TABLE fields("
    " id INTEGER PRIMARY KEY,"
    " name TEXT NOT NULL,"
    " settings TEXT NOT NULL," /* digest */
    " jobs INTEGER NOT NULL,"
    " n_stamps INTEGER NOT NULL,"
    " n_used INTEGER NOT NULL,"
    " updated_ms INTEGER NOT NULL,"
    " sums TEXT NOT NULL,"
    " UNIQUE (name, settings)"
    ") STRICT",

    /* Outlives its job, so that a duplicate is recognised after the job was retired: no foreign
       key. A forced job may have the identity of another one. A job has at most one row. */
    "CREATE TABLE contributions("
    " id INTEGER PRIMARY KEY,"
    " field INTEGER NOT NULL REFERENCES fields(id),"
    " job INTEGER NOT NULL UNIQUE,"
    " content TEXT NOT NULL,"
    " n_stamps INTEGER NOT NULL,"
    " n_used INTEGER NOT NULL,"
    " counted_ms INTEGER NOT NULL,"
    " sums TEXT NOT NULL"
    ") STRICT",
    "CREATE INDEX contributions_identity ON contributions(field, content)",
    "CREATE INDEX contributions_order ON contributions(field)",

    "CREATE TABLE counts(state INTEGER PRIMARY KEY, n INTEGER NOT NULL CHECK (n >= 0)) STRICT",
    "INSERT INTO counts VALUES (0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (5, 0)",

    "CREATE TABLE totals("
    " id INTEGER PRIMARY KEY CHECK (id = 1),"
    " submitted INTEGER NOT NULL DEFAULT 0,"
    " counted INTEGER NOT NULL DEFAULT 0,"
    " duplicates INTEGER NOT NULL DEFAULT 0,"
    " failed INTEGER NOT NULL DEFAULT 0,"
    " cancelled INTEGER NOT NULL DEFAULT 0,"
    " retired INTEGER NOT NULL DEFAULT 0,"
    " attempts INTEGER NOT NULL DEFAULT 0,"
    " interrupted INTEGER NOT NULL DEFAULT 0,"
    " failures_transient INTEGER NOT NULL DEFAULT 0,"
    " failures_data INTEGER NOT NULL DEFAULT 0,"
    " failures_bug INTEGER NOT NULL DEFAULT 0,"
    " n_stamps INTEGER NOT NULL DEFAULT 0,"
    " n_used INTEGER NOT NULL DEFAULT 0,"
    " elapsed_us INTEGER NOT NULL DEFAULT 0,"
    " fields INTEGER NOT NULL DEFAULT 0"
    ") STRICT",
    "INSERT INTO totals(id) VALUES (1)",

    /* Triggers, so that no change of a job can miss the numbers. */
    "CREATE TRIGGER job_added AFTER INSERT ON jobs BEGIN"
    " UPDATE counts SET n = n + 1 WHERE state = NEW.state;"
    " UPDATE totals SET submitted = submitted + 1 WHERE id = 1;"
    " UPDATE settings SET uses = uses + 1 WHERE digest = NEW.settings;"
    " END",
    "CREATE TRIGGER job_moved AFTER UPDATE OF state ON jobs WHEN NEW.state <> OLD.state BEGIN"
    " UPDATE counts SET n = n - 1 WHERE state = OLD.state;"
    " UPDATE counts SET n = n + 1 WHERE state = NEW.state;"
    " END",
    "CREATE TRIGGER job_finished AFTER UPDATE OF state ON jobs"
    " WHEN NEW.state <> OLD.state AND NEW.state >= 3 BEGIN"
    " UPDATE totals SET"
    "  counted = counted + (NEW.outcome = 1),"
    "  duplicates = duplicates + (NEW.outcome = 2),"
    "  failed = failed + (NEW.state = 4),"
    "  cancelled = cancelled + (NEW.state = 5),"
    "  n_stamps = n_stamps + iif(NEW.outcome = 1, NEW.n_stamps, 0),"
    "  n_used = n_used + iif(NEW.outcome = 1, NEW.n_used, 0),"
    "  elapsed_us = elapsed_us + NEW.elapsed_us"
    " WHERE id = 1;"
    " END",
    "CREATE TRIGGER job_retired AFTER DELETE ON jobs BEGIN"
    " UPDATE counts SET n = n - 1 WHERE state = OLD.state;"
    " UPDATE totals SET retired = retired + 1 WHERE id = 1;"
    " UPDATE settings SET uses = uses - 1 WHERE digest = OLD.settings;"
    " DELETE FROM settings WHERE digest = OLD.settings AND uses = 0;"
    " END",
    "CREATE TRIGGER attempt_opened AFTER INSERT ON attempts BEGIN"
    " UPDATE totals SET attempts = attempts + 1 WHERE id = 1;"
    " END",
    "CREATE TRIGGER attempt_closed AFTER UPDATE OF ending ON attempts BEGIN"
    " UPDATE totals SET"
    "  interrupted = interrupted + (NEW.ending = 5),"
    "  failures_transient = failures_transient + (NEW.failure_class = 1),"
    "  failures_data = failures_data + (NEW.failure_class = 2),"
    "  failures_bug = failures_bug + (NEW.failure_class = 3)"
    " WHERE id = 1;"
    " END",
    "CREATE TRIGGER field_added AFTER INSERT ON fields BEGIN"
    " UPDATE totals SET fields = fields + 1 WHERE id = 1;"
    " UPDATE settings SET uses = uses + 1 WHERE digest = NEW.settings;"
    " END",
    NULL};

/* The groups that a job's owner had when submitting, stored once for all jobs with the same ones.
 * NULL in jobs: not known (jobs of version 1, and files of the watch folder, which belong to the
 * service). */
static const char *const version_2[] = {
    "CREATE TABLE credentials("
    " id INTEGER PRIMARY KEY,"
    " gid INTEGER NOT NULL,"
    " supplementary TEXT NOT NULL,"
    " uses INTEGER NOT NULL DEFAULT 0,"
    " UNIQUE (gid, supplementary)"
    ") STRICT",
    /* No foreign key: deleting credentials would search all jobs. */
    "ALTER TABLE jobs ADD COLUMN credentials INTEGER",
    "CREATE TRIGGER credentials_used AFTER INSERT ON jobs WHEN NEW.credentials IS NOT NULL BEGIN"
    " UPDATE credentials SET uses = uses + 1 WHERE id = NEW.credentials;"
    " END",
    "CREATE TRIGGER credentials_left AFTER DELETE ON jobs WHEN OLD.credentials IS NOT NULL BEGIN"
    " UPDATE credentials SET uses = uses - 1 WHERE id = OLD.credentials;"
    " DELETE FROM credentials WHERE id = OLD.credentials AND uses = 0;"
    " END",
    NULL};

/* The terms of stamps for estimators that need them (shear_symmetry_bytes): of a checkpoint in
 * pieces that end before a block, of a contribution in parts of bounded size. */
static const char *const version_3[] = {
    "CREATE TABLE checkpoint_terms("
    " job INTEGER NOT NULL REFERENCES checkpoints(job) ON DELETE CASCADE,"
    " end_block INTEGER NOT NULL,"
    " bytes BLOB NOT NULL,"
    " UNIQUE (job, end_block)"
    ") STRICT",
    "CREATE TABLE contribution_terms("
    " contribution INTEGER NOT NULL REFERENCES contributions(id),"
    " part INTEGER NOT NULL,"
    " bytes BLOB NOT NULL,"
    " UNIQUE (contribution, part)"
    ") STRICT",
    NULL};

static const char *const version_4[] = {
    /* What the field's report needs; `account` is a text of the caller's. Older jobs that are still
       kept have a result, from which it is taken. */
    "ALTER TABLE contributions ADD COLUMN account TEXT",
    "ALTER TABLE contributions ADD COLUMN elapsed_us INTEGER NOT NULL DEFAULT 0",
    "ALTER TABLE contributions ADD COLUMN true_g1 REAL", /* null: not known */
    "ALTER TABLE contributions ADD COLUMN true_g2 REAL",
    "ALTER TABLE fields ADD COLUMN elapsed_us INTEGER NOT NULL DEFAULT 0",
    "UPDATE contributions SET (account, elapsed_us, true_g1, true_g2) ="
    " (SELECT json_extract(result, '$.files[0]'), elapsed_us,"
    "  json_extract(result, '$.truth.g1'), json_extract(result, '$.truth.g2')"
    "  FROM jobs WHERE id = contributions.job)"
    " WHERE EXISTS (SELECT 1 FROM jobs WHERE id = contributions.job AND json_valid(result))",
    "UPDATE fields SET elapsed_us = (SELECT coalesce(sum(elapsed_us), 0) FROM contributions"
    "  INDEXED BY contributions_order WHERE field = fields.id)",
    /* The first and last entry of a field show whether all its truths are the same. */
    "CREATE INDEX contributions_truth ON contributions(field, true_g1, true_g2)",
    "CREATE TRIGGER contribution_added AFTER INSERT ON contributions BEGIN"
    " UPDATE fields SET elapsed_us = elapsed_us + NEW.elapsed_us WHERE id = NEW.field;"
    " END",
    "CREATE TRIGGER contribution_left AFTER DELETE ON contributions BEGIN"
    " UPDATE fields SET elapsed_us = elapsed_us - OLD.elapsed_us WHERE id = OLD.field;"
    " END",

    /* Why jobs wait: read often, while there may be very many of them. */
    "CREATE INDEX jobs_waiting_reason ON jobs(code, not_before_ms, attempts, state) WHERE state = "
    "2",

    /* Names of dropped files, retracted jobs, and the database's identity. A check cannot be
       altered, so its text is changed as SQLite's ALTER TABLE page describes (it describes no bytes
       on disk). */
    "PRAGMA writable_schema = ON",
    "UPDATE sqlite_schema SET sql = replace(sql, 'CHECK (state BETWEEN 0 AND 5)',"
    " 'CHECK (state BETWEEN 0 AND 6)') WHERE type = 'table' AND name = 'jobs'",
    "PRAGMA writable_schema = RESET", "INSERT INTO counts VALUES (6, 0)",

    /* Random and permanent: what belongs to the database but is outside it (catalogs) is marked
       with it. */
    "CREATE TABLE identity(id INTEGER PRIMARY KEY CHECK (id = 1), text TEXT NOT NULL) STRICT",
    "INSERT INTO identity VALUES (1, lower(hex(randomblob(16))))",

    /* dropped: name in incoming/. resting: where the file of a final job is ("failed/NAME");
       resting_print: its fingerprint. NULL: not known, or no such file. */
    "ALTER TABLE jobs ADD COLUMN dropped TEXT", "ALTER TABLE jobs ADD COLUMN resting TEXT",
    "ALTER TABLE jobs ADD COLUMN resting_print TEXT",
    "UPDATE jobs SET dropped = substr(old.path, instr(old.path, old.mark) + length(old.mark))"
    " FROM (SELECT id, '/active/' || idempotency_key || '-' AS mark,"
    "  iif(json_valid(source), json_extract(source, '$.path'), NULL) AS path"
    "  FROM jobs WHERE origin = 0) AS old"
    " WHERE jobs.id = old.id AND instr(old.path, old.mark) > 0",

    "ALTER TABLE totals ADD COLUMN retracted INTEGER NOT NULL DEFAULT 0",
    /* catalogs of retracted jobs, until their files are removed */
    "CREATE INDEX jobs_leftover ON jobs(id) WHERE state = 6 AND catalogue IS NOT NULL",
    "DROP TRIGGER job_finished",
    "CREATE TRIGGER job_finished AFTER UPDATE OF state ON jobs"
    " WHEN OLD.state < 3 AND NEW.state >= 3 BEGIN"
    " UPDATE totals SET"
    "  counted = counted + (NEW.outcome = 1),"
    "  duplicates = duplicates + (NEW.outcome = 2),"
    "  failed = failed + (NEW.state = 4),"
    "  cancelled = cancelled + (NEW.state = 5),"
    "  n_stamps = n_stamps + iif(NEW.outcome = 1, NEW.n_stamps, 0),"
    "  n_used = n_used + iif(NEW.outcome = 1, NEW.n_used, 0),"
    "  elapsed_us = elapsed_us + NEW.elapsed_us"
    " WHERE id = 1;"
    " END",
    "CREATE TRIGGER contribution_removed BEFORE DELETE ON contributions BEGIN"
    " DELETE FROM contribution_terms WHERE contribution = OLD.id;"
    " UPDATE totals SET retracted = retracted + 1 WHERE id = 1;"
    " END",
    "CREATE TRIGGER field_removed AFTER DELETE ON fields BEGIN"
    " UPDATE totals SET fields = fields - 1 WHERE id = 1;"
    " UPDATE settings SET uses = uses - 1 WHERE digest = OLD.settings;"
    " DELETE FROM settings WHERE digest = OLD.settings AND uses = 0;"
    " END",
    NULL};

static const char *const version_5[] = {
    /* Removed fields whose contributions are still to be removed, and so refer to no field. A
       foreign key cannot be altered; its text is changed like that of the check above. */
    "CREATE TABLE forgotten("
    " id INTEGER PRIMARY KEY AUTOINCREMENT,"
    " field INTEGER NOT NULL UNIQUE,"
    " name TEXT NOT NULL"
    ") STRICT",
    "PRAGMA writable_schema = ON",
    "UPDATE sqlite_schema SET sql = replace(sql, ' REFERENCES fields(id)', '')"
    " WHERE type = 'table' AND name = 'contributions'",
    "PRAGMA writable_schema = RESET", NULL};

/* The noise level, the stamp that counts most, and a seventh number in a stamp's terms. */
static const char *const version_6[] = {
    /* Null: not known, as for all contributions of older versions. The index finds a field's
       largest value, and whether one is null. */
    "ALTER TABLE contributions ADD COLUMN top_size REAL",
    "ALTER TABLE contributions ADD COLUMN top_stamp INTEGER",
    "CREATE INDEX contributions_top ON contributions(field, top_size DESC, top_stamp)",
    /* The size of a stamp's terms in the row. Old rows are not converted: there may be gigabytes of
       them. */
    "ALTER TABLE contribution_terms ADD COLUMN stamp_bytes INTEGER NOT NULL DEFAULT 48",
    /* A job that resumed from sums without noise parts would have a wrong noise level: jobs that
       were stopped begin again. */
    "DELETE FROM checkpoint_terms", "DELETE FROM checkpoints", NULL};

const schema_step schema_steps[SCHEMA_VERSION] = {version_1, version_2, version_3,
                                                  version_4, version_5, version_6};

static int take_step(sqlite3 *db, const char *path, schema_step step, shear_error *err) {
    for (const char *const *sql = step; *sql != NULL; sql++)
        TRY(database_exec(db, path, *sql, err));
    return SHEAR_OK;
}

static int take_steps(sqlite3 *db, const char *path, const schema_step *steps, int from, int to,
                      shear_error *err) {
    char stamp[96];
    for (int v = from; v < to; v++) {
        const int code = take_step(db, path, steps[v], err);
        if (code != SHEAR_OK) {
            shear_prefix(err, code, "schema version %d to %d", v, v + 1);
            return code;
        }
    }
    snprintf(stamp, sizeof stamp, "PRAGMA application_id = %d; PRAGMA user_version = %d",
             SCHEMA_APPLICATION, to);
    return database_exec(db, path, stamp, err);
}

int schema_migrate(sqlite3 *db, const char *path, const schema_step *steps, int from, int to,
                   shear_error *err) {
    sqlite3_db_config(db, SQLITE_DBCONFIG_DEFENSIVE, 0, NULL);
    const int code = take_steps(db, path, steps, from, to, err);
    sqlite3_db_config(db, SQLITE_DBCONFIG_DEFENSIVE, 1, NULL);
    return code;
}
