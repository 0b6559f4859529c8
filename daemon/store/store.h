/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/store.h: the durable state of the service: jobs, their attempts and checkpoints (jobs.h),
 * their contributions, and the fields' exact sums (fields.h). The only room that uses SQL.
 *
 *   A job      becomes  next      finish      fail              release,    cancel      retry
 *   that is    by                                               restart
 *   QUEUED              RUNNING   -           -                 -           CANCELLED   -
 *   RUNNING             -         DONE        WAITING, FAILED   QUEUED      (marked)    -
 *   RUNNING, marked     -         CANCELLED   CANCELLED         CANCELLED   (marked)    -
 *   WAITING             QUEUED at retry_at_ms                   -           CANCELLED   -
 *   FAILED              -         -           -                 -           -           QUEUED
 *   CANCELLED           -         -           -                 -           CANCELLED   QUEUED
 *   DONE                stays; store_retract makes a counted one RETRACTED, which stays
 *
 * "-" is STORE_WRONG_STATE. Cancelling a running job only marks it: its worker has to be stopped,
 * and whatever ends the attempt makes the job CANCELLED.
 *
 * Threads: a store belongs to one thread at a time. Calls are synchronous and may wait for the
 * disk. A store must not be used in a forked child.
 *
 * Durability: a call that changes something returns SHEAR_OK only when the change is on disk
 * (write-ahead log and fsync), and is atomic: after a failure or crash the change is there
 * completely or not at all. If the disk reports an error after the change was written, the next
 * start finds the state either before or after the change. Between store_begin and store_commit the
 * calls join the group, and become durable together by the one fsync of store_commit: reply to
 * clients only after that.
 *
 * Errors: SHEAR_OK, an enum shear_code, or an enum store_code. The latter are conditions for the
 * direct caller; the store is sound and unchanged. SHEAR_E_IO, SHEAR_E_FULL and SHEAR_E_NOMEM may
 * be transient (store_is_transient). SHEAR_E_FORMAT is a damaged database and SHEAR_E_INTERNAL a
 * bug: stop the service. On error, out parameters are set to 0, NULL or empty.
 *
 * Times are the caller's: milliseconds since 1970, UTC. The store reads no clock.
 *
 * Texts: arguments are copied and must not be longer than the limits of codes.h (STORE_BAD_TEXT).
 * Returned texts belong to their record and live until its _deinit; they may be NULL unless said
 * otherwise. _deinit accepts a zeroed or already deinited record. */
#pragma once

#include "store/codes.h"
#include "store/fields.h"
#include "store/jobs.h"

/* ---- The database ---- */

typedef struct store_options {
    int busy_ms;     /* how long to wait for another owner to leave (a restart); 0: fail at once */
    const char *vfs; /* name of SQLite's VFS; NULL: the default. Tests inject failures by it. */
} store_options;

/* What store_open found and changed. */
typedef struct store_opening {
    bool created;      /* there was no database */
    int version;       /* present version of the schema */
    int migrated_from; /* version of the schema before; the present one if it was not migrated */
    int64_t requeued;  /* jobs that were running when the service died: queued again, */
    int64_t cancelled; /* or cancelled, if they were marked so */
} store_opening;

/* Open the database at `path` and own it exclusively until store_close. Make it (mode 0600) if it
 * is missing, migrate an older one (in one transaction), and put the jobs that were running back
 * into the queue, their attempts marked interrupted at `now_ms`. `options` may be NULL. *s is NULL
 * on error: STORE_LOCKED, STORE_NEWER, SHEAR_E_FORMAT (damaged, or not a database of the service),
 * SHEAR_E_IO, SHEAR_E_FULL, SHEAR_E_NOMEM. A database that is refused is unchanged. */
int store_open(store **s, const char *path, const store_options *options, int64_t now_ms,
               shear_error *err);
/* Return the database's identity: 32 random hexadecimal digits, made with the database. */
const char *store_identity(const store *s);
/* Close the database; an open group is rolled back. NULL is accepted. */
void store_close(store *s);
const store_opening *store_opened(const store *s); /* lives as long as s */

/* ---- Groups: many operations, one fsync ---- */

/* Open a group. An operation that fails inside it leaves the group as it was before that operation,
 * and the group continues. After some disk errors SQLite rolls back the whole group: every later
 * change in it, and store_commit, fails with SHEAR_E_FULL if the disk was full, or SHEAR_E_IO.
 * Groups do not nest (SHEAR_E_INTERNAL). */
int store_begin(store *s, shear_error *err);
/* Commit and end the group. SHEAR_OK: all changes since store_begin that returned SHEAR_OK are on
 * disk. On error none of them is (see "Durability"); the group has ended, too. */
int store_commit(store *s, shear_error *err);
void store_rollback(store *s); /* give up the group, if one is open */

/* ---- Numbers ---- */

typedef struct store_counts {
    int64_t jobs[STORE_N_STATES]; /* kept jobs by state */
    int64_t unfinished;           /* queued + running + waiting */
} store_counts;
int store_count(store *s, store_counts *counts, shear_error *err);

/* Counts of events since the database was made; retiring jobs does not lower them. */
typedef struct store_totals {
    int64_t submitted, counted, duplicates, failed, cancelled, retired; /* jobs */
    int64_t retracted; /* contributions retracted, out of those counted */
    int64_t attempts, interrupted;
    int64_t failures[4];      /* attempts, by enum store_class */
    int64_t n_stamps, n_used; /* of counted jobs */
    int64_t elapsed_us;       /* of done jobs */
    int64_t fields;           /* records (name and settings) */
} store_totals;
int store_total(store *s, store_totals *totals, shear_error *err);

/* ---- Retention ---- */

typedef struct store_retention {
    int64_t finished_before_ms; /* retire jobs that finished before; INT64_MIN: none by age */
    int64_t keep;  /* finished jobs to keep, the oldest are retired first; negative: all */
    int64_t batch; /* most jobs to retire in this call */
} store_retention;
/* Retire finished jobs, oldest first. Their contributions stay counted and are still recognised.
 * Call again while *retired equals the batch. */
int store_retire(store *s, const store_retention *rule, int64_t *retired, shear_error *err);
