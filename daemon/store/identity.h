/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/identity.h: find the counted job with the same identity: field, settings, content. */
#pragma once

#include "store/database.h"

typedef struct identity_match {
    int64_t job; /* the first job counted with this identity; 0: none */
    int64_t n_stamps, n_used;
} identity_match;

/* Find the match. `field` and `content` may be NULL (not known): then there is none. */
int identity_find(store *s, const char *field, const char *settings_digest, const char *content,
                  identity_match *match, shear_error *err);
