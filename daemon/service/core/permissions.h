/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/permissions.h: who may do what: [access] of the configuration, looked up. */
#ifndef SHEARD_SERVICE_PERMISSIONS_H
#define SHEARD_SERVICE_PERMISSIONS_H

#include "access/access.h"
#include "sheard/config.h"

typedef struct permissions {
    access_list *admins;
    access_list *submitters;
    access_list *priority; /* who may give priorities above 0 */
    bool anyone_submits;   /* there are no submit_groups */
    access_roots *roots;   /* files beneath these may be named */
} permissions;

/* All or nothing. */
int permissions_init(permissions *p, const sheard_config *config, shear_error *err);
void permissions_deinit(permissions *p);
bool permissions_is_admin(const permissions *p, const access_peer *peer);
bool permissions_may_submit(const permissions *p, const access_peer *peer);
bool permissions_may_give_priority(const permissions *p, const access_peer *peer);
/* What is to be said of configured names that nobody has, into list[capacity]; how many. `list`
 * NULL: they are counted. */
size_t permissions_unknown(const permissions *p, const char **list, size_t capacity);

#endif
