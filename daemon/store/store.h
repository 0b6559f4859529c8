/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/store.h: the durable state of the service: jobs, their attempts and checkpoints (jobs.h),
 * what they contributed, and the fields' exact sums (fields.h). The only room that knows SQL.
 *
 *   A job      goes by  next      finish      fail              release,    cancel      retry
 *   is                                                          restart
 *   QUEUED              RUNNING   -           -                 -           CANCELLED   -
 *   RUNNING             -         DONE        WAITING, FAILED   QUEUED      (marked)    -
 *   RUNNING, marked     -         CANCELLED   CANCELLED         CANCELLED   (marked)    -
 *   WAITING             QUEUED when retry_at_ms has come        -           CANCELLED   -
 *   FAILED              -         -           -                 -           -           QUEUED
 *   CANCELLED           -         -           -                 -           CANCELLED   QUEUED
 *   DONE                for ever, or until store_retract makes a counted one RETRACTED: for ever
 *
 * "-" is STORE_WRONG_STATE. A running job that is told to cancel is only marked: its worker is to
 * be stopped, and whatever ends the attempt makes it CANCELLED.
 *
 * Threads: a store belongs to one thread at a time; calls are synchronous and may wait for the
 * disk. It is not to be used in a forked child.
 *
 * Durability: a call that changes something returns SHEAR_OK only when the change is on disk
 * (write-ahead log and fsync), and is atomic: after any failure or crash it has happened completely
 * or not at all. An error of the disk may come after the change was written: then a later start
 * finds the state after, else the state before; never between. Between store_begin and store_commit
 * the same calls only join the group, and all become durable by the one fsync of store_commit: no
 * reply to a client before that.
 *
 * Errors: SHEAR_OK, an enum shear_code, or one of enum store_code: those are conditions for
 * the direct caller, with the store sound and unchanged. SHEAR_E_IO, SHEAR_E_FULL and
 * SHEAR_E_NOMEM may pass (store_is_transient); SHEAR_E_FORMAT is a damaged database and
 * SHEAR_E_INTERNAL a bug: stop the service. On an error, out parameters are set to nothing (0,
 * NULL, empty).
 *
 * Time is the caller's: milliseconds since 1970, UTC. The store reads no clock.
 *
 * Texts: given texts are copied; they must be no longer than the limits of codes.h
 * (STORE_BAD_TEXT). Returned texts belong to the record they are in and live until its _deinit; all
 * may be NULL unless said otherwise. _deinit takes a zeroed or already deinited record, too.
 */
#ifndef SHEARD_STORE_H
#define SHEARD_STORE_H

#include "store/codes.h"
#include "store/fields.h"
#include "store/jobs.h"

/* ---- The database ---- */

typedef struct store_options {
    int busy_ms;     /* wait this long for another owner to leave (a restart); 0: refuse at once */
    const char *vfs; /* SQLite's VFS by name; NULL: the system's. Tests inject failures there. */
} store_options;

/* What store_open found and did. */
typedef struct store_opening {
    bool created;      /* there was no database */
    int version;       /* of the schema, now */
    int migrated_from; /* schema version before; the present one where nothing was migrated */
    int64_t requeued;  /* jobs that ran when the service died */
    int64_t cancelled; /* of those, the ones that had been told to cancel */
} store_opening;

/* Open the database at `path`, make it (mode 0600) where there is none, migrate an older one (in
 * one transaction), own it exclusively until store_close, and put the jobs that ran back into the
 * queue, their attempts marked interrupted at `now_ms`. `options` may be NULL. *s is NULL on error:
 * STORE_LOCKED, STORE_NEWER, SHEAR_E_FORMAT (not a database of ours, or damaged), SHEAR_E_IO,
 * SHEAR_E_NOMEM. A database that is refused is left as it was. */
int store_open(store **s, const char *path, const store_options *options, int64_t now_ms,
               shear_error *err);
/* Which database this is: hexadecimal digits, made by chance with the database. */
const char *store_identity(const store *s);
/* A group that is open is rolled back. NULL is accepted. */
void store_close(store *s);
const store_opening *store_opened(const store *s); /* lives as long as s */

/* Is every page well formed (SQLite's quick_check)? Time grows with the database. SHEAR_E_FORMAT
 * where not. */
int store_check(store *s, shear_error *err);
/* Does everything agree: the counts with the jobs, each counted job with one contribution, each
 * field's sums with the exact join of its contributions? For `doctor` and for tests: time grows
 * with the database. SHEAR_E_FORMAT where not. */
int store_audit(store *s, shear_error *err);

/* ---- Groups: many operations, one fsync ---- */

/* An operation that fails inside a group leaves the group as it was before that operation, and the
 * group goes on. After some errors of the disk SQLite gives up the whole group: from then on every
 * change in it fails with SHEAR_E_IO or, where the disk was full, SHEAR_E_FULL, and so does
 * store_commit. Groups do not nest (SHEAR_E_INTERNAL). */
int store_begin(store *s, shear_error *err);
/* SHEAR_OK: all changes since store_begin that returned SHEAR_OK are on disk. Else none of them
 * counts (see "Durability"), and the group is over in either case. */
int store_commit(store *s, shear_error *err);
void store_rollback(store *s); /* give the group up; nothing happens where none is open */

/* ---- Numbers ---- */

typedef struct store_counts {
    int64_t jobs[STORE_N_STATES]; /* kept jobs by state */
    int64_t unfinished;           /* queued + running + waiting */
} store_counts;
int store_count(store *s, store_counts *counts, shear_error *err);

/* Events since the database was made; retiring jobs does not lower them. */
typedef struct store_totals {
    int64_t submitted, counted, duplicates, failed, cancelled, retired; /* jobs */
    int64_t retracted; /* contributions, of those that were counted */
    int64_t attempts, interrupted;
    int64_t failures[4];      /* attempts by enum store_class */
    int64_t n_stamps, n_used; /* of counted jobs */
    int64_t elapsed_us;       /* of done jobs */
    int64_t fields;           /* records (name, settings) */
} store_totals;
int store_total(store *s, store_totals *totals, shear_error *err);

/* ---- Retention ---- */

typedef struct store_retention {
    int64_t finished_before_ms; /* jobs that finished before this; INT64_MIN: none for their age */
    int64_t keep;  /* at most so many finished jobs, the oldest go; negative: any number */
    int64_t batch; /* at most so many in this call */
} store_retention;
/* Forget finished jobs, oldest first. What they contributed stays counted and is still recognised.
 * Call again while *retired equals the batch. */
int store_retire(store *s, const store_retention *rule, int64_t *retired, shear_error *err);

#endif
