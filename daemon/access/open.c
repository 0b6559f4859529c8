/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Open a file that a client has named, with the client's permissions, and refuse it outside the
 * data roots. */
#include "access/beneath.h"

#include "access/roots.h"
#include "access/walk.h"
#include "base/cleanup.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A file to be opened beneath one root. */
typedef struct request {
    int root;
    const access_peer *peer;
    const char *path;    /* as the client gave it */
    const char *beneath; /* the part of it beneath the root */
} request;

/* Report an error. EACCES is about the peer, EPERM about the service. */
static int fail_plainly(const request *r, int error, shear_error *err) {
    switch (error) {
    case EXDEV:
    case ELOOP:
        return shear_fail(
            err, ACCESS_E_OUTSIDE, "give the file itself, beneath a data root",
            "%.300s: a symbolic link on the way leads out of the data root, or in a loop", r->path);
    case ENOENT:
    case ENOTDIR:
        return shear_fail(err, ACCESS_E_NOT_FOUND, NULL, "%.300s: no such file", r->path);
    case EACCES:
        return shear_fail(err, ACCESS_E_DENIED,
                          "ask its owner for read permission, on the file and its directories",
                          "%.300s: you may not read it", r->path);
    case EPERM:
        return shear_fail(err, ACCESS_E_SERVICE,
                          "let the service's user read it and search its directories",
                          "%.300s: the service may not read it", r->path);
    case ENAMETOOLONG:
        return shear_fail(err, ACCESS_E_PATH, NULL,
                          "%.300s: it or a name in it is too long, or too deep", r->path);
    default:
        return shear_fail(err, error == ENOMEM ? SHEAR_E_NOMEM : SHEAR_E_IO, NULL,
                          "%.300s: cannot be opened: %s", r->path, strerror(error));
    }
}

/* Report an error; `link` is as for beneath_open. Anyone may make a link into a directory that only
 * others may search, so the error must not disclose what is there. */
static int fail_at(const request *r, char link, int error, shear_error *err) {
    if (link != '\0' && link != '/' && r->peer->uid != 0) {
        return shear_fail(err, ACCESS_E_DENIED, "give the file itself, beneath a data root",
                          "%.300s: a link on the way leads to nothing that you and the service "
                          "may read, or out of the data root",
                          r->path);
    }
    return fail_plainly(r, error, err);
}

/* Reopen the regular file of an O_PATH descriptor for reading, even if its name has changed. */
static int reopen(const request *r, int handle, int *fd, shear_error *err) {
    char self[32];
    struct stat st;
    if (fstat(handle, &st) != 0 || !S_ISREG(st.st_mode)) {
        return shear_fail(err, ACCESS_E_NOT_REGULAR, "name a file",
                          "%.300s: is a directory, a device or a pipe, no regular file", r->path);
    }
    snprintf(self, sizeof self, "/proc/self/fd/%d", handle);
    *fd = open(self, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    return *fd >= 0 ? SHEAR_OK : fail_plainly(r, errno == EACCES ? EPERM : errno, err);
}

/* Open r->beneath. The client must have search permission on every directory that it names, from /
 * on, so that it cannot discover what lies in others. */
static int open_beneath(const request *r, int *fd, char **canonical, shear_error *err) {
    char link = '\0';
    int error = walk_check(r->root, r->peer, NULL);
    if (error != 0)
        return fail_plainly(r, error, err);
    const int handle = beneath_open(r->root, r->beneath, r->peer, &link);
    if (handle < 0)
        return fail_at(r, link, -handle, err);
    error = walk_check(handle, r->peer, canonical);
    const int code = error != 0 ? fail_at(r, link, error, err) : reopen(r, handle, fd, err);
    close(handle);
    if (code != SHEAR_OK) {
        free(*canonical);
        *canonical = NULL;
    }
    return code;
}

static int check_path(const char *path, shear_error *err) {
    const char *wrong = path[0] != '/'             ? "is not absolute"
                        : strlen(path) >= PATH_MAX ? "is too long"
                        : path_climbs(path)        ? "has '..' in it"
                                                   : NULL;
    return wrong == NULL ? SHEAR_OK
                         : shear_fail(err, ACCESS_E_PATH, "give an absolute path without '..'",
                                      "%.300s: the path %s", path, wrong);
}

/* Open the path if it is beneath that root: by the root's configured name (by_name), or else by its
 * name without links. Return ACCESS_E_OUTSIDE, with *err unchanged, if the path is not beneath it
 * or the root is missing. */
static int try_root(const char *name, bool by_name, request *r, int *fd, char **canonical,
                    shear_error *err) {
    char *real = NULL;
    int code = ACCESS_E_OUTSIDE;
    r->beneath = path_beneath(r->path, name);
    if ((r->beneath != NULL) != by_name || root_open(name, &r->root, NULL) != SHEAR_OK)
        return code;
    if (!by_name && walk_name(r->root, &real) == 0)
        r->beneath = path_beneath(r->path, real);
    if (r->beneath != NULL)
        code = open_beneath(r, fd, canonical, err);
    free(real);
    close(r->root);
    return code;
}

/* Try the roots in turn. If roots are nested, a link may leave the inner one only, or that one is
 * missing. */
static int try_roots(const access_roots *roots, bool by_name, request *r, int *fd, char **canonical,
                     shear_error *err) {
    int code = ACCESS_E_OUTSIDE;
    for (size_t i = 0; i < roots->names.n && code == ACCESS_E_OUTSIDE; i++)
        code = try_root(roots->names.items[i], by_name, r, fd, canonical, err);
    return code;
}

/* Return ACCESS_E_ROOT if a root that the path is beneath is missing. */
static int check_roots_of(const access_roots *roots, const char *path, shear_error *err) {
    for (size_t i = 0; i < roots->names.n; i++) {
        if (path_beneath(path, roots->names.items[i]) != NULL)
            TRY(access_root_check(roots->names.items[i], err));
    }
    return SHEAR_OK;
}

int access_open(const access_roots *roots, const access_peer *peer, const char *path, int *fd,
                char **canonical, shear_error *err) {
    int code = check_path(path, err);
    char advice[200];
    request r = {.root = -1, .peer = peer, .path = path};
    *fd = -1;
    *canonical = NULL;
    if (code != SHEAR_OK)
        return code;
    snprintf(advice, sizeof advice, "data roots: %s", roots->text);
    shear_fail(err, ACCESS_E_OUTSIDE, advice, "%.300s: is not beneath a data root", path);
    code = try_roots(roots, true, &r, fd, canonical, err);
    if (code == ACCESS_E_OUTSIDE)
        code = try_roots(roots, false, &r, fd, canonical, err);
    const bool maybe_missing = code == ACCESS_E_OUTSIDE || code == ACCESS_E_NOT_FOUND;
    return maybe_missing && check_roots_of(roots, path, err) != SHEAR_OK ? ACCESS_E_ROOT : code;
}
