/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/group.h: group commit. All changes of the store that one turn of the loop brings are
 * one group, committed by one fsync when the turn ends. What the outside may see of them (replies,
 * moved files, notifications, started jobs) is left to post-commit callbacks: they run after that
 * commit, in the order in which they were registered, never before. What they change belongs to the
 * next group, which is committed in the next turn. */
#ifndef SHEARD_SERVICE_GROUP_H
#define SHEARD_SERVICE_GROUP_H

#include "service/core/problem_notes.h"
#include "store/store.h"

#include <uv.h>

/* What a module registers to be done after the commit; first member of a larger record where the
 * module has more to remember. Freed after its run. */
typedef struct post_commit post_commit;
/* `code` SHEAR_OK: the group is on disk. Else nothing of it is, and *err tells why. */
typedef void post_commit_run(post_commit *post, int code, const shear_error *err);
struct post_commit {
    post_commit *next;
    post_commit_run *run;
    void *context; /* the group's */
    int64_t job;   /* that it is about; 0: it is about none */
};

typedef struct group_hooks {
    /* After the callbacks of every turn; `code`: of the commit, SHEAR_OK where there was none. */
    void (*turn_ended)(void *context, int code);
    void *context; /* the callbacks', too */
} group_hooks;

typedef struct group {
    store *store;
    problem_notes *notes;
    group_hooks hooks;
    uv_check_t turn_end;
    uv_idle_t commit_now; /* active while a group is open: the loop must not sleep on it */
    bool open;
    bool failing; /* the last commit failed */
    int64_t commits, failed_commits;
    post_commit *first, **last;
} group;

void group_start(group *g, uv_loop_t *loop, store *s, problem_notes *notes,
                 const group_hooks *hooks);
/* Call before every change of the store. */
int group_begin(group *g, shear_error *err);
/* Register `run` for after the commit, with a zeroed record of `size` bytes that begins with a
 * post_commit. NULL: out of memory. */
void *group_then(group *g, post_commit_run *run, int64_t job, size_t size);
/* The last commit failed, and none has succeeded since: the next one is tried once a second. */
bool group_is_failing(const group *g);
/* Nothing waits for a commit. */
bool group_is_idle(const group *g);

#endif
