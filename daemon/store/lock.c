/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "store/lock.h"

#include "store/store.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

enum { TRY_EVERY_MS = 10 };

int lock_fail(const char *path, shear_error *err) {
    return shear_fail(err, STORE_LOCKED,
                      "only one service may use a state directory: stop the other one, or "
                      "configure another directory",
                      "%s: another process uses this database", path);
}

static int fail(const char *name, const char *doing, shear_error *err) {
    return shear_fail(err, SHEAR_E_IO, "see that the state directory exists and is writable",
                      "%s: cannot be %s: %s", name, doing, strerror(errno));
}

int lock_acquire(int *fd, const char *path, int busy_ms, shear_error *err) {
    const struct timespec pause = {.tv_nsec = TRY_EVERY_MS * 1000000L};
    char name[STORE_PATH_MAX + sizeof ".lock"];
    snprintf(name, sizeof name, "%s.lock", path);
    *fd = open(name, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NOCTTY, 0600);
    if (*fd < 0)
        return fail(name, "made", err);
    int waited_ms = 0;
    while (flock(*fd, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EINTR)
            continue;
        if (errno != EWOULDBLOCK || waited_ms >= busy_ms) {
            const int code =
                errno != EWOULDBLOCK ? fail(name, "locked", err) : lock_fail(path, err);
            close(*fd);
            *fd = -1;
            return code;
        }
        nanosleep(&pause, NULL);
        waited_ms += TRY_EVERY_MS;
    }
    return SHEAR_OK;
}
