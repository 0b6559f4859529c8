/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/change_notifier.h: publish changed fields once a second, however often they
 * change; the last change is always published. */
#pragma once

#include "store/store.h"

#include <uv.h>

typedef struct service service;
typedef struct changed_field changed_field;

/* Publish a field to subscribers. `mixed`: the field also has results by other settings; `since`:
 * see fields/estimates.h. A field without contributions is gone. */
typedef void change_publish(service *s, const store_field *f, bool mixed, int64_t since);

typedef struct change_notifier {
    changed_field *first;
    change_publish *publish;
    uv_timer_t soon; /* publishes the rest of a round */
    int64_t round;
} change_notifier;

void change_notifier_init(change_notifier *n, service *s, change_publish *publish);
void change_notifier_deinit(change_notifier *n);
/* Note that a field has changed. `name` NULL: it is not known yet, and nothing is done. */
void change_notifier_note(service *s, const char *name, const char *digest);
void change_notifier_tick(service *s);  /* once a second: publish the changes, a few at a time */
void change_notifier_flush(service *s); /* publish all of them now */
