/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Group commit: all changes of a turn of the loop, one fsync, then what depends on them. */
#include "service/inner.h"

#include <stdlib.h>

static void nothing(uv_idle_t *idle) {
    (void)idle;
}

int group_begin(service *s, shear_error *err) {
    if (s->group_open) {
        return SHEAR_OK;
    }
    const int code = store_begin(s->store, err);
    if (code == SHEAR_OK) {
        s->group_open = true;
        uv_idle_start(&s->commit_now, nothing);
    }
    return code;
}

after *group_after(service *s, void (*run)(service *, after *, int, const shear_error *)) {
    after *a = calloc(1, sizeof *a);
    if (a != NULL) {
        a->run = run;
        *s->last_after = a;
        s->last_after = &a->next;
    }
    return a;
}

static void remember_trouble(service *s, int code, const shear_error *err) {
    if (code == SHEAR_OK) {
        if (s->store_trouble_ms != 0) {
            problem_over(s, "store");
            problem_over(s, "spool"); /* files that could not be stored are told again now */
        }
        s->store_trouble_ms = 0;
        return;
    }
    s->failed_commits++;
    s->strays = true;
    s->store_trouble_ms = (int64_t)uv_now(&s->loop);
    problem_noted(s, "store", store_code_name(code), INT64_MAX, err->message);
    log_error("the store cannot commit: %s", err->message);
}

/* At the end of a turn. What runs here may open the next group; it is committed in the next turn.
 */
static void commit(uv_check_t *check) {
    service *s = check->data;
    shear_error err = {0};
    int code = SHEAR_OK;
    after *a = s->first_after;
    s->first_after = NULL;
    s->last_after = &s->first_after;
    if (s->group_open) {
        code = store_commit(s->store, &err);
        s->group_open = false;
        s->commits += code == SHEAR_OK;
        uv_idle_stop(&s->commit_now);
        remember_trouble(s, code, &err);
    }
    while (a != NULL) {
        after *next = a->next;
        a->run(s, a, code, &err);
        free(a->name);
        free(a);
        a = next;
    }
    if (code == SHEAR_OK) {
        jobs_fill(s);
    }
    life_check(s);
}

void group_start(service *s) {
    s->last_after = &s->first_after;
    uv_check_init(&s->loop, &s->commit_check);
    uv_idle_init(&s->loop, &s->commit_now);
    s->commit_check.data = s;
    uv_check_start(&s->commit_check, commit);
}
