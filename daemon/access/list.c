/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Look up users and groups by name, and match peers against them. */
#include "access/permission.h"
#include "base/accounts.h"
#include "base/cleanup.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The ids of one kind. */
typedef struct id_set {
    unsigned *ids; /* [n] */
    size_t n;
} id_set;

struct access_list {
    id_set users, groups;
    sheard_list unknown; /* warnings about unknown names */
};

CLEANUP_DEFINE(access_list, access_list_free)

/* Read a name of digits as an id below (uid_t)-1, which is invalid. */
static bool read_number(const char *name, unsigned *id) {
    const size_t n = strlen(name);
    if (n == 0 || n > 10 || strspn(name, "0123456789") != n)
        return false;
    const unsigned long long value = strtoull(name, NULL, 10);
    *id = (unsigned)value;
    return value < 0xffffffffULL;
}

/* Add the id of a name, or a warning if it is unknown. Return an error if the database failed. */
static int add(access_list *list, bool is_user, const char *name, shear_error *err) {
    const char *kind = is_user ? "user" : "group";
    id_set *set = is_user ? &list->users : &list->groups;
    unsigned *id = &set->ids[set->n];
    const int error = is_user ? accounts_find_user(name, id) : accounts_find_group(name, id);
    if (error == 0 || read_number(name, id)) {
        set->n++;
        return SHEAR_OK;
    }
    if (error != ENOENT) {
        return shear_fail(err, SHEAR_E_IO, NULL, "%s '%s' cannot be looked up: %s", kind, name,
                          strerror(error));
    }
    CLEANUP(release_free) char *text = NULL;
    if (asprintf(&text, "[access]: there is no %s '%s': nobody has its rights", kind, name) < 0)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a list of users");
    return sheard_list_append(&list->unknown, text, err);
}

static bool allocate(access_list *list, size_t n_users, size_t n_groups) {
    list->users.ids = calloc(n_users + 1, sizeof(unsigned));
    list->groups.ids = calloc(n_groups + 1, sizeof(unsigned));
    return list->users.ids != NULL && list->groups.ids != NULL;
}

int access_list_new(access_list **out, const sheard_list *users, const sheard_list *groups,
                    shear_error *err) {
    *out = NULL;
    CLEANUP(access_list_release) access_list *list = calloc(1, sizeof *list);
    if (list == NULL || !allocate(list, users->n, groups->n))
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a list of users");
    for (size_t i = 0; i < users->n; i++)
        TRY(add(list, true, users->items[i], err));
    for (size_t i = 0; i < groups->n; i++)
        TRY(add(list, false, groups->items[i], err));
    *out = CLEANUP_TAKE(list);
    return SHEAR_OK;
}

void access_list_free(access_list *list) {
    if (list != NULL) {
        sheard_list_deinit(&list->unknown);
        free(list->users.ids);
        free(list->groups.ids);
    }
    free(list);
}

const char *access_list_unknown(const access_list *list, size_t i) {
    return i < list->unknown.n ? list->unknown.items[i] : NULL;
}

bool access_list_has(const access_list *list, const access_peer *peer) {
    for (size_t i = 0; i < list->users.n; i++) {
        if (list->users.ids[i] == peer->uid)
            return true;
    }
    for (size_t i = 0; i < list->groups.n; i++) {
        if (peer_has_group(peer, list->groups.ids[i]))
            return true;
    }
    return false;
}
