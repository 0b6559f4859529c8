/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/hooks.h: what core asks of the rooms above it; set once, before the loop runs. */
#ifndef SHEARD_SERVICE_HOOKS_H
#define SHEARD_SERVICE_HOOKS_H

#include "sheard/config.h"

typedef struct service service;

typedef struct core_hooks {
    void (*tick)(service *s);          /* once a second */
    void (*engine_events)(service *s); /* the engine has some */
    size_t (*running_jobs)(const service *s);
    void (*stop_jobs)(service *s); /* give them back: they go on at the next start */
    void (*close)(service *s);     /* nothing comes any more: tell what is still to be told */
    /* May these settings replace the present ones? */
    int (*check_reload)(service *s, const sheard_config *fresh, shear_error *err);
} core_hooks;

#endif
