/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/fields/change_notifier.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "service/core/parts.h"
#include "service/fields/estimates.h"
#include "service/fields/field_message.h"

enum { SLICE_NS = 2000000, PAUSE_MS = 5 };

struct changed_field {
    changed_field *next;
    char name[STORE_FIELD_MAX + 1], digest[STORE_DIGEST_MAX + 1];
    int64_t since;     /* see fields/estimates.h */
    bool being_solved; /* the last attempt found its result still being solved */
    bool again;        /* it has changed since that attempt */
    int64_t round;     /* the last round in which it was tried */
};

void change_notifier_init(change_notifier *n, service *s) {
    uv_timer_init(&s->loop, &n->soon);
    n->soon.data = s;
}

void change_notifier_deinit(change_notifier *n) {
    while (n->first != NULL) {
        changed_field *f = n->first;
        n->first = f->next;
        free(f);
    }
}

static changed_field *find(const change_notifier *n, const char *name, const char *digest) {
    changed_field *f = n->first;
    while (f != NULL && (strcmp(f->name, name) != 0 || strcmp(f->digest, digest) != 0))
        f = f->next;
    return f;
}

void change_notifier_note(service *s, const char *name, const char *digest) {
    change_notifier *n = s->notifier;
    changed_field *f = name != NULL ? find(n, name, digest) : NULL;
    if (f != NULL) {
        f->again = f->being_solved;
        return;
    }
    if (name == NULL || !server_is_watched(s->server, SHEARD_NOTICE_FIELD_CHANGED, 0, name))
        return;
    f = calloc(1, sizeof *f);
    if (f == NULL)
        return;
    *f = (changed_field){.next = n->first, .since = s->estimates->begun};
    text_set(f->name, sizeof f->name, name);
    text_set(f->digest, sizeof f->digest, digest);
    n->first = f;
}

/* Publish the field. False: its result is still being solved. */
static bool publish(service *s, changed_field *f) {
    CLEANUP(store_field_page_deinit) store_field_page page = {0};
    shear_error ignored;
    const int code = store_field_get(s->store, f->name, &page, &ignored);
    if (code != SHEAR_OK && code != STORE_NOT_FOUND)
        return true;
    const store_field *row = store_field_page_find(&page, f->digest);
    if (row != NULL && !estimates_at_hand(s, row, f->since))
        return false;
    store_field gone = {.name = f->name, .settings_digest = f->digest};
    const size_t others = row != NULL ? page.n - 1 : page.n;
    field_message_publish(s, row != NULL ? row : &gone, others > 0, f->since);
    return true;
}

/* Publish the field, or leave it for the next round. Return true if it has been published and has
 * not changed since. */
static bool is_told(service *s, changed_field *f) {
    f->round = s->notifier->round;
    f->being_solved = !publish(s, f);
    if (f->being_solved)
        return false;
    const bool told = !f->again;
    f->again = false;
    f->since = s->estimates->begun;
    return told;
}

static void publish_some(service *s, uint64_t end);

static void on_soon(uv_timer_t *timer) {
    publish_some(timer->data, uv_hrtime() + SLICE_NS);
}

/* Publish fields that have not been tried in this round, until uv_hrtime() reaches `end`; a timer
 * continues with the rest. */
static void publish_some(service *s, uint64_t end) {
    change_notifier *n = s->notifier;
    for (changed_field **at = &n->first; *at != NULL;) {
        changed_field *f = *at;
        if (f->round == n->round) {
            at = &f->next;
            continue;
        }
        if (uv_hrtime() >= end) {
            uv_timer_start(&n->soon, on_soon, PAUSE_MS, 0);
            return;
        }
        if (is_told(s, f)) {
            *at = f->next;
            free(f);
        } else {
            at = &f->next;
        }
    }
}

void change_notifier_tick(service *s) {
    s->notifier->round++;
    publish_some(s, uv_hrtime() + SLICE_NS);
}

void change_notifier_flush(service *s) {
    s->notifier->round++;
    publish_some(s, UINT64_MAX);
}
