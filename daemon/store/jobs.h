/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/jobs.h: the life of a job, and reading jobs. store.h has the states, and describes what
 * holds for all calls. */
#pragma once

#include "shear/symmetry.h"
#include "store/codes.h"

/* ---- The life of a job ---- */

typedef struct store_spec {
    const char *field; /* NULL: the file's name for it */
    /* What to read: a path, or a text of the caller's that names several files. Not interpreted. */
    const char *source;
    const char *settings; /* canonical text, not interpreted */
    /* Represents `settings`. The same digest with another text is SHEAR_E_INTERNAL. */
    const char *settings_digest;
    const char *key;     /* idempotency key, unique per owner; NULL: none */
    const char *dropped; /* STORE_SPOOL: the file's name; else NULL */
    enum store_origin origin;
    int priority;   /* higher runs first */
    bool force;     /* count it even if its identity was counted before */
    uint32_t owner; /* uid */
    uint32_t gid;   /* the owner's group ... */
    /* ... and supplementary groups at the time of the request, a text of the caller's. NULL: not
     * known; then gid is ignored. */
    const char *groups;
    int64_t created_ms;
} store_spec;

/* Queue a job. *id grows with every new job and is never reused. If the owner has used the key
 * before, the same request (all of the spec except dropped, gid, groups and created_ms) returns
 * that job's id with *known true, even if the queue is full; another request is STORE_KEY_REUSED. A
 * key is remembered as long as its job is kept (store_retire). STORE_QUEUE_FULL if there are
 * `max_unfinished` queued, running and waiting jobs or more. */
int store_submit(store *s, const store_spec *spec, int64_t max_unfinished, int64_t *id, bool *known,
                 shear_error *err);
/* Find the job of a file of the watch folder that may have been submitted before, by its key alone:
 * the rest of the request may have changed (the configured defaults). *id is 0 if there is none. */
int store_find_dropped(store *s, uint32_t owner, const char *key, const char *dropped, int64_t *id,
                       shear_error *err);
/* Store where a dropped file is now that its job is final: a place and a fingerprint, texts of the
 * caller's of at most STORE_PATH_MAX bytes each. store_retry removes them. */
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
    uint32_t gid;        /* if groups is not NULL */
    int64_t attempts;    /* since it was submitted or retried by hand: */
    int64_t failures;    /* ... those that failed */
    int64_t interrupted; /* ... and those that ended because the service died */
    int64_t attempt;     /* number of the last attempt ever; 0: none */
    int64_t created_ms;
    int64_t started_ms;    /* of the last attempt; 0: none */
    int64_t finished_ms;   /* 0: unfinished */
    int64_t not_before_ms; /* of a waiting job; else 0 */
    int64_t n_stamps;      /* of the file; -1: not known yet */
    int64_t n_used;        /* of a done job, else -1 */
    int64_t elapsed_us;    /* of a done job, else 0 */
    int64_t duplicate_of;  /* the job that was counted for this one; 0: none */
    /* Of the last failure; STORE_NO_CLASS once the job is done or retried by hand. */
    enum store_class failure_class;
    char *field;           /* requested, or from the file */
    char *source;          /* never NULL */
    char *settings;        /* never NULL */
    char *settings_digest; /* never NULL */
    char *key;
    char *groups;  /* as given to store_submit */
    char *content; /* checksum */
    char *code;    /* of the last failure, like message and advice */
    char *message;
    char *advice;
    char *result; /* of a done job, as given to store_finish */
    char *catalog;
    char *dropped; /* as given to store_submit */
    char *place;   /* both as given to store_set_disposal */
    char *place_fingerprint;
} store_job;
void store_job_deinit(store_job *job);

/* Start the next job: among those queued or due at `now_ms`, the one with the highest priority,
 * then the oldest. The job is now RUNNING, with an open attempt. job->id is 0 if there is none. */
int store_next(store *s, int64_t now_ms, store_job *job, shear_error *err);
/* Get the time when the first waiting job is due; INT64_MAX: none waits. */
int store_next_due(store *s, int64_t *due_ms, shear_error *err);
/* Make the waiting jobs whose last failure has this code due at `now_ms`, unless they are due
 * before. */
