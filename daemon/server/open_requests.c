/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/open_requests.h"

#include "base/array.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static void request_free(open_request *r) {
    if (r->work.drop != NULL)
        r->work.drop(r->work.context);
    free(r);
}

void open_requests_init(open_requests *o) {
    *o = (open_requests){0};
    TAILQ_INIT(&o->awake);
}

void open_requests_deinit(open_requests *o) {
    for (size_t i = 0; i < o->n; i++)
        request_free(o->items[i]);
    free(o->items);
    open_requests_init(o);
}

bool open_request_is_long(const sheard_request *request) {
    return request->method == SHEARD_METHOD_WAIT ||
           (request->method == SHEARD_METHOD_SUBMIT && request->params.submit.wait);
}

uint64_t open_requests_add(open_requests *o, const sheard_request *request) {
    open_request *r = ARRAY_RESERVE(o->items, o->capacity, o->n + 1) ? malloc(sizeof *r) : NULL;
    if (r == NULL)
        return 0;
    *r = (open_request){.number = ++o->last,
                        .method = request->method,
                        .is_long = open_request_is_long(request),
                        .id = request->id};
    o->n_long += r->is_long;
    o->items[o->n++] = r;
    return r->number;
}

static int by_number(const void *number, const void *item) {
    const uint64_t a = *(const uint64_t *)number;
    const uint64_t b = (*(open_request *const *)item)->number;
    return (a > b) - (a < b);
}

/* Return the index of the first request whose number is not below `number`. */
static size_t search(const open_requests *o, uint64_t number) {
    return array_lower_bound(o->items, o->n, sizeof(open_request *), &number, by_number);
}

open_request *open_requests_find(const open_requests *o, uint64_t number) {
    const size_t i = search(o, number);
    return i < o->n && o->items[i]->number == number ? o->items[i] : NULL;
}

void open_requests_remove(open_requests *o, open_request *r) {
    const size_t i = search(o, r->number);
    assert(o->items[i] == r);
    open_requests_pause(o, r);
    o->n_long -= r->is_long;
    o->n--;
    memmove(&o->items[i], &o->items[i + 1], (o->n - i) * sizeof(open_request *));
    request_free(r);
}

void open_requests_wake(open_requests *o, open_request *r) {
    if (!r->awake) {
        r->awake = true;
        TAILQ_INSERT_TAIL(&o->awake, r, link);
    }
}

void open_requests_pause(open_requests *o, open_request *r) {
    if (r->awake) {
        r->awake = false;
        TAILQ_REMOVE(&o->awake, r, link);
    }
}
