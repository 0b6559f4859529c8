/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/permissions.h: who may do what: the users and groups of [access], looked up. */
#pragma once

#include "access/access.h"
#include "sheard/config.h"

typedef struct permissions {
    access_list *admins;
    access_list *submitters;
    access_list *priority; /* may set priorities above 0 */
    bool anyone_submits;   /* submit_groups is empty */
    access_roots *roots;   /* directories beneath which files may be submitted */
} permissions;

/* Look up the users, groups and data roots of the configuration. Deinit *p in either
 * case. */
int permissions_init(permissions *p, const sheard_config *config, shear_error *err);
void permissions_deinit(permissions *p);
bool permissions_is_admin(const permissions *p, const access_peer *peer);
bool permissions_may_submit(const permissions *p, const access_peer *peer);
bool permissions_may_give_priority(const permissions *p, const access_peer *peer);
/* Return the message about the i-th configured name that no user or group has, borrowed, or NULL if
 * there are no more. */
const char *permissions_unknown(const permissions *p, size_t i);