int store_retry_waiting(store *s, const char *code, int64_t now_ms, shear_error *err);

/* The waiting jobs whose last failures have the same code. */
typedef struct store_waiting {
    char code[STORE_CODE_MAX + 1];
    char message[STORE_MESSAGE_MAX + 1]; /* of the job that is due first */
    int64_t jobs;
    int64_t attempts; /* of the job with the most attempts */
    int64_t next_ms;  /* when the first job is due */
} store_waiting;
/* Get at most `capacity` reasons; *n is their number. */
int store_waiting_reasons(store *s, store_waiting *reasons, size_t capacity, size_t *n,
                          shear_error *err);

/* The caller's clock was set, or differs from that of the last start. Waiting jobs are moved by
 * delta_ms, so that they wait as long as intended, and none beyond latest_ms; finishing times after
 * now_ms become now_ms. */
typedef struct store_clock {
    int64_t delta_ms, latest_ms, now_ms;
} store_clock;
int store_set_clock(store *s, const store_clock *clock, shear_error *err);

typedef struct store_input {
    const char *field;   /* NULL: unchanged */
    const char *content; /* checksum; NULL: unchanged */
    int64_t n_stamps;    /* negative: unchanged */
} store_input;

/* Store what is known after a running job's input was opened. If the content has changed, the job's
 * checkpoint is dropped. *duplicate_of is the first job counted with the same identity (field,
 * settings, content), for an early store_finish without sums; 0: there is none, or the job is
 * forced, or field and content are not both known. */
int store_set_input(store *s, int64_t id, const store_input *input, int64_t *duplicate_of,
                    shear_error *err);

typedef struct store_progress {
    int64_t from_block, next_block;
    const char *sums; /* exact sums (shear/sums.h) of the blocks [0, next_block) */
    /* For estimators that need terms, else NULL: those (shear_symmetry_bytes) of the blocks
     * [from_block, next_block). They are added to the terms of earlier checkpoints; from_block = 0
     * begins again. */
    const unsigned char *terms;
    size_t terms_size;
} store_progress;
/* Store the progress of a running job, in place of the last checkpoint. The checkpoint is dropped
 * when the job is done or cancelled. STORE_WRONG_STATE if the job's content is not known, or if the
 * terms that end at from_block are missing (their checkpoint was lost): the last checkpoint stays.
 */
int store_checkpoint(store *s, int64_t id, const store_progress *progress, shear_error *err);
/* Get the checkpoint. *sums is malloc'd, the caller's. STORE_NOT_FOUND if there is none. */
int store_checkpoint_load(store *s, int64_t id, int64_t *next_block, char **sums, shear_error *err);
/* Append the terms that belong to the checkpoint to `terms`. No terms are not an error. */
int store_checkpoint_load_terms(store *s, int64_t id, shear_symmetry *terms, shear_error *err);

typedef struct store_work {
    /* The job's exact sums. NULL only for an early duplicate (store_set_input). */
    const char *sums;
    const char *result;  /* text of the caller's; may be NULL */
    const char *catalog; /* path; may be NULL */
    int64_t elapsed_us;
    int64_t now_ms;
    /* Account of the file, a text of the caller's that is kept with the contribution when the job
     * is retired; may be NULL. */
    const char *account;
    bool has_truth; /* the file is a mock: its true shear follows */
    double true_g1, true_g2;
    /* Terms of all its stamps, as bytes, if the estimator needs them; otherwise NULL. */
    const unsigned char *terms;
    size_t terms_size;
} store_work;

typedef struct store_finished {
    /* STORE_DONE, or STORE_CANCELLED if that was requested: then nothing is counted. */
    enum store_state state;
    enum store_outcome outcome; /* of a done job */
    int64_t duplicate_of;       /* of STORE_DUPLICATE: the job that was counted */
} store_finished;

