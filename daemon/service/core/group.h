/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/group.h: group commit. All changes of the store in one turn of the loop form one
 * group, committed by one fsync at the end of the turn. Their effects outside the store (replies,
 * moved files, notifications, started jobs) are post-commit callbacks: these run after the commit,
 * in the order of their registration. Changes that they make belong to the next group, which is
 * committed in the next turn. */
#pragma once

#include "service/core/problem_notes.h"
#include "store/store.h"

#include <uv.h>

/* A callback to be run after the commit: the first member of a larger record if the module has data
 * of its own. Freed after its run. */
typedef struct post_commit post_commit;
/* Called after the commit. `code` is SHEAR_OK if the group is on disk; otherwise nothing of it is,
 * and *err describes the error. */
typedef void post_commit_run(post_commit *post, int code, const shear_error *err);
struct post_commit {
    post_commit *next;
    post_commit_run *run;
    void *context; /* of the group */
    int64_t job;   /* number of the job that it is about; 0: none */
};

typedef struct group {
    store *store;
    problem_notes *notes;
    /* Called after the callbacks of every turn. `code` is the commit's, or SHEAR_OK if there was
     * none. */
    void (*turn_ended)(void *context, int code);
    void *context; /* passed to post-commit callbacks, too */
    uv_check_t turn_end;
    uv_idle_t commit_now; /* active while a group is open, so that the loop does not sleep before
                             the commit */
    bool open;
    bool failing; /* the last commit failed; the next one is tried once a second */
    int64_t commits, failed_commits;
    post_commit *first, **last;
} group;

void group_start(group *g, uv_loop_t *loop, store *s, problem_notes *notes,
                 void (*turn_ended)(void *context, int code), void *context);
/* Open the group, unless it is open. Call before every change of the store. Errors of
 * store_begin. */
int group_begin(group *g, shear_error *err);
/* Register `run` for after the commit. Return a zeroed record of `size` bytes that begins with a
 * post_commit and belongs to the group, or NULL if out of memory. */
void *group_then(group *g, post_commit_run *run, int64_t job, size_t size);
/* Return true if no group is open and no callback waits. */
bool group_is_idle(const group *g);
