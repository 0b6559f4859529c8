/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/subscriptions.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

static int compare_jobs(const void *a, const void *b) {
    const int64_t x = *(const int64_t *)a;
    const int64_t y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static int compare_fields(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Return the index of the key in items[n] of `size` bytes each, or where it would be inserted. */
static size_t find(const void *items, size_t n, size_t size, const void *key,
                   int (*compare)(const void *, const void *), bool *found) {
    size_t low = 0;
    size_t high = n;
    *found = false;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        const int order = compare((const char *)items + middle * size, key);
        *found = *found || order == 0;
        if (order < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

static size_t find_job(const subscriptions *w, int64_t job, bool *found) {
    return find(w->jobs, w->n_jobs, sizeof *w->jobs, &job, compare_jobs, found);
}

static size_t find_field(const subscriptions *w, const char *field, bool *found) {
    return find(w->fields, w->n_fields, sizeof *w->fields, &field, compare_fields, found);
}

static void insert_job(subscriptions *w, int64_t job) {
    bool found;
    const size_t i = find_job(w, job, &found);
    if (!found) {
        memmove(&w->jobs[i + 1], &w->jobs[i], (w->n_jobs - i) * sizeof *w->jobs);
        w->jobs[i] = job;
        w->n_jobs++;
    }
}

/* Insert a field, and take over its name. */
static void insert_field(subscriptions *w, char *field) {
    bool found;
    const size_t i = find_field(w, field, &found);
    if (found) {
        free(field);
        return;
    }
    memmove(&w->fields[i + 1], &w->fields[i], (w->n_fields - i) * sizeof *w->fields);
    w->fields[i] = field;
    w->n_fields++;
}

/* Return the number of new subscriptions; a name given twice counts twice. */
static size_t count_new(const subscriptions *w, const sheard_msg_subscribe *what) {
    size_t n = 0;
    bool found;
    for (size_t i = 0; i < what->n_jobs; i++) {
        find_job(w, what->jobs[i], &found);
        n += !found;
    }
    for (size_t i = 0; i < what->n_fields; i++) {
        find_field(w, what->fields[i], &found);
        n += !found;
    }
    return n;
}

static bool reserve(subscriptions *w, const sheard_msg_subscribe *what) {
    return ARRAY_RESERVE(w->jobs, w->job_capacity, w->n_jobs + what->n_jobs) &&
           ARRAY_RESERVE(w->fields, w->field_capacity, w->n_fields + what->n_fields);
}

static char **copy_names(const sheard_msg_subscribe *what) {
    char **names = calloc(what->n_fields + 1, sizeof *names);
    for (size_t i = 0; names != NULL && i < what->n_fields; i++) {
        names[i] = strdup(what->fields[i]);
        if (names[i] == NULL) {
            while (i > 0)
                free(names[--i]);
            free(names);
            return NULL;
        }
    }
    return names;
}

int subscriptions_add(subscriptions *w, const sheard_msg_subscribe *what, size_t limit,
                      sheard_rpc_error *error) {
    if (w->n_jobs + w->n_fields + count_new(w, what) > limit) {
        return sheard_rpc_fail(error, SHEARD_RPC_TOO_MANY_SUBSCRIPTIONS, NULL,
                               "a connection may watch %zu jobs and fields", limit);
    }
    char **names = reserve(w, what) ? copy_names(what) : NULL;
    if (names == NULL) {
        return sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL,
                               "out of memory for a subscription");
    }
    for (size_t i = 0; i < what->n_jobs; i++)
        insert_job(w, what->jobs[i]);
    for (size_t i = 0; i < what->n_fields; i++)
        insert_field(w, names[i]);
    free(names);
    w->all |= what->all;
    w->progress |= what->progress;
    return SHEARD_RPC_OK;
}

bool subscriptions_end_job(subscriptions *w, int64_t job) {
    bool found;
    const size_t i = find_job(w, job, &found);
    if (found) {
        w->n_jobs--;
        memmove(&w->jobs[i], &w->jobs[i + 1], (w->n_jobs - i) * sizeof *w->jobs);
    }
    return found;
}

static void remove_field(subscriptions *w, const char *field) {
    bool found;
    const size_t i = find_field(w, field, &found);
    if (found) {
        free(w->fields[i]);
        w->n_fields--;
        memmove(&w->fields[i], &w->fields[i + 1], (w->n_fields - i) * sizeof *w->fields);
    }
}

void subscriptions_remove(subscriptions *w, const sheard_msg_subscribe *what) {
    for (size_t i = 0; i < what->n_jobs; i++)
        subscriptions_end_job(w, what->jobs[i]);
    for (size_t i = 0; i < what->n_fields; i++)
        remove_field(w, what->fields[i]);
    w->all = w->all && !what->all;
    if (!subscriptions_any(w) || (what->n_jobs == 0 && what->n_fields == 0 && !what->all))
        subscriptions_deinit(w);
}

void subscriptions_deinit(subscriptions *w) {
    for (size_t i = 0; i < w->n_fields; i++)
        free(w->fields[i]);
    free(w->fields);
    free(w->jobs);
    *w = (subscriptions){0};
}

bool subscriptions_any(const subscriptions *w) {
    return w->all || w->n_jobs > 0 || w->n_fields > 0;
}

bool subscriptions_match(const subscriptions *w, enum sheard_notice notice, int64_t job,
                         const char *field) {
    bool found = false;
    if (notice == SHEARD_NOTICE_JOB_PROGRESS && !w->progress)
        return false;
    if (w->all || notice == SHEARD_NOTICE_SERVER_STATE)
        return subscriptions_any(w);
    if (job != 0)
        find_job(w, job, &found);
    if (!found && field != NULL)
        find_field(w, field, &found);
    return found;
}
