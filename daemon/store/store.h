/* SPDX-License-Identifier: GPL-3.0-or-later */
/* daemon/store/store.h: the durable state of the service: jobs, their attempts and checkpoints,
 * what they contributed, and the fields' exact sums. The only room that knows SQL.
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
 * Errors: SHEAR_OK, an enum shear_code, or one of enum store_code below: those are conditions for
 * the direct caller, with the store sound and unchanged. SHEAR_E_IO, SHEAR_E_FULL and
 * SHEAR_E_NOMEM may pass (store_is_transient); SHEAR_E_FORMAT is a damaged database and
 * SHEAR_E_INTERNAL a bug: stop the service. On an error, out parameters are set to nothing (0,
 * NULL, empty).
 *
 * Time is the caller's: milliseconds since 1970, UTC. The store reads no clock.
 *
 * Texts: given texts are copied; they must be no longer than the limits below (STORE_BAD_TEXT).
 * Returned texts belong to the record they are in and live until its _deinit; all may be NULL
 * unless said otherwise. _deinit takes a zeroed or already deinited record, too.
 */
#ifndef SHEARD_STORE_H
#define SHEARD_STORE_H

#include "shear/error.h"
#include "shear/symmetry.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum store_code {
    STORE_QUEUE_FULL = 100, /* as many unfinished jobs as the caller allows */
    STORE_KEY_REUSED,       /* the owner used this idempotency key for another request */
    STORE_NOT_FOUND,        /* no such job, field or checkpoint */
    STORE_WRONG_STATE,      /* the job's state does not allow this */
    STORE_BAD_TEXT,         /* a text is longer than its limit, or empty where it must not be */
    STORE_LOCKED,           /* another process owns this database */
    STORE_NEWER             /* a newer version of the service wrote this database */
};

/* Bytes without the final NUL. */
enum {
    STORE_FIELD_MAX = 255,
    STORE_DIGEST_MAX = 128, /* settings digest, content checksum */
    STORE_KEY_MAX = 128,
    STORE_SOURCE_MAX = 65536,
    STORE_GROUPS_MAX = 1 << 20,
    STORE_SETTINGS_MAX = 65536,
    STORE_RESULT_MAX = 262144,
    STORE_ACCOUNT_MAX = 131072, /* of a contribution */
    STORE_PATH_MAX = 4096,      /* catalog */
    STORE_CODE_MAX = 64,
    STORE_MESSAGE_MAX = 1024,
    STORE_ADVICE_MAX = 1024,
    STORE_SUMS_MAX = 65536,
    STORE_PAGE_MAX = 1000,   /* records in a page: a larger limit is taken as this */
    STORE_ATTEMPTS_KEPT = 64 /* of a job, the last ones */
};

/* These numbers are on disk: never renumber. */
enum store_state {
    STORE_QUEUED = 0,
    STORE_RUNNING = 1,
    STORE_WAITING = 2, /* for its retry; this and those above are the unfinished ones */
    STORE_DONE = 3,
    STORE_FAILED = 4,
    STORE_CANCELLED = 5,
    STORE_RETRACTED = 6, /* was counted, and its contribution was taken back */
    STORE_N_STATES = 7
};
enum store_outcome {
    STORE_NO_OUTCOME = 0,
    STORE_COUNTED = 1,
    STORE_DUPLICATE = 2
}; /* of a done job */
enum store_origin { STORE_SPOOL = 0, STORE_SOCKET = 1 };
enum store_class { STORE_NO_CLASS = 0, STORE_TRANSIENT = 1, STORE_DATA = 2, STORE_BUG = 3 };
enum store_attempt_outcome { /* of an attempt */
                             STORE_ATTEMPT_OPEN = 0,
                             STORE_ATTEMPT_DONE = 1,
                             STORE_ATTEMPT_FAILED = 2,
                             STORE_ATTEMPT_CANCELLED = 3,
                             STORE_ATTEMPT_RELEASED = 4,   /* given back in good order */
                             STORE_ATTEMPT_INTERRUPTED = 5 /* the service died */
};

/* Stable lower-case names ("queue_full", "running", ...; "unknown" for what is none). Never NULL.
 */
const char *store_code_name(int code); /* also of enum shear_code */
const char *store_state_name(enum store_state state);
bool store_state_is_final(enum store_state state); /* not one of the unfinished ones */
const char *store_outcome_name(enum store_outcome outcome);
const char *store_origin_name(enum store_origin origin);
const char *store_class_name(enum store_class failure_class);
const char *store_attempt_outcome_name(enum store_attempt_outcome outcome);

