/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of the steps keeps unauthorized clients out at any time:
 *   1. the lock (PATH.lock): of several servers that start at once, only one continues. A socket
 *      that is bound but does not listen yet answers a connect as a dead one does, so the test of
 *      step 2 is reliable only while no other server is in the steps after it;
 *   2. the existing path is tested by a connect, and removed only if it is a socket of this user
 *      on which nobody listens;
 *   3. fchmod(0) on the socket *before* bind: Linux creates the file with the socket's mode (minus
 *      the umask), so it has no permissions at first. The umask, which all threads of the process
 *      share, is not changed;
 *   4. the group, then the mode (in this order: the mode must not apply to the old group);
 *   5. listen: clients can connect only from now on. */
#include "server/socket_file.h"

#include "base/accounts.h"
#include "base/cleanup.h"
#include "base/fingerprint.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

enum { BACKLOG = 4096 };

/* The socket to be made. */
typedef struct request {
    const char *path, *group;
    unsigned mode;
    gid_t gid; /* -1: the process's own */
} request;

static int failed(const char *what, const char *path, shear_error *err) {
    const int number = errno;
    return shear_fail(err, SHEAR_E_IO,
                      "the directory must exist and belong to the service's user; see [daemon] "
                      "socket in sheard.conf",
                      "socket '%s': %s: %s", path, what, strerror(number));
}

static int is_served(const char *path, shear_error *err) {
    return shear_fail(err, SHEAR_E_EXISTS,
                      "stop the other service, or give this one a socket of its own",
                      "socket '%s': another service listens there", path);
}

static int make_address(struct sockaddr_un *address, const char *path, shear_error *err) {
    const size_t n = strlen(path);
    *address = (struct sockaddr_un){.sun_family = AF_UNIX};
    if (n == 0 || n >= sizeof address->sun_path) {
        return shear_fail(err, SHEAR_E_SETTING, "choose a shorter path",
                          "socket '%s': its path has %zu bytes; 1 to %zu are possible", path, n,
                          sizeof address->sun_path - 1);
    }
    memcpy(address->sun_path, path, n);
    return SHEAR_OK;
}

/* ---- the lock ---- */

/* Return whether the locked file is still the one at `path`. The holder of a lock removes the file
 * before it unlocks, so a lock acquired afterwards may be on a removed file, where it excludes
 * nobody. */
static bool is_current(int fd, const char *path) {
    struct stat held;
    struct stat named;
    return fstat(fd, &held) == 0 && lstat(path, &named) == 0 &&
           fingerprint_same_file(&held, &named);
}

static int acquire_lock(socket_file *file, shear_error *err) {
    for (;;) {
        CLEANUP(release_fd)
        int fd =
            open(file->lock_path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600);
        if (fd < 0)
            return failed("cannot make the lock beside it", file->path, err);
        if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
            return errno == EWOULDBLOCK ? is_served(file->path, err)
                                        : failed("cannot lock", file->path, err);
        }
        if (is_current(fd, file->lock_path)) {
            file->lock = fd;
            fd = -1;
            return SHEAR_OK;
        }
    }
}

static void release_lock(socket_file *file) {
    if (file->lock >= 0 && file->lock_path != NULL) {
        unlink(file->lock_path); /* while the lock is held: see is_current */
        close(file->lock);
        file->lock = -1;
    }
}

/* ---- an existing file ---- */

/* Return 0 if a process listens there, or the errno of connect. */
static int try_connect(const struct sockaddr_un *address) {
    const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0)
        return errno;
    const int rc = connect(fd, (const struct sockaddr *)address, sizeof *address) == 0 ? 0 : errno;
    close(fd);
    return rc == EAGAIN ? 0 : rc; /* EAGAIN: its backlog is full */
}

static int remove_stale(const struct sockaddr_un *address, shear_error *err) {
    const char *path = address->sun_path;
    struct stat st;
    if (lstat(path, &st) != 0)
        return errno == ENOENT ? SHEAR_OK : failed("cannot look at it", path, err);
    if (!S_ISSOCK(st.st_mode) || st.st_uid != geteuid()) {
        return shear_fail(err, SHEAR_E_EXISTS, "move it away, or choose another path",
                          "socket '%s': there is a file that is not a socket of this user", path);
    }
    const int rc = try_connect(address);
    if (rc == 0)
        return is_served(path, err);
    if (rc != ECONNREFUSED) {
        errno = rc;
        return failed("cannot tell whether somebody listens there", path, err);
    }
    return unlink(path) == 0 ? SHEAR_OK : failed("cannot remove the old one", path, err);
}

