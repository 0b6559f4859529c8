/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/identity.h: what makes two jobs the same contribution: field, settings, content. */
#ifndef SHEARD_STORE_IDENTITY_H
#define SHEARD_STORE_IDENTITY_H

#include "store/database.h"

typedef struct identity_match {
    int64_t job; /* the first one counted with this identity; 0: none */
    int64_t n_stamps, n_used;
} identity_match;

/* field and content may be NULL (not known): then nothing matches. */
int identity_find(store *s, const char *field, const char *settings_digest, const char *content,
                  identity_match *match, shear_error *err);

/* The id of a field's row. STORE_NOT_FOUND where there is none. */
int field_find(store *s, const char *name, const char *settings_digest, int64_t *id,
               shear_error *err);

/* The stamp that counts most of what is counted in the field, as a join of all would tell it, and
 * the account of its contribution (the caller's; NULL: not wanted). */
int field_top(store *s, int64_t field, shear_influence *top, char **account, shear_error *err);

#endif
