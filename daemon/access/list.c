/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Look up users and groups by name, and match peers against them. */
#include "access/permission.h"
#include "base/cleanup.h"

#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct access_list {
    uid_t *users;
    gid_t *groups;
    char **unknown; /* warnings about unknown names */
    size_t n_users, n_groups, n_unknown;
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

/* Record a warning about an unknown name, or return an error if the database failed. */
static int not_found(access_list *list, int error, const char *kind, const char *name,
                     shear_error *err) {
    if (error != 0 && error != ENOENT && error != ESRCH) {
        return shear_fail(err, SHEAR_E_IO, NULL, "%s '%s' cannot be looked up: %s", kind, name,
                          strerror(error));
    }
    char *text = NULL;
    if (asprintf(&text, "[access]: there is no %s '%s': nobody has its rights", kind, name) < 0)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a list of users");
    list->unknown[list->n_unknown++] = text;
    return SHEAR_OK;
}

static int add_user(access_list *list, const char *name, shear_error *err) {
    char texts[16384];
    struct passwd entry;
    struct passwd *found = NULL;
    uid_t *id = &list->users[list->n_users];
    const int error = getpwnam_r(name, &entry, texts, sizeof texts, &found);
    if (found != NULL) {
        *id = entry.pw_uid;
    } else if (!read_number(name, id)) {
        return not_found(list, error, "user", name, err);
    }
    list->n_users++;
    return SHEAR_OK;
}

/* Look up a group. Return 0 or errno; *found says whether it exists. The members of a large group
 * may need much memory. */
static int ask_for_group(const char *name, gid_t *id, bool *found) {
    struct group entry;
    struct group *result = NULL;
    CLEANUP(release_free) char *texts = NULL;
    int error = ERANGE;
    for (size_t size = 16384; error == ERANGE && size <= (size_t)1 << 26; size *= 4) {
        char *more = realloc(texts, size);
        if (more == NULL)
            return ENOMEM;
        texts = more;
        error = getgrnam_r(name, &entry, texts, size, &result);
    }
    *found = result != NULL;
    if (*found)
        *id = entry.gr_gid;
    return error;
}

static int add_group(access_list *list, const char *name, shear_error *err) {
    bool found = false;
    gid_t *id = &list->groups[list->n_groups];
    const int error = ask_for_group(name, id, &found);
    if (!found && !read_number(name, id))
        return not_found(list, error, "group", name, err);
    list->n_groups++;
    return SHEAR_OK;
}

static bool allocate(access_list *list, size_t n_users, size_t n_groups) {
    list->users = calloc(n_users + 1, sizeof *list->users);
    list->groups = calloc(n_groups + 1, sizeof *list->groups);
    list->unknown = calloc(n_users + n_groups + 1, sizeof *list->unknown);
    return list->users != NULL && list->groups != NULL && list->unknown != NULL;
}

int access_list_new(access_list **out, char *const *users, size_t n_users, char *const *groups,
                    size_t n_groups, shear_error *err) {
    *out = NULL;
    CLEANUP(access_list_release) access_list *list = calloc(1, sizeof *list);
    if (list == NULL || !allocate(list, n_users, n_groups))
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a list of users");
    for (size_t i = 0; i < n_users + n_groups; i++) {
        const int code =
            i < n_users ? add_user(list, users[i], err) : add_group(list, groups[i - n_users], err);
        if (code != SHEAR_OK)
            return code;
    }
    *out = CLEANUP_TAKE(list);
    return SHEAR_OK;
}

void access_list_free(access_list *list) {
    if (list != NULL) {
        for (size_t i = 0; i < list->n_unknown; i++)
            free(list->unknown[i]);
        free(list->unknown);
        free(list->users);
        free(list->groups);
    }
    free(list);
}

const char *access_list_unknown(const access_list *list, size_t i) {
    return i < list->n_unknown ? list->unknown[i] : NULL;
}

bool access_list_has(const access_list *list, const access_peer *peer) {
    for (size_t i = 0; i < list->n_users; i++) {
        if (list->users[i] == peer->uid)
            return true;
    }
    for (size_t i = 0; i < list->n_groups; i++) {
        if (peer_has_group(peer, list->groups[i]))
            return true;
    }
    return false;
}
