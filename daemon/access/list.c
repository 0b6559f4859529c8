/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists of users and groups, by number. */
#include "permission.h"

#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <stdlib.h>
#include <string.h>

struct access_list {
    uid_t *users;
    gid_t *groups;
    size_t n_users, n_groups;
};

/* A name of digits only, below (uid_t)-1, which is nobody. */
static bool read_number(const char *name, unsigned *id) {
    const size_t n = strlen(name);
    if (n == 0 || n > 10 || strspn(name, "0123456789") != n) {
        return false;
    }
    const unsigned long long value = strtoull(name, NULL, 10);
    *id = (unsigned)value;
    return value < 0xffffffffULL;
}

static int fail_name(int error, const char *kind, const char *name, shear_error *err) {
    if (error == 0 || error == ENOENT || error == ESRCH) {
        return shear_fail(err, SHEAR_E_SETTING, "see the names in the section [access]",
                          "there is no %s '%s'", kind, name);
    }
    return shear_fail(err, SHEAR_E_IO, NULL, "%s '%s' cannot be looked up: %s", kind, name,
                      strerror(error));
}

static int find_user(const char *name, uid_t *id, shear_error *err) {
    char texts[16384];
    struct passwd entry;
    struct passwd *found = NULL;
    const int error = getpwnam_r(name, &entry, texts, sizeof texts, &found);
    if (found != NULL) {
        *id = entry.pw_uid;
        return SHEAR_OK;
    }
    return read_number(name, id) ? SHEAR_OK : fail_name(error, "user", name, err);
}

/* Returns 0 or errno; *found tells. The members of a large group may need much room. */
static int ask_for_group(const char *name, gid_t *id, bool *found) {
    struct group entry;
    struct group *result = NULL;
    char *texts = NULL;
    int error = ERANGE;
    for (size_t size = 16384; error == ERANGE && size <= (size_t)1 << 26; size *= 4) {
        char *more = realloc(texts, size);
        if (more == NULL) {
            error = ENOMEM;
            break;
        }
        texts = more;
        error = getgrnam_r(name, &entry, texts, size, &result);
    }
    *found = result != NULL;
    if (*found) {
        *id = entry.gr_gid;
    }
    free(texts);
    return error;
}

static int find_group(const char *name, gid_t *id, shear_error *err) {
    bool found = false;
    const int error = ask_for_group(name, id, &found);
    return found || read_number(name, id) ? SHEAR_OK : fail_name(error, "group", name, err);
}

int access_list_new(access_list **out, char *const *users, size_t n_users, char *const *groups,
                    size_t n_groups, shear_error *err) {
    int code = SHEAR_OK;
    *out = NULL;
    access_list *list = calloc(1, sizeof *list);
    if (list != NULL) {
        list->users = calloc(n_users + 1, sizeof *list->users);
        list->groups = calloc(n_groups + 1, sizeof *list->groups);
    }
    if (list == NULL || list->users == NULL || list->groups == NULL) {
        access_list_free(list);
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a list of users");
    }
    for (; list->n_users < n_users && code == SHEAR_OK; list->n_users++) {
        code = find_user(users[list->n_users], &list->users[list->n_users], err);
    }
    for (; list->n_groups < n_groups && code == SHEAR_OK; list->n_groups++) {
        code = find_group(groups[list->n_groups], &list->groups[list->n_groups], err);
    }
    if (code != SHEAR_OK) {
        access_list_free(list);
        return code;
    }
    *out = list;
    return SHEAR_OK;
}

void access_list_free(access_list *list) {
    if (list != NULL) {
        free(list->users);
        free(list->groups);
    }
    free(list);
}

bool access_list_has(const access_list *list, const access_peer *peer) {
    for (size_t i = 0; i < list->n_users; i++) {
        if (list->users[i] == peer->uid) {
            return true;
        }
    }
    for (size_t i = 0; i < list->n_groups; i++) {
        if (peer_has_group(peer, list->groups[i])) {
            return true;
        }
    }
    return false;
}