/* True where the same call may succeed later: the disk is full, an I/O error, memory is out. */
bool store_is_transient(int code);

/* ---- The database ---- */

typedef struct store store;

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

/* ---- The life of a job ---- */

typedef struct store_spec {
    const char *field; /* NULL: the file says */
    const char
        *source; /* what to read: a path, or a text of the caller's for several; not looked into */
    const char *settings; /* canonical text; not looked into */
    const char
        *settings_digest; /* stands for it: the same digest with another text is SHEAR_E_INTERNAL */
    const char *key;      /* idempotency key, unique for an owner; NULL: none */
    const char *dropped;  /* STORE_SPOOL: the file's name; else NULL */
    enum store_origin origin;
    int priority;       /* higher runs first */
    bool force;         /* count it even where its identity was counted before */
    uint32_t owner;     /* uid */
    uint32_t gid;       /* the owner's group ... */
    const char *groups; /* ... and supplementary ones when it asked, a text of the caller's; NULL:
                           not known, and gid does not count */
    int64_t created_ms;
} store_spec;

/* Queue a job. *id grows with every new job and is never given twice. Where the owner's key is
 * known: the same request (all of the spec but dropped, gid, groups and created_ms) gives that
 * job's id, and *known is true, whatever the queue; another is STORE_KEY_REUSED. A key is known as
 * long as its job is kept (store_retire). STORE_QUEUE_FULL where there are `max_unfinished` queued,
 * running and waiting jobs or more. */
int store_submit(store *s, const store_spec *spec, int64_t max_unfinished, int64_t *id, bool *known,
                 shear_error *err);
/* The job of a file of the watch folder that may have been told before, whatever else a request for
 * it would say now (the configured defaults may have changed); *id is 0 where there is none. */
int store_find_dropped(store *s, uint32_t owner, const char *key, const char *dropped, int64_t *id,
                       shear_error *err);
/* Where a dropped file lies now that its job is final: a place and a mark of the caller's, both at
 * most STORE_PATH_MAX bytes; forgotten by store_retry. */
int store_set_disposal(store *s, int64_t id, const char *place, const char *fingerprint,
                       shear_error *err);

typedef struct store_job {
    int64_t id;
    enum store_state state;
    enum store_outcome outcome;
    enum store_origin origin;
    int priority;
    bool force;
    bool cancel_asked; /* while running */
    uint32_t owner;
    uint32_t gid;        /* where groups is not NULL */
    int64_t attempts;    /* since it was submitted or retried by hand: */
    int64_t failures;    /* ... those that failed */
    int64_t interrupted; /* ... and those that ended with the service's death */
    int64_t attempt;     /* the number of the last attempt ever; 0: none */
    int64_t created_ms;
    int64_t started_ms;             /* last attempt; 0: none */
    int64_t finished_ms;            /* 0: unfinished */
    int64_t not_before_ms;          /* of a waiting job; else 0 */
    int64_t n_stamps;               /* of the file; -1: not known yet */
    int64_t n_used;                 /* of a done job, else -1 */
    int64_t elapsed_us;             /* of a done job, else 0 */
    int64_t duplicate_of;           /* the job that was counted for this one; 0: none */
    enum store_class failure_class; /* of the last failure; none once done or retried by hand
                                     */
    char *field;                    /* asked for, or learned from the file */
    char *source;                   /* never NULL */
    char *settings;                 /* never NULL */
    char *settings_digest;          /* never NULL */
    char *key;
    char *groups;  /* as given to store_submit */
    char *content; /* checksum */
    char *code;    /* the last failure's, and its message and advice */
    char *message;
    char *advice;
    char *result; /* of a done job, as given to store_finish */
    char *catalog;
    char *dropped; /* as given to store_submit */
    char *place;   /* as given to store_set_disposal, both */
    char *place_fingerprint;
} store_job;
void store_job_deinit(store_job *job);

/* The next job to run at `now_ms`: highest priority first, then the oldest. Waiting jobs whose time
 * has come are queued first. The job is RUNNING then, with an attempt opened. job->id is 0 where
 * there is nothing to run. */
