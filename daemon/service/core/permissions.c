/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/permissions.h"

#include "base/cleanup.h"

int permissions_init(permissions *p, const sheard_config *c, shear_error *err) {
    static const sheard_list nobody = {0};
    *p = (permissions){.anyone_submits = c->access.submit_groups.n == 0};
    TRY(access_list_new(&p->admins, &c->access.admin_users, &c->access.admin_groups, err));
    TRY(access_list_new(&p->submitters, &nobody, &c->access.submit_groups, err));
    TRY(access_list_new(&p->priority, &c->access.priority_users, &c->access.priority_groups, err));
    return access_roots_new(&p->roots, c->access.data_roots.items, c->access.data_roots.n, err);
}

void permissions_deinit(permissions *p) {
    access_list_free(p->admins);
    access_list_free(p->submitters);
    access_list_free(p->priority);
    access_roots_free(p->roots);
    *p = (permissions){0};
}

bool permissions_is_admin(const permissions *p, const access_peer *peer) {
    return peer->uid == 0 || access_list_has(p->admins, peer);
}

bool permissions_may_submit(const permissions *p, const access_peer *peer) {
    return p->anyone_submits || access_list_has(p->submitters, peer) ||
           permissions_is_admin(p, peer);
}

bool permissions_may_give_priority(const permissions *p, const access_peer *peer) {
    return permissions_is_admin(p, peer) || access_list_has(p->priority, peer);
}

const char *permissions_unknown(const permissions *p, size_t i) {
    const access_list *const lists[] = {p->admins, p->submitters, p->priority};
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) {
        const char *text = NULL;
        for (size_t j = 0; (text = access_list_unknown(lists[k], j)) != NULL; j++) {
            if (i-- == 0)
                return text;
        }
    }
    return NULL;
}
