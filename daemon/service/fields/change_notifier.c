/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields that changed: told once a second, however often they change, and the last change always.
 */
#include "service/inner.h"

#include <stdlib.h>
#include <string.h>

struct changed_field {
    changed_field *next;
    char *name, *digest;
    int64_t since;     /* solutions_since */
    bool being_solved; /* it waits for its result */
    bool again;        /* and has changed meanwhile */
    int64_t round;     /* the last one that it had its turn in */
};

static void changed_free(changed_field *f) {
    free(f->name);
    free(f->digest);
    free(f);
}

static changed_field *noted(const service *s, const char *name, const char *digest) {
    changed_field *f = s->news;
    while (f != NULL && (strcmp(f->name, name) != 0 || strcmp(f->digest, digest) != 0)) {
        f = f->next;
    }
    return f;
}

void news_field_changed(service *s, const char *name, const char *digest) {
    changed_field *f = name != NULL ? noted(s, name, digest) : NULL;
    if (f != NULL) {
        f->again = f->being_solved;
        return;
    }
    if (name == NULL || !server_is_watched(s->server, SHEARD_NOTICE_FIELD_CHANGED, 0, name)) {
        return;
    }
    f = calloc(1, sizeof *f);
    if (f == NULL) {
        return;
    }
    *f = (changed_field){.next = s->news,
                         .name = strdup(name),
                         .digest = strdup(digest),
                         .since = solutions_begun(s)};
    if (f->name == NULL || f->digest == NULL) {
        changed_free(f);
        return;
    }
    s->news = f;
}

/* Nothing is counted in it any more. */
static void publish_gone(service *s, const changed_field *f, bool mixed) {
    const store_field gone = {.name = f->name, .settings_digest = f->digest};
    sheard_notice_params params = {0};
    present_summary(s, &gone, &params.field_changed.field);
    params.field_changed.field.mixed = mixed;
    server_publish(s->server, SHEARD_NOTICE_FIELD_CHANGED, 0, f->name, &params);
}

/* False where its result is still being solved. */
static bool publish(service *s, const changed_field *f) {
    store_field_page page = {0};
    shear_error ignored;
    bool at_hand = true;
    const int code = store_field_get(s->store, f->name, &page, &ignored);
    if (code != SHEAR_OK && code != STORE_NOT_FOUND) {
        return true;
    }
    bool found = false;
    solutions_since(s, f->since);
    for (size_t i = 0; i < page.n; i++) {
        if (strcmp(page.fields[i].settings_digest, f->digest) != 0) {
            continue;
        }
        found = true;
        at_hand = solutions_at_hand(s, &page.fields[i]);
        if (at_hand) {
            sheard_notice_params params = {0};
            present_summary(s, &page.fields[i], &params.field_changed.field);
            params.field_changed.field.mixed = page.n > 1;
            server_publish(s->server, SHEARD_NOTICE_FIELD_CHANGED, 0, f->name, &params);
        }
    }
    solutions_since(s, INT64_MAX);
    if (!found) {
        publish_gone(s, f, page.n > 0);
    }
    store_field_page_deinit(&page);
    return at_hand;
}

enum { SLICE_NS = 2000000, PAUSE_MS = 5 };

static void publish_some(service *s, uint64_t end);

static void on_soon(uv_timer_t *timer) {
    publish_some(timer->data, uv_hrtime() + SLICE_NS);
}

/* Those that have not had their turn in this round, until the time is over: the rest soon. */
static void publish_some(service *s, uint64_t end) {
    for (changed_field **at = &s->news; *at != NULL;) {
        changed_field *f = *at;
        if (f->round == s->news_round) {
            at = &f->next;
            continue;
        }
        if (uv_hrtime() >= end) {
            uv_timer_start(&s->news_soon, on_soon, PAUSE_MS, 0);
            return;
        }
        f->round = s->news_round;
        f->being_solved = !publish(s, f);
        if (f->being_solved || f->again) {
            f->since = f->being_solved ? f->since : solutions_begun(s);
            f->again = f->again && f->being_solved;
            at = &f->next;
        } else {
            *at = f->next;
            changed_free(f);
        }
    }
}

void news_publish(service *s) {
    s->news_round++;
    publish_some(s, uv_hrtime() + SLICE_NS);
}

void news_publish_all(service *s) {
    s->news_round++;
    publish_some(s, UINT64_MAX);
}

void news_free(service *s) {
    while (s->news != NULL) {
        changed_field *f = s->news;
        s->news = f->next;
        changed_free(f);
    }
}