int store_next(store *s, int64_t now_ms, store_job *job, shear_error *err);
/* When the first waiting job wants to run; INT64_MAX: none waits. */
int store_next_due(store *s, int64_t *due_ms, shear_error *err);
/* What those waiting jobs that failed last with `code` wait for has come: they run at `now_ms`. */
int store_retry_waiting(store *s, const char *code, int64_t now_ms, shear_error *err);

/* Why jobs wait: those with the same code together. */
typedef struct store_waiting {
    char code[STORE_CODE_MAX + 1];
    char message[STORE_MESSAGE_MAX + 1]; /* of the one that is tried next */
    int64_t jobs;
    int64_t attempts; /* of the one with the most */
    int64_t next_ms;  /* when the first is tried again */
} store_waiting;
/* At most `capacity` of them; *n how many. */
int store_waiting_reasons(store *s, store_waiting *reasons, size_t capacity, size_t *n,
                          shear_error *err);

/* The caller's clock was set (or was found to be another one at a start): waiting jobs are moved by
 * delta_ms, so that they wait as long as they were to, and none beyond latest_ms; what is said to
 * have finished after now_ms finished now. */
typedef struct store_clock {
    int64_t delta_ms, latest_ms, now_ms;
} store_clock;
int store_set_clock(store *s, const store_clock *clock, shear_error *err);

typedef struct store_input {
    const char *field;   /* NULL: leave as it is */
    const char *content; /* checksum; NULL: leave as it is */
    int64_t n_stamps;    /* negative: leave as it is */
} store_input;

/* What opening a running job's input told. Another content than before drops the job's checkpoint.
 * *duplicate_of: the first job that was counted with the same identity (field, settings, content),
 * for an early store_finish without sums; 0: none, or the job is forced, or field and content are
 * not both known. */
int store_set_input(store *s, int64_t id, const store_input *input, int64_t *duplicate_of,
                    shear_error *err);

/* Remember the exact sums (shear/sums.h) of blocks [0, next_block) of a running job whose content
 * is known (STORE_WRONG_STATE otherwise). The last one counts. It is dropped when the job is done
 * or cancelled. */
int store_checkpoint(store *s, int64_t id, int64_t next_block, const char *sums, shear_error *err);

/* The same where estimator = pdf-sym: with the terms (shear_symmetry_bytes) of the blocks
 * [from_block, next_block). They are added to those of the checkpoints before; from_block = 0
 * begins anew. STORE_WRONG_STATE where the terms just before from_block are not there (their
 * checkpoint was lost): the last checkpoint stays. */
typedef struct store_progress {
    int64_t from_block, next_block;
    const char *sums;
    const unsigned char *terms;
    size_t terms_size;
} store_progress;
int store_checkpoint_terms(store *s, int64_t id, const store_progress *progress, shear_error *err);
/* *sums is malloc'd, the caller frees it. STORE_NOT_FOUND where there is none. */
int store_checkpoint_load(store *s, int64_t id, int64_t *next_block, char **sums, shear_error *err);
/* Add the terms that belong to the checkpoint to `terms`; none is no error. */
int store_checkpoint_load_terms(store *s, int64_t id, shear_symmetry *terms, shear_error *err);

typedef struct store_work {
    const char *sums; /* the job's exact sums; NULL only for an early duplicate (store_set_input) */
    const char *result;  /* text of the caller's; may be NULL */
    const char *catalog; /* path; may be NULL */
    int64_t elapsed_us;
    int64_t now_ms;
    const char *account; /* of the file, kept with the contribution when the job is gone; a text of
                            the caller's; may be NULL */
    bool has_truth;      /* a mock's: the shear that it was made with */
    double true_g1, true_g2;
    const unsigned char *terms; /* of all its stamps where estimator = pdf-sym, as bytes; or NULL */
    size_t terms_size;
} store_work;

typedef struct store_finished {
    enum store_state
        state; /* STORE_DONE, or STORE_CANCELLED where that was asked: then nothing is counted */
    enum store_outcome outcome; /* of a done job */
    int64_t duplicate_of;       /* STORE_DUPLICATE: the job that was counted before */
} store_finished;

/* End a running job whose field and content are known (STORE_WRONG_STATE otherwise). One
 * transaction: the job is done, its attempt closed, its contribution recorded and joined to its
 * field. A job whose identity was counted before ends as its duplicate and changes no field, unless
 * it is forced. Sums that cannot be read are SHEAR_E_INTERNAL, and nothing changes. */