/* ---- the new file ---- */

static int find_group(gid_t *gid, const char *group, const char *path, shear_error *err) {
    *gid = (gid_t)-1;
    if (group == NULL || *group == '\0')
        return SHEAR_OK;
    const int error = accounts_find_group(group, gid);
    if (error == 0)
        return SHEAR_OK;
    return shear_fail(err, SHEAR_E_SETTING, "correct [daemon] socket_group in sheard.conf",
                      "socket '%s': there is no group '%s'%s%s", path, group,
                      error != ENOENT ? ": " : "", error != ENOENT ? strerror(error) : "");
}

/* Report a failed lchown. EPERM: a user may give files only to its own groups, and a unit may
 * forbid that, too. */
static int cannot_give(const char *path, const char *group, shear_error *err) {
    char advice[240];
    const int number = errno;
    snprintf(advice, sizeof advice,
             "make the service's user a member of it (usermod -aG %.32s USER; a unit may need "
             "SystemCallFilter=lchown), or use sheard.socket with SocketGroup=, or leave "
             "socket_group out",
             group);
    return shear_fail(err, number == EPERM ? SHEAR_E_SETTING : SHEAR_E_IO, advice,
                      "socket '%.200s': the service may not give it to the group '%.64s' "
                      "([daemon] socket_group): %s",
                      path, group, strerror(number));
}

/* Set the group and the mode of the file, which has no permissions yet. */
static int give(const request *r, socket_file *file, shear_error *err) {
    struct stat st;
    if (lstat(r->path, &st) != 0 || !S_ISSOCK(st.st_mode))
        return failed("it has vanished", r->path, err);
    file->device = st.st_dev;
    file->inode = st.st_ino;
    if ((st.st_mode & 07777) != 0) {
        return shear_fail(err, SHEAR_E_INTERNAL, NULL,
                          "socket '%s': the system made it with mode %04o instead of none", r->path,
                          (unsigned)st.st_mode & 07777);
    }
    if (r->gid != (gid_t)-1 && st.st_gid != r->gid && lchown(r->path, (uid_t)-1, r->gid) != 0)
        return cannot_give(r->path, r->group, err);
    return chmod(r->path, r->mode & 0777) == 0 ? SHEAR_OK
                                               : failed("cannot set its mode", r->path, err);
}

static int bind_and_listen(int fd, const struct sockaddr_un *address, const request *r,
                           socket_file *file, shear_error *err) {
    if (fchmod(fd, 0) != 0 || bind(fd, (const struct sockaddr *)address, sizeof *address) != 0)
        return failed("cannot make it", r->path, err);
    TRY(give(r, file, err));
    return listen(fd, BACKLOG) == 0 ? SHEAR_OK : failed("cannot listen", r->path, err);
}

static int name_files(socket_file *file, const char *path, shear_error *err) {
    file->path = strdup(path);
    if (file->path == NULL || asprintf(&file->lock_path, "%s.lock", path) < 0) {
        file->lock_path = NULL;
        shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the socket '%s'", path);
        return SHEAR_E_NOMEM;
    }
    return SHEAR_OK;
}

static int make(socket_file *file, int fd, request *r, shear_error *err) {
    struct sockaddr_un address;
    TRY(make_address(&address, r->path, err));
    TRY(find_group(&r->gid, r->group, r->path, err));
    TRY(name_files(file, r->path, err));
    TRY(acquire_lock(file, err));
    TRY(remove_stale(&address, err));
    return bind_and_listen(fd, &address, r, file, err);
}

int socket_file_make(socket_file *file, int *fd, const char *path, unsigned mode, const char *group,
                     shear_error *err) {
    *file = (socket_file){.lock = -1};
    *fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (*fd < 0)
        return failed("cannot open a socket", path, err);
    request r = {.path = path, .mode = mode, .group = group};
    const int code = make(file, *fd, &r, err);
    if (code != SHEAR_OK) {
        socket_file_remove(file);
        close(*fd);
        *fd = -1;
    }
    return code;
}

void socket_file_remove(socket_file *file) {
    struct stat st;
    if (file->path != NULL && file->inode != 0 && lstat(file->path, &st) == 0 &&
        st.st_ino == file->inode && st.st_dev == file->device) {
        unlink(file->path);
    }
    release_lock(file);
    free(file->path);
    free(file->lock_path);
    *file = (socket_file){.lock = -1};
}
