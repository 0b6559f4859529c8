/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/accounts.h"

#include "base/cleanup.h"

#include <errno.h>
#include <grp.h>
#include <pwd.h>

static int ask_for_user(const char *name, char *texts, size_t size, id_t *id) {
    struct passwd entry;
    struct passwd *found = NULL;
    const int error = getpwnam_r(name, &entry, texts, size, &found);
    if (found != NULL)
        *id = found->pw_uid;
    return found == NULL && error == 0 ? ENOENT : error;
}

static int ask_for_group(const char *name, char *texts, size_t size, id_t *id) {
    struct group entry;
    struct group *found = NULL;
    const int error = getgrnam_r(name, &entry, texts, size, &found);
    if (found != NULL)
        *id = found->gr_gid;
    return found == NULL && error == 0 ? ENOENT : error;
}

/* Ask with more and more memory: the members of a large group may need much. */
static int find(int (*ask)(const char *, char *, size_t, id_t *), const char *name, id_t *id) {
    enum { LEAST = 1 << 14, MOST = 1 << 26 };
    int error = ERANGE;
    for (size_t size = LEAST; error == ERANGE && size <= MOST; size *= 4) {
        CLEANUP(release_free) char *texts = malloc(size);
        error = texts != NULL ? ask(name, texts, size, id) : ENOMEM;
    }
    return error == ESRCH ? ENOENT : error;
}

int accounts_find_user(const char *name, uid_t *id) {
    return find(ask_for_user, name, id);
}

int accounts_find_group(const char *name, gid_t *id) {
    return find(ask_for_group, name, id);
}
