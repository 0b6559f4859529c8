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
    char **unknown; /* [n_unknown] warnings about unknown names */
    size_t n_unknown;
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
    char *text = NULL;
    if (asprintf(&text, "[access]: there is no %s '%s': nobody has its rights", kind, name) < 0)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a list of users");
    list->unknown[list->n_unknown++] = text;
    return SHEAR_OK;
}

static bool allocate(access_list *list, size_t n_users, size_t n_groups) {
    list->users.ids = calloc(n_users + 1, sizeof(unsigned));
    list->groups.ids = calloc(n_groups + 1, sizeof(unsigned));
    list->unknown = calloc(n_users + n_groups + 1, sizeof *list->unknown);
    return list->users.ids != NULL && list->groups.ids != NULL && list->unknown != NULL;
}

int access_list_new(access_list **out, char *const *users, size_t n_users, char *const *groups,
                    size_t n_groups, shear_error *err) {
    *out = NULL;
    CLEANUP(access_list_release) access_list *list = calloc(1, sizeof *list);
    if (list == NULL || !allocate(list, n_users, n_groups))
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a list of users");
    for (size_t i = 0; i < n_users; i++)
        TRY(add(list, true, users[i], err));
    for (size_t i = 0; i < n_groups; i++)
        TRY(add(list, false, groups[i], err));
    *out = CLEANUP_TAKE(list);
    return SHEAR_OK;
}

void access_list_free(access_list *list) {
    if (list != NULL) {
        for (size_t i = 0; i < list->n_unknown; i++)
            free(list->unknown[i]);
        free(list->unknown);
        free(list->users.ids);
        free(list->groups.ids);
    }
    free(list);
}

const char *access_list_unknown(const access_list *list, size_t i) {
    return i < list->n_unknown ? list->unknown[i] : NULL;
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
