/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "access/walk.h"

#include "access/permission.h"
#include "base/cleanup.h"
#include "base/fingerprint.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { WALK_TRIES = 8 }; /* names may change during a walk, by chance or malice */

int walk_name(int fd, char **name) {
    char path[32];
    char text[PATH_MAX];
    *name = NULL;
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    const ssize_t n = readlink(path, text, sizeof text);
    if (n < 0)
        return errno;
    if (n == (ssize_t)sizeof text)
        return ENAMETOOLONG;
    text[n] = '\0';
    *name = strdup(text);
    return *name == NULL ? ENOMEM : 0;
}

/* Replace the directory *at by its component `name`. */
static int step(int *at, const char *name) {
    const int next = openat(*at, name, O_PATH | O_NOFOLLOW | O_CLOEXEC);
    if (next < 0)
        return errno == EACCES ? EPERM : errno;
    close(*at);
    *at = next;
    return 0;
}

/* Check that every directory above the end of `way` may be searched. `way` is cut into components;
 * *at becomes its end. */
static int walk_along(char *way, const access_peer *peer, int *at) {
    struct stat st;
    char *rest = NULL;
    for (char *name = strtok_r(way, "/", &rest); name != NULL; name = strtok_r(NULL, "/", &rest)) {
        TRY(permission_check(*at, peer, PERMIT_SEARCH, &st));
        TRY(step(at, name));
    }
    return 0;
}

/* Walk once. Return ESTALE if the way does not lead to the target any more. */
static int walk_once(int target, const access_peer *peer, char *way) {
    struct stat end = {0};
    struct stat wanted = {0};
    CLEANUP(release_fd) int at = open("/", O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (at < 0)
        return errno;
    const int error = walk_along(way, peer, &at);
    if (error != 0)
        return error == ENOENT || error == ENOTDIR ? ESTALE : error;
    if (fstat(target, &wanted) != 0 || fstat(at, &end) != 0)
        return errno;
    if (!fingerprint_same_file(&wanted, &end))
        return ESTALE;
    return permission_check(target, peer, S_ISDIR(wanted.st_mode) ? PERMIT_SEARCH : PERMIT_READ,
                            &wanted);
}

/* Walk by the name that the target has now. *name receives it, if `name` is not NULL. */
static int walk_by_name(int target, const access_peer *peer, char **name) {
    CLEANUP(release_free) char *way = NULL;
    TRY(walk_name(target, &way));
    assert(way != NULL);
    CLEANUP(release_free) char *copy = strdup(way);
    TRY(copy == NULL ? ENOMEM : walk_once(target, peer, copy));
    if (name != NULL)
        *name = CLEANUP_TAKE(way);
    return 0;
}

int walk_check(int target, const access_peer *peer, char **name) {
    int error = ESTALE;
    for (int i = 0; i < WALK_TRIES && error == ESTALE; i++)
        error = walk_by_name(target, peer, name);
    if (error != ESTALE)
        return error;
    struct stat st;
    return fstat(target, &st) == 0 && st.st_nlink == 0 ? ENOENT : EAGAIN;
}
