/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/sql.h: the statements that the store runs on jobs and fields, by name.
 *
 * INDEXED BY makes the query plan part of the statement: without the index it does not compile, so
 * no change of the schema can turn it into a scan unnoticed. States are literals because SQLite
 * uses a partial index only if the statement repeats the index's condition. */
#pragma once

#define FIELD_RECORD                                                                               \
    "SELECT f.name, f.settings, t.text, f.sums, f.jobs, f.n_stamps, f.n_used,"                     \
    " (SELECT count(*) FROM jobs INDEXED BY jobs_pending"                                          \
    "   WHERE field = f.name AND settings = f.settings AND state < 3),"                            \
    " f.updated_ms, f.elapsed_us FROM fields f CROSS JOIN settings t ON t.digest = f.settings"

#define JOB_IDS(index, condition)                                                                  \
    "SELECT id FROM jobs INDEXED BY " index " WHERE state = ?1 AND id < ?2" condition              \
    " ORDER BY id DESC LIMIT ?3"

#define SQL_STATEMENTS(X)                                                                          \
    X(SQL_BEGIN, "BEGIN IMMEDIATE")                                                                \
    X(SQL_COMMIT, "COMMIT")                                                                        \
    X(SQL_ROLLBACK, "ROLLBACK")                                                                    \
    X(SQL_SAVEPOINT, "SAVEPOINT operation")                                                        \
    X(SQL_RELEASE, "RELEASE operation")                                                            \
    X(SQL_ROLLBACK_TO, "ROLLBACK TO operation")                                                    \
                                                                                                   \
    X(SQL_IDENTITY, "SELECT text FROM identity WHERE id = 1")                                      \
    X(SQL_UNFINISHED, "SELECT sum(n) FROM counts WHERE state < 3")                                 \
    X(SQL_KEY_FIND,                                                                                \
      "SELECT id, source = ?3 AND settings = ?4 AND field_asked IS ?5 AND origin = ?6"             \
      " AND priority = ?7 AND forced = ?8"                                                         \
      " FROM jobs INDEXED BY jobs_key WHERE owner = ?1 AND idempotency_key = ?2")                  \
    X(SQL_DROPPED_FIND, "SELECT id, dropped IS NOT NULL FROM jobs INDEXED BY jobs_key"             \
                        " WHERE owner = ?1 AND idempotency_key = ?2 AND origin = 0")               \
    X(SQL_DROPPED_SET, "UPDATE jobs SET dropped = ?2 WHERE id = ?1")                               \
    X(SQL_SETTINGS_FIND, "SELECT text = ?2 FROM settings WHERE digest = ?1")                       \
    X(SQL_SETTINGS_ADD, "INSERT INTO settings(digest, text) VALUES (?1, ?2)")                      \
    X(SQL_CREDENTIALS_FIND, "SELECT id FROM credentials WHERE gid = ?1 AND supplementary = ?2")    \
    X(SQL_CREDENTIALS_ADD, "INSERT INTO credentials(gid, supplementary) VALUES (?1, ?2)")          \
    X(SQL_JOB_ADD,                                                                                 \
      "INSERT INTO jobs(owner, idempotency_key, source, settings, field, field_asked,"             \
      " origin, priority, forced, created_ms, credentials, dropped)"                               \
      " VALUES (?1, ?2, ?3, ?4, ?5, ?5, ?6, ?7, ?8, ?9, nullif(?10, 0), ?11)")                     \
                                                                                                   \
    X(SQL_WAKE, "UPDATE jobs INDEXED BY jobs_waiting SET state = 0, not_before_ms = 0"             \
                " WHERE state = 2 AND not_before_ms <= ?1")                                        \
    X(SQL_NEXT, "SELECT id FROM jobs INDEXED BY jobs_queue WHERE state = 0"                        \
                " ORDER BY priority DESC, id LIMIT 1")                                             \
    X(SQL_START, "UPDATE jobs SET state = 1, attempts = attempts + 1, attempt = attempt + 1,"      \
                 " started_ms = ?2 WHERE id = ?1")                                                 \
    X(SQL_RETRY_WAITING, "UPDATE jobs INDEXED BY jobs_waiting SET not_before_ms = ?1"              \
                         " WHERE state = 2 AND not_before_ms > ?1 AND code = ?2")                  \
    X(SQL_DUE, "SELECT not_before_ms FROM jobs INDEXED BY jobs_waiting WHERE state = 2"            \
               " ORDER BY not_before_ms LIMIT 1")                                                  \
    X(SQL_WAITING_SHIFT, "UPDATE jobs INDEXED BY jobs_waiting"                                     \
                         " SET not_before_ms = max(1, min(not_before_ms + ?1, ?2))"                \
                         " WHERE state = 2")                                                       \
    X(SQL_FINISHED_CLAMP, "UPDATE jobs SET finished_ms = ?1 WHERE id IN"                           \
                          " (SELECT id FROM jobs INDEXED BY jobs_finished"                         \
                          "  WHERE state >= 3 AND finished_ms > ?1)")                              \
    X(SQL_WAITING_REASONS,                                                                         \
      "SELECT coalesce(w.code, ''), count(*), max(w.attempts), min(w.not_before_ms),"              \
      " (SELECT message FROM jobs INDEXED BY jobs_waiting_reason"                                  \
      "   WHERE state = 2 AND code IS w.code ORDER BY not_before_ms LIMIT 1)"                      \
      " FROM jobs w INDEXED BY jobs_waiting_reason WHERE w.state = 2 GROUP BY w.code LIMIT ?1")    \
    X(SQL_RUNNING, "SELECT id FROM jobs INDEXED BY jobs_state WHERE state = 1 LIMIT 1")            \
    X(SQL_REQUEUE, "UPDATE jobs SET state = 0, interrupted = interrupted + ?2 WHERE id = ?1")      \
    X(SQL_ATTEMPT_OPEN, "INSERT INTO attempts(job, number, started_ms)"                            \
                        " SELECT id, attempt, ?2 FROM jobs WHERE id = ?1")                         \
    X(SQL_ATTEMPT_PRUNE, "DELETE FROM attempts WHERE job = ?1"                                     \
                         " AND number <= (SELECT attempt FROM jobs WHERE id = ?1) - ?2")           \
    X(SQL_ATTEMPT_CLOSE, "UPDATE attempts SET ended_ms = ?2, ending = ?3, failure_class = ?4,"     \
                         " code = ?5, message = ?6"                                                \
                         " WHERE job = ?1 AND number = (SELECT attempt FROM jobs WHERE id = ?1)")  \
                                                                                                   \
    X(SQL_JOB_STATE, "SELECT state FROM jobs WHERE id = ?1")                                       \
    X(SQL_JOB_ROW, "SELECT state, cancel_asked, forced, field, settings, content"                  \
                   " FROM jobs WHERE id = ?1")                                                     \
    X(SQL_JOB_SET_INPUT,                                                                           \
      "UPDATE jobs SET field = coalesce(?2, field), content = coalesce(?3, content),"              \
      " n_stamps = iif(?4 < 0, n_stamps, ?4) WHERE id = ?1")                                       \
    X(SQL_JOB_DONE,                                                                                \
      "UPDATE jobs SET state = 3, outcome = ?2, duplicate_of = ?3, n_stamps = ?4,"                 \
      " n_used = ?5, elapsed_us = ?6, finished_ms = ?7, result = ?8, catalogue = ?9,"              \
      " failure_class = 0, code = NULL, message = NULL, advice = NULL WHERE id = ?1")              \
    X(SQL_JOB_FAIL, "UPDATE jobs SET state = ?2, not_before_ms = ?3, finished_ms = ?4,"            \
                    " failure_class = ?5, code = ?6, message = ?7, advice = ?8, cancel_asked = 0," \
                    " failures = failures + 1 WHERE id = ?1")                                      \
    X(SQL_JOB_CANCEL, "UPDATE jobs SET state = 5, cancel_asked = 0, not_before_ms = 0,"            \
                      " finished_ms = ?2 WHERE id = ?1")                                           \
    X(SQL_JOB_ASK_CANCEL, "UPDATE jobs SET cancel_asked = 1 WHERE id = ?1")                        \
    X(SQL_JOB_RETRY, "UPDATE jobs SET state = 0, finished_ms = 0, attempts = 0, failures = 0,"     \
                     " interrupted = 0, failure_class = 0, code = NULL, message = NULL,"           \
                     " advice = NULL, resting = NULL, resting_print = NULL WHERE id = ?1")         \
    X(SQL_JOB_SET_DISPOSAL, "UPDATE jobs SET resting = ?2, resting_print = ?3 WHERE id = ?1")      \
    X(SQL_CHECKPOINT_SET, "INSERT INTO checkpoints(job, next_block, sums) VALUES (?1, ?2, ?3)"     \
                          " ON CONFLICT (job) DO UPDATE SET next_block = ?2, sums = ?3")           \
    X(SQL_CHECKPOINT_GET, "SELECT next_block, sums FROM checkpoints WHERE job = ?1")               \
    X(SQL_CHECKPOINT_DROP, "DELETE FROM checkpoints WHERE job = ?1")                               \
    X(SQL_CHECKPOINT_TERMS_END,                                                                    \
      "SELECT coalesce(max(end_block), 0) FROM checkpoint_terms WHERE job = ?1")                   \
    X(SQL_CHECKPOINT_TERMS_CUT, "DELETE FROM checkpoint_terms WHERE job = ?1 AND end_block > ?2")  \
    X(SQL_CHECKPOINT_TERMS_ADD,                                                                    \
      "INSERT INTO checkpoint_terms(job, end_block, bytes) VALUES (?1, ?2, ?3)")                   \
    X(SQL_CHECKPOINT_TERMS,                                                                        \
      "SELECT bytes, ?2 FROM checkpoint_terms WHERE job = ?1 ORDER BY end_block")                  \
                                                                                                   \
    X(SQL_JOB_RETRACT, "UPDATE jobs SET state = 6, outcome = 0 WHERE id = ?1")                     \
    X(SQL_LEFTOVER, "SELECT id, catalogue FROM jobs INDEXED BY jobs_leftover"                      \
                    " WHERE state = 6 AND catalogue IS NOT NULL AND id > ?1 ORDER BY id LIMIT 1")  \
    X(SQL_CATALOG_GONE, "UPDATE jobs SET catalogue = NULL WHERE id = ?1 AND state = 6")            \
                                                                                                   \
    X(SQL_COUNTED_FIND,                                                                            \
      "SELECT c.job, c.n_stamps, c.n_used FROM fields f CROSS JOIN contributions c"                \
      " INDEXED BY contributions_identity"                                                         \
      " ON c.field = f.id WHERE f.name = ?1 AND f.settings = ?2"                                   \
      " AND c.content = ?3 ORDER BY c.id LIMIT 1")                                                 \
    X(SQL_FIELD_FIND, "SELECT id, sums FROM fields WHERE name = ?1 AND settings = ?2")             \
    /* The new id is not that of a forgotten field whose contributions still exist. */             \
    X(SQL_FIELD_ADD,                                                                               \
      "INSERT INTO fields(id, name, settings, sums, n_stamps, n_used, updated_ms, jobs)"           \
      " VALUES (1 + max((SELECT coalesce(max(id), 0) FROM fields),"                                \
      "  (SELECT coalesce(max(field), 0) FROM forgotten)), ?1, ?2, ?3, ?4, ?5, ?6, 1)")            \
    X(SQL_FIELD_JOIN,                                                                              \
      "UPDATE fields SET sums = ?2, n_stamps = n_stamps + ?3, n_used = n_used + ?4,"               \
      " updated_ms = max(updated_ms, ?5), jobs = jobs + 1 WHERE id = ?1")                          \
    /* after the contribution has been removed */                                                  \
    X(SQL_FIELD_LEAVE,                                                                             \
      "UPDATE fields SET sums = ?2, n_stamps = n_stamps - ?3, n_used = n_used - ?4,"               \
      " jobs = jobs - 1, updated_ms = iif(updated_ms > ?5, updated_ms, (SELECT max(counted_ms)"    \
      "  FROM contributions INDEXED BY contributions_order WHERE field = ?1)) WHERE id = ?1")      \
    X(SQL_FIELD_DROP, "DELETE FROM fields WHERE id = ?1")                                          \
    X(SQL_FIELD_ROWS, "SELECT id, settings, jobs FROM fields WHERE name = ?1 AND settings > ?2"    \
                      " ORDER BY settings LIMIT 1")                                                \
    X(SQL_FIELD_UNFINISHED, "SELECT count(*) FROM jobs INDEXED BY jobs_pending"                    \
                            " WHERE field = ?1 AND settings = ?2 AND state < 3")                   \
    X(SQL_CONTRIBUTION_ADD,                                                                        \
      "INSERT INTO contributions(field, job, content, sums, n_stamps, n_used,"                     \
      " counted_ms, elapsed_us, account, true_g1, true_g2, top_size, top_stamp)"                   \
      " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13)")                          \
    X(SQL_CONTRIBUTION_OF, "SELECT c.id, c.field, c.n_stamps, c.n_used, c.counted_ms,"             \
                           " coalesce(f.jobs, 0), c.sums, f.sums FROM contributions c"             \
                           " LEFT JOIN fields f ON f.id = c.field WHERE c.job = ?1")               \
    X(SQL_CONTRIBUTION_DROP, "DELETE FROM contributions WHERE id = ?1")                            \
                                                                                                   \
    X(SQL_FORGOTTEN_ADD, "INSERT INTO forgotten(field, name) VALUES (?1, ?2)")                     \
    X(SQL_FORGOTTEN_NEXT,                                                                          \
      "SELECT g.id, g.name, c.id, c.job, j.id IS NOT NULL, j.catalogue FROM forgotten g"           \
      " LEFT JOIN contributions c INDEXED BY contributions_order ON c.field = g.field"             \
      " LEFT JOIN jobs j ON j.id = c.job WHERE g.id > 0 ORDER BY g.id LIMIT 1")                    \
    X(SQL_FORGOTTEN_DROP, "DELETE FROM forgotten WHERE id = ?1")                                   \
                                                                                                   \
    /* one null (not known) makes the result null */                                               \
    X(SQL_FIELD_TOP,                                                                               \
      "SELECT iif(EXISTS (SELECT 1 FROM contributions INDEXED BY contributions_top"                \
      "   WHERE field = ?1 AND top_size IS NULL), NULL, top_size), top_stamp, account"             \
      " FROM contributions INDEXED BY contributions_top"                                           \
      " WHERE field = ?1 ORDER BY top_size DESC, top_stamp LIMIT 1")                               \
                                                                                                   \
    X(SQL_TERMS_ADD, "INSERT INTO contribution_terms(contribution, part, bytes, stamp_bytes)"      \
                     " VALUES (?1, ?2, ?3, ?4)")                                                   \
    X(SQL_FIELD_TERMS,                                                                             \
      "SELECT t.bytes, t.stamp_bytes FROM contributions c INDEXED BY contributions_order"          \
      " CROSS JOIN contribution_terms t ON t.contribution = c.id"                                  \
      " WHERE c.field = ?1 ORDER BY c.id, t.part")                                                 \
                                                                                                   \
    X(SQL_LAST_JOB, "SELECT seq FROM sqlite_sequence WHERE name = 'jobs'")                         \
    /* in the order in which job_record.c reads store_job's members */                             \
    X(SQL_JOB_GET,                                                                                 \
      "SELECT id, state, outcome, origin, priority, forced, cancel_asked, owner,"                  \
      " attempts, failures, interrupted, attempt, created_ms, started_ms, finished_ms,"            \
      " not_before_ms, n_stamps, n_used, elapsed_us, duplicate_of, failure_class,"                 \
      " (SELECT gid FROM credentials WHERE id = jobs.credentials),"                                \
      " field, source, t.text, settings, idempotency_key, content, code, message,"                 \
      " advice, result, catalogue,"                                                                \
      " (SELECT supplementary FROM credentials WHERE id = jobs.credentials),"                      \
      " dropped, resting, resting_print"                                                           \
      " FROM jobs CROSS JOIN settings t ON t.digest = settings WHERE id = ?1")                     \
    X(SQL_JOBS_BY_STATE, JOB_IDS("jobs_state", ""))                                                \
    X(SQL_JOBS_BY_OWNER, JOB_IDS("jobs_owner", " AND owner = ?4"))                                 \
    X(SQL_JOBS_BY_FIELD, JOB_IDS("jobs_field", " AND field = ?4"))                                 \
    X(SQL_JOBS_BY_BOTH, JOB_IDS("jobs_owner_field", " AND owner = ?4 AND field = ?5"))             \
    X(SQL_ATTEMPTS, "SELECT number, started_ms, ended_ms, ending, failure_class, code, message"    \
                    " FROM attempts WHERE job = ?1 ORDER BY number")                               \
    X(SQL_FIELD_GET, FIELD_RECORD " WHERE f.name = ?1 ORDER BY f.settings LIMIT ?2")               \
    X(SQL_FIELD_PENDING, "SELECT count(*) FROM jobs INDEXED BY jobs_pending"                       \
                         " WHERE field = ?1 AND state < 3")                                        \
    X(SQL_FIELDS, FIELD_RECORD " WHERE (f.name, f.settings) > (?1, ?2)"                            \
                               " ORDER BY f.name, f.settings LIMIT ?3")                            \
    /* nulls (no truth) sort first */                                                              \
    X(SQL_FIELD_LEAST_TRUTH,                                                                       \
      "SELECT true_g1, true_g2 FROM contributions INDEXED BY contributions_truth"                  \
      " WHERE field = ?1 ORDER BY true_g1, true_g2 LIMIT 1")                                       \
    X(SQL_FIELD_GREATEST_TRUTH,                                                                    \
      "SELECT true_g1, true_g2 FROM contributions INDEXED BY contributions_truth"                  \
      " WHERE field = ?1 ORDER BY true_g1 DESC, true_g2 DESC LIMIT 1")                             \
    X(SQL_CONTRIBUTIONS, "SELECT id, job, content, n_stamps, n_used, counted_ms, account"          \
                         " FROM contributions INDEXED BY contributions_order"                      \
                         " WHERE field = ?1 AND id > ?2 ORDER BY id LIMIT ?3")                     \
    X(SQL_CONTRIBUTION_SUMS, "SELECT sums FROM contributions WHERE id = ?1")                       \
    X(SQL_COUNTS, "SELECT state, n FROM counts")                                                   \
    /* in the order in which numbers.c reads store_totals' members */                              \
    X(SQL_TOTALS, "SELECT submitted, counted, duplicates, failed, cancelled, retired, attempts,"   \
                  " interrupted, 0, failures_transient, failures_data, failures_bug, n_stamps,"    \
                  " n_used, elapsed_us, fields, retracted FROM totals WHERE id = 1")               \
                                                                                                   \
    X(SQL_RETIRE, "DELETE FROM jobs WHERE id IN (SELECT id FROM jobs INDEXED BY jobs_finished"     \
                  " WHERE state >= 3 AND finished_ms < ?1 ORDER BY finished_ms, id LIMIT ?2)")

#define SQL_NAME(name, text) name,
enum sql { SQL_STATEMENTS(SQL_NAME) SQL_N };
#undef SQL_NAME

extern const char *const sql_texts[SQL_N];
