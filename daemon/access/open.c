/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opening a file that a client has named. */
#include "permission.h"
#include "roots.h"
#include "walk.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/openat2.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

const char *access_code_name(int code) {
    static const char *const names[] = {"bad_path",          "outside_roots",  "not_found",
                                        "permission_denied", "service_denied", "not_regular"};
    return code >= ACCESS_E_PATH && code <= ACCESS_E_NOT_REGULAR ? names[code - ACCESS_E_PATH]
                                                                 : shear_code_name(code);
}

/* One file asked for, beneath one root. */
typedef struct request {
    const access_roots *roots;
    const access_root *root;
    const access_peer *peer;
    const char *path;    /* as the client gave it */
    const char *beneath; /* the part of it beneath the root */
} request;

/* EACCES is the peer's, EPERM the service's. */
static int fail_plainly(const request *r, int error, shear_error *err) {
    switch (error) {
    case EXDEV:
    case ELOOP:
        return shear_fail(err, ACCESS_E_OUTSIDE, "give the file itself, beneath a data root",
                          "%.300s: a link on the way leads out of the data root, or in circles",
                          r->path);
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
        return shear_fail(err, ACCESS_E_PATH, NULL, "%.300s: a name in it is too long", r->path);
    default:
        return shear_fail(err, error == ENOMEM ? SHEAR_E_NOMEM : SHEAR_E_IO,
                          error == ENOSYS ? "Linux 5.6 or later is needed" : NULL,
                          "%.300s: cannot be opened: %s", r->path, strerror(error));
    }
}

/* The first `length` bytes beneath the root, by O_PATH; or -errno. */
static int resolve(const request *r, size_t length, uint64_t flags) {
    char part[PATH_MAX];
    struct open_how how = {.flags = O_PATH | O_CLOEXEC | flags,
                           .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS};
    snprintf(part, sizeof part, "%.*s", (int)length, r->beneath);
    /* EAGAIN: something on the way was renamed meanwhile. */
    for (int i = 0;; i++) {
        const long fd = syscall(SYS_openat2, r->root->fd, part, &how, sizeof how);
        if (fd >= 0) {
            return (int)fd;
        }
        if (errno != EAGAIN || i == 32) {
            return errno == EACCES ? -EPERM : -errno;
        }
    }
}

/* What a link's text begins with; '\0' where it is no link. */
static char link_start(const request *r, size_t length) {
    char start = '\0';
    const int fd = resolve(r, length, O_NOFOLLOW);
    if (fd >= 0) {
        if (readlinkat(fd, "", &start, 1) != 1) {
            start = '\0';
        }
        close(fd);
    }
    return start;
}

/* `error` came of the first `length` bytes. Everybody may make links to where only others may look:
 * what became of one must not tell what is there. */
static int fail_at(const request *r, size_t length, int error, shear_error *err) {
    char start = '\0';
    if (r->peer->uid != 0) {
        start = link_start(r, length);
    }
    if (start == '/') {
        return fail_plainly(r, EXDEV, err);
    }
    if (start != '\0') {
        return shear_fail(err, ACCESS_E_DENIED, "give the file itself, beneath a data root",
                          "%.300s: a link on the way leads to nothing that you and the service "
                          "may read, or out of the data root",
                          r->path);
    }
    return fail_plainly(r, error, err);
}

static int check_directory(const request *r, size_t length) {
    struct stat st;
    const int fd = resolve(r, length, 0);
    if (fd < 0) {
        return -fd;
    }
    int error = walk_check(fd, r->peer, NULL);
    if (error == 0) {
        error = fstat(fd, &st) != 0 ? errno : S_ISDIR(st.st_mode) ? 0 : ENOTDIR;
    }
    close(fd);
    return error;
}

/* Every directory that the client names must be one that it may search, from the first on; so it
 * learns nothing of what lies in those that it may not. */
static int check_directories(const request *r, shear_error *err) {
    const char *beneath = r->beneath;
    const int error = walk_check(r->root->fd, r->peer, NULL);
    if (error != 0) {
        return fail_plainly(r, error, err);
    }
    for (size_t i = 1; beneath[i] != '\0'; i++) {
        if (beneath[i] == '/' && beneath[i - 1] != '/') {
            const int wrong = check_directory(r, i);
            if (wrong != 0) {
                return fail_at(r, i, wrong, err);
            }
        }
    }
    return SHEAR_OK;
}

/* The file behind an O_PATH descriptor, for reading: itself, whatever its name is by now. */
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

static int open_beneath(const request *r, int *fd, char **canonical, shear_error *err) {
    const size_t length = strlen(r->beneath);
    int code = check_directories(r, err);
    if (code != SHEAR_OK) {
        return code;
    }
    const int handle = resolve(r, length, 0);
    if (handle < 0) {
        return fail_at(r, length, -handle, err);
    }
    const int error = walk_check(handle, r->peer, canonical);
    code = error != 0 ? fail_at(r, length, error, err) : reopen(r, handle, fd, err);
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

int access_open(const access_roots *roots, const access_peer *peer, const char *path, int *fd,
                char **canonical, shear_error *err) {
    int code = check_path(path, err);
    bool tried = false;
    *fd = -1;
    *canonical = NULL;
    if (code != SHEAR_OK) {
        return code;
    }
    /* Of roots in each other, any may do: a link may leave the inner one only. */
    code = ACCESS_E_OUTSIDE;
    for (size_t i = 0; i < roots->n && code == ACCESS_E_OUTSIDE; i++) {
        const access_root *root = &roots->roots[i];
        const char *beneath = path_beneath(path, root->name);
        beneath = beneath != NULL ? beneath : path_beneath(path, root->canonical);
        if (beneath != NULL) {
            tried = true;
            code = open_beneath(&(request){roots, root, peer, path, beneath}, fd, canonical, err);
        }
    }
    if (code == ACCESS_E_OUTSIDE && !tried) {
        char advice[200];
        snprintf(advice, sizeof advice, "data roots: %s", roots->names);
        return shear_fail(err, code, advice, "%.300s: is not beneath a data root", path);
    }
    return code;
}