/* Finish a running job. One transaction: the job becomes done, its attempt is closed, its
 * contribution is recorded and joined to its field. A job whose identity was counted before becomes
 * its duplicate and changes no field, unless it is forced. STORE_WRONG_STATE if field or content
 * are not known. SHEAR_E_INTERNAL, and nothing changes, if the sums cannot be read. */
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

/* Record that a running job's attempt failed. *state is STORE_WAITING, STORE_FAILED, or
 * STORE_CANCELLED if that was requested. */
int store_fail(store *s, int64_t id, const store_failure *failure, enum store_state *state,
               shear_error *err);
/* Put a running job back into the queue (the service stops), or cancel it if that was requested. */
int store_release(store *s, int64_t id, int64_t now_ms, enum store_state *state, shear_error *err);
/* Cancel a job. *state is STORE_CANCELLED, or STORE_RUNNING: the job is marked, and the caller has
 * to stop it. A cancelled job stays so (SHEAR_OK); other final ones are STORE_WRONG_STATE. */
int store_cancel(store *s, int64_t id, int64_t now_ms, enum store_state *state, shear_error *err);
/* Remove a counted job's contribution from its field: the field's sums, numbers and terms become,
 * to the last bit, what they would be without it (a field without contributions is removed). The
 * job becomes RETRACTED, without an outcome; its content may be counted again. Duplicates of it
 * stay as they are. A retracted job stays so (SHEAR_OK); others are STORE_WRONG_STATE. */
int store_retract(store *s, int64_t id, shear_error *err);

/* A retracted job keeps the path of its catalog until store_catalog_gone: the file is removed after
 * the change is on disk, and is left if the service dies in between. Get the first such job after
 * `after` as *id (0: there is none) and its catalog's *path, the caller's. */
int store_next_leftover(store *s, int64_t after, int64_t *id, char **path, shear_error *err);
int store_catalog_gone(store *s, int64_t id, shear_error *err);

/* Queue a failed or cancelled job again, its attempts counted from 0. STORE_WRONG_STATE for other
 * jobs, STORE_QUEUE_FULL as in store_submit. */
int store_retry(store *s, int64_t id, int64_t max_unfinished, shear_error *err);

/* ---- Reading jobs ---- */

int store_last_job(store *s, int64_t *id, shear_error *err); /* the newest ever; 0: none */

int store_job_get(store *s, int64_t id, store_job *job, shear_error *err); /* STORE_NOT_FOUND */
/* Get a job's state alone, which is a hundred times as fast. STORE_NOT_FOUND. */
int store_job_state(store *s, int64_t id, enum store_state *state, shear_error *err);

typedef struct store_job_filter {
    unsigned states;   /* bits 1u << STORE_FAILED and so on; 0: all */
    const char *field; /* exact name; NULL: all */
    bool by_owner;
    uint32_t owner; /* if by_owner */
    int64_t before; /* smaller ids only (the last one of the previous page); 0: from the newest */
} store_job_filter;

typedef struct store_job_page {
    store_job *jobs; /* [n], newest first */
    size_t n;
    bool more; /* older ones follow */
} store_job_page;
void store_job_page_deinit(store_job_page *page);

/* Get a page of jobs by descending id. Jobs that are submitted meanwhile do not shift later
 * pages. */
int store_jobs(store *s, const store_job_filter *filter, size_t limit, store_job_page *page,
               shear_error *err);

typedef struct store_attempt {
    int64_t number;               /* 1, 2, ... over the job's whole life */
    int64_t started_ms, ended_ms; /* ended_ms: 0 while it is open */
    enum store_attempt_outcome outcome;
    enum store_class failure_class;
    char *code, *message;
} store_attempt;
typedef struct store_attempts {
    store_attempt *attempts; /* the last STORE_ATTEMPTS_KEPT, oldest first */
    size_t n;
} store_attempts;
void store_attempts_deinit(store_attempts *list);
/* Get a job's attempts. STORE_NOT_FOUND if there is no such job. */
int store_attempts_get(store *s, int64_t id, store_attempts *list, shear_error *err);
