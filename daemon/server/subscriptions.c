/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/subscriptions.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

static int compare(const void *a, const void *b) {
    const subscription *x = a;
    const subscription *y = b;
    if (x->field != NULL && y->field != NULL)
        return strcmp(x->field, y->field);
    if (x->field != NULL || y->field != NULL)
        return x->field != NULL ? 1 : -1;
    return (x->job > y->job) - (x->job < y->job);
}

/* Return the index of a subscription, or where it would be inserted. */
static size_t find(const subscriptions *w, subscription one, bool *found) {
    const size_t i = array_lower_bound(w->items, w->n, sizeof *w->items, &one, compare);
    *found = i < w->n && compare(&one, &w->items[i]) == 0;
    return i;
}

static bool has(const subscriptions *w, subscription one) {
    bool found;
    find(w, one, &found);
    return found;
}

/* Insert a subscription, and take over its name. */
static void insert(subscriptions *w, subscription one) {
    bool found;
    const size_t i = find(w, one, &found);
    if (found) {
        free(one.field);
        return;
    }
    memmove(&w->items[i + 1], &w->items[i], (w->n - i) * sizeof *w->items);
    w->items[i] = one;
    w->n++;
    w->n_jobs += one.field == NULL;
}

/* Return false if there was no such subscription. */
static bool take_out(subscriptions *w, subscription one) {
    bool found;
    const size_t i = find(w, one, &found);
    if (found) {
        free(w->items[i].field);
        w->n--;
        w->n_jobs -= one.field == NULL;
        memmove(&w->items[i], &w->items[i + 1], (w->n - i) * sizeof *w->items);
    }
    return found;
}

/* ---- what a request names ---- */

static size_t count(const sheard_msg_subscribe *what) {
    return what->n_jobs + what->n_fields;
}

/* Return the i-th, i < count. */
static subscription at(const sheard_msg_subscribe *what, size_t i) {
    return i < what->n_jobs ? (subscription){.job = what->jobs[i]}
                            : (subscription){.field = (char *)what->fields[i - what->n_jobs]};
}

/* Return the number of new subscriptions; a name given twice counts twice. */
static size_t count_new(const subscriptions *w, const sheard_msg_subscribe *what) {
    size_t n = 0;
    for (size_t i = 0; i < count(what); i++)
        n += !has(w, at(what, i));
    return n;
}

static void free_items(subscription *items, size_t n) {
    for (size_t i = 0; i < n; i++)
        free(items[i].field);
    free(items);
}

/* Return copies of all of them, or NULL if out of memory. */
static subscription *copy(const sheard_msg_subscribe *what) {
    subscription *items = calloc(count(what) + 1, sizeof *items);
    for (size_t i = 0; items != NULL && i < count(what); i++) {
        const subscription one = at(what, i);
        items[i] = (subscription){one.job, one.field != NULL ? strdup(one.field) : NULL};
        if (one.field != NULL && items[i].field == NULL) {
            free_items(items, i);
            return NULL;
        }
    }
    return items;
}

/* ---- public functions ---- */

int subscriptions_add(subscriptions *w, const sheard_msg_subscribe *what, size_t limit,
                      sheard_rpc_error *error) {
    if (w->n + count_new(w, what) > limit) {
        return sheard_rpc_fail(error, SHEARD_RPC_TOO_MANY_SUBSCRIPTIONS, NULL,
                               "a connection may watch %zu jobs and fields", limit);
    }
    subscription *items =
        ARRAY_RESERVE(w->items, w->capacity, w->n + count(what)) ? copy(what) : NULL;
    if (items == NULL) {
        return sheard_rpc_fail(error, SHEARD_RPC_OUT_OF_MEMORY, NULL,
                               "out of memory for a subscription");
    }
    for (size_t i = 0; i < count(what); i++)
        insert(w, items[i]);
    free(items);
    w->all |= what->all;
    w->progress |= what->progress;
    return SHEARD_RPC_OK;
}

bool subscriptions_end_job(subscriptions *w, int64_t job) {
    return take_out(w, (subscription){.job = job});
}

void subscriptions_remove(subscriptions *w, const sheard_msg_subscribe *what) {
    for (size_t i = 0; i < count(what); i++)
        take_out(w, at(what, i));
    w->all = w->all && !what->all;
    if (!subscriptions_any(w) || (count(what) == 0 && !what->all))
        subscriptions_deinit(w);
}

void subscriptions_deinit(subscriptions *w) {
    free_items(w->items, w->n);
    *w = (subscriptions){0};
}

bool subscriptions_any(const subscriptions *w) {
    return w->all || w->n > 0;
}

bool subscriptions_match(const subscriptions *w, enum sheard_notice notice, int64_t job,
                         const char *field) {
    if (notice == SHEARD_NOTICE_JOB_PROGRESS && !w->progress)
        return false;
    if (w->all || notice == SHEARD_NOTICE_SERVER_STATE)
        return subscriptions_any(w);
    return (job != 0 && has(w, (subscription){.job = job})) ||
           (field != NULL && has(w, (subscription){.field = (char *)field}));
}