int store_finish(store *s, int64_t id, const store_work *work, store_finished *end,
                 shear_error *err);

enum { STORE_NEVER = -1 };
typedef struct store_failure {
    enum store_class failure_class; /* not STORE_NO_CLASS */
    const char *code;               /* stable name */
    const char *message;
    const char *advice;  /* may be NULL */
    int64_t retry_at_ms; /* or STORE_NEVER */
    int64_t now_ms;
} store_failure;

/* A running job's attempt failed. *state: STORE_WAITING, STORE_FAILED, or STORE_CANCELLED where
 * that was asked. */
int store_fail(store *s, int64_t id, const store_failure *failure, enum store_state *state,
               shear_error *err);
/* Put a running job back into the queue in good order (the service stops); where cancel was asked,
 * cancel it. */
int store_release(store *s, int64_t id, int64_t now_ms, enum store_state *state, shear_error *err);
/* *state: STORE_CANCELLED at once, or STORE_RUNNING: marked, and the caller is to stop it. A
 * cancelled job stays so (SHEAR_OK); a done or failed one is STORE_WRONG_STATE. */
int store_cancel(store *s, int64_t id, int64_t now_ms, enum store_state *state, shear_error *err);
/* A counted job's contribution leaves its field: the field's sums, numbers and terms are then, to
 * the last bit, what they would be had it never been (a field without contributions is gone). The
 * job is RETRACTED, with no outcome; its content may be counted again. Jobs that were found to be
 * its duplicates stay as they are. A retracted job stays so (SHEAR_OK); others are
 * STORE_WRONG_STATE. */
int store_retract(store *s, int64_t id, shear_error *err);

typedef struct store_forgotten {
    int64_t rows, contributions;
    int64_t last; /* the rows' numbers (store_removal) are those up to this one */
} store_forgotten;
/* All that was counted in a field, with these settings (NULL: any): its records are gone, whose
 * contributions are to leave (below): they count and are recognised no more. STORE_NOT_FOUND where
 * nothing was counted; STORE_WRONG_STATE where unfinished jobs are known to be of it. */
int store_forget(store *s, const char *name, const char *settings_digest, store_forgotten *out,
                 shear_error *err);

/* What is to leave next, first of the field that was forgotten first, until nothing is left, also
 * after a restart: whoever has forgotten fields calls these two in turn. */
typedef struct store_removal {
    int64_t forgotten; /* number of the field's row, in the order of forgetting; 0: none is left */
    int64_t contribution; /* 0: all of them have left, and the row's number is to go */
    int64_t job;          /* the contribution's */
    bool kept;            /* not retired: it becomes RETRACTED */
    char *field;          /* its name */
    char *catalog;        /* of a job that is kept */
} store_removal;
void store_removal_deinit(store_removal *removal);
int store_next_removal(store *s, store_removal *next, shear_error *err);
/* `catalog_gone`: the job's file is not there any more; else store_next_leftover tells of it. */
int store_remove(store *s, const store_removal *removal, bool catalog_gone, shear_error *err);

/* A retracted job tells its catalog until store_catalog_gone: the file must go after the change
 * is on disk, and may be left where the service dies between. The first such job after `after`, in
 * *id (0: there is none) and *path (the caller's). */
int store_next_leftover(store *s, int64_t after, int64_t *id, char **path, shear_error *err);
int store_catalog_gone(store *s, int64_t id, shear_error *err);

/* Queue a failed or cancelled job again, its attempts counted from 0. STORE_WRONG_STATE for others,
 * STORE_QUEUE_FULL as in store_submit. */
int store_retry(store *s, int64_t id, int64_t max_unfinished, shear_error *err);

/* ---- Looking at jobs ---- */

int store_last_job(store *s, int64_t *id, shear_error *err); /* the newest ever; 0: none yet */

int store_job_get(store *s, int64_t id, store_job *job, shear_error *err); /* STORE_NOT_FOUND */
/* Its state alone, a hundred times as fast. STORE_NOT_FOUND. */
int store_job_state(store *s, int64_t id, enum store_state *state, shear_error *err);

typedef struct store_job_filter {
    unsigned states;   /* 1u << STORE_FAILED and so on, or'ed; 0: all */
    const char *field; /* exactly; NULL: all */
    bool by_owner;
    uint32_t owner; /* where by_owner */
    int64_t before; /* only smaller ids (the last one of the page before); 0: from the newest */
} store_job_filter;

