/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/fields/change_notifier.h: publish changed fields once a second, however often they
 * change; the last change is always published. */
#pragma once

#include "store/store.h"

#include <uv.h>

typedef struct service service;
typedef struct changed_field changed_field;

typedef struct change_notifier {
    changed_field *first;
    uv_timer_t soon; /* publishes the rest of a round */
    int64_t round;
} change_notifier;

void change_notifier_init(change_notifier *n, service *s);
void change_notifier_deinit(change_notifier *n);
/* Note that a field has changed. `name` NULL: it is not known yet, and nothing is done. */
void change_notifier_note(service *s, const char *name, const char *digest);
void change_notifier_tick(service *s);  /* once a second: publish the changes, a few at a time */
void change_notifier_flush(service *s); /* publish all of them now */
