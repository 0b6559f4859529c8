/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/group.h"

#include "base/cleanup.h"
#include "log/log.h"

#include <assert.h>
#include <stdlib.h>

static void nothing(uv_idle_t *idle) {
    (void)idle;
}

int group_begin(group *g, shear_error *err) {
    if (g->open)
        return SHEAR_OK;
    TRY(store_begin(g->store, err));
    g->open = true;
    uv_idle_start(&g->commit_now, nothing);
    return SHEAR_OK;
}

void *group_then(group *g, post_commit_run *run, int64_t job, size_t size) {
    assert(size >= sizeof(post_commit));
    post_commit *post = calloc(1, size);
    if (post == NULL)
        return NULL;
    post->run = run;
    post->context = g->context;
    post->job = job;
    *g->last = post;
    g->last = &post->next;
    return post;
}

bool group_is_idle(const group *g) {
    return g->first == NULL && !g->open;
}

static int commit(group *g, shear_error *err) {
    const int code = store_commit(g->store, err);
    g->open = false;
    uv_idle_stop(&g->commit_now);
    const bool again = g->failing && code == SHEAR_OK;
    g->failing = code != SHEAR_OK;
    if (g->failing) {
        g->failed_commits++;
        problem_note_add(g->notes, "store", store_code_name(code), INT64_MAX, err->message);
        log_error("the store cannot commit: %s", err->message);
        return code;
    }
    g->commits++;
    if (again) {
        problem_note_end(g->notes, "store");
        problem_note_end(g->notes, "spool"); /* files not stored are reported again now */
    }
    return SHEAR_OK;
}

static void on_turn_end(uv_check_t *check) {
    group *g = check->data;
    shear_error err = {0};
    post_commit *post = g->first;
    g->first = NULL;
    g->last = &g->first;
    const int code = g->open ? commit(g, &err) : SHEAR_OK;
    while (post != NULL) {
        post_commit *next = post->next;
        post->run(post, code, &err);
        free(post);
        post = next;
    }
    g->turn_ended(g->context, code);
}

void group_start(group *g, uv_loop_t *loop, store *s, problem_notes *notes,
                 void (*turn_ended)(void *context, int code), void *context) {
    *g = (group){.store = s, .notes = notes, .turn_ended = turn_ended, .context = context};
    g->last = &g->first;
    uv_check_init(loop, &g->turn_end);
    uv_idle_init(loop, &g->commit_now);
    g->turn_end.data = g;
    uv_check_start(&g->turn_end, on_turn_end);
}