typedef struct store_job_page {
    store_job *jobs; /* n of them, newest first */
    size_t n;
    bool more; /* older ones follow */
} store_job_page;
void store_job_page_deinit(store_job_page *page);

/* A page of jobs by descending id. Jobs that are submitted meanwhile do not move the pages that
 * follow. */
int store_jobs(store *s, const store_job_filter *filter, size_t limit, store_job_page *page,
               shear_error *err);

typedef struct store_attempt {
    int64_t number;               /* 1, 2, ... over the job's whole life */
    int64_t started_ms, ended_ms; /* ended: 0 while it is open */
    enum store_attempt_outcome outcome;
    enum store_class failure_class;
    char *code, *message;
} store_attempt;
typedef struct store_attempts {
    store_attempt *attempts; /* the last STORE_ATTEMPTS_KEPT, oldest first */
    size_t n;
} store_attempts;
void store_attempts_deinit(store_attempts *list);
/* STORE_NOT_FOUND where there is no such job. */
int store_attempts_get(store *s, int64_t id, store_attempts *list, shear_error *err);

/* ---- Fields ---- */

/* One field as measured with one set of settings. */
typedef struct store_field {
    char *name, *settings_digest, *settings; /* never NULL */
    char *sums;   /* exact join of its contributions (shear/sums.h); never NULL */
    int64_t jobs; /* that were counted */
    int64_t n_stamps, n_used;
    int64_t unfinished; /* jobs known to be of this field and these settings: above 0, the result is
                           partial */
    int64_t updated_ms; /* the last contribution */
    int64_t elapsed_us; /* sum over its contributions */
} store_field;
typedef struct store_field_page {
    store_field *fields; /* by name (bytes), then by settings digest */
    size_t n;
    bool more;
    int64_t unfinished; /* store_field_get: unfinished jobs known to be of this name, whatever their
                           settings */
} store_field_page;
void store_field_page_deinit(store_field_page *page);

/* Every record of one name (at most STORE_PAGE_MAX). STORE_NOT_FOUND where nothing was counted and
 * nothing is unfinished. */
int store_field_get(store *s, const char *name, store_field_page *page, shear_error *err);

typedef struct store_field_filter {
    const char *prefix;     /* of the name; NULL: all */
    const char *after_name; /* the last record of the page before, both; NULL: from the first */
    const char *after_digest;
} store_field_filter;
/* A page of fields. Fields that appear meanwhile do not move the others. */
int store_fields(store *s, const store_field_filter *filter, size_t limit, store_field_page *page,
                 shear_error *err);

typedef struct store_contribution {
    int64_t id;    /* grows in the order of counting */
    int64_t job;   /* may have been retired since */
    char *content; /* never NULL */
    int64_t n_stamps, n_used;
    int64_t counted_ms;
    char *account; /* as given to store_finish; NULL: not known */
} store_contribution;
typedef struct store_contribution_page {
    store_contribution *items; /* by id */
    size_t n;
    bool more;
} store_contribution_page;
void store_contribution_page_deinit(store_contribution_page *page);

/* What was counted in a field with these settings, in the order of counting; `after`: the last id
 * of the page before, or 0. STORE_NOT_FOUND where there is no such field. */
int store_contributions(store *s, const char *name, const char *settings_digest, int64_t after,
                        size_t limit, store_contribution_page *page, shear_error *err);

typedef struct store_truth {
    bool known; /* all contributions have the same one */
    double g1, g2;
} store_truth;
/* In a time that does not depend on how many there are. STORE_NOT_FOUND as above. */
int store_field_truth(store *s, const char *name, const char *settings_digest, store_truth *truth,
                      shear_error *err);

/* The stamp that counts most in a field (its size NaN: not known), and the account of the file that
 * it is in: the caller's; NULL where there is none. STORE_NOT_FOUND as above. */
int store_field_top(store *s, const char *name, const char *settings_digest, shear_influence *top,
                    char **account, shear_error *err);

/* The exact sums of one contribution; malloc'd, the caller frees it. STORE_NOT_FOUND. */
int store_contribution_sums(store *s, int64_t id, char **sums, shear_error *err);

/* Add the terms of everything that was counted in a field with these settings, in the order of
 * counting. STORE_NOT_FOUND as above; no terms is no error. */
int store_field_terms(store *s, const char *name, const char *settings_digest,
                      shear_symmetry *terms, shear_error *err);

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
