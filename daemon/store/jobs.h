/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/jobs.h: the life of a job, and looking at jobs. store.h has the states, and what holds for
 * all calls. */
#ifndef SHEARD_STORE_JOBS_H
#define SHEARD_STORE_JOBS_H

#include "shear/symmetry.h"
#include "store/codes.h"

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
 * begins again. STORE_WRONG_STATE where the terms just before from_block are not there (their
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
/* Add the terms that belong to the checkpoint to `terms`; that there are none is no error. */
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

#endif
