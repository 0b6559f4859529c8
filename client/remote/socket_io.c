/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/socket_io.h"

#include "base/cleanup.h"
#include "base/clock.h"
#include "base/text.h"

#include "terminal/progress.h"

#include <errno.h>
#include <grp.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

/* A signal between the test of its flag and poll() is noticed after SLICE_MS. */
enum { SLICE_MS = 200, BACKLOG_MS = 20 };

#define HOW_TO_START                                                                               \
    "start the service (systemctl start sheard), or name its socket with --socket or "             \
    "SHEARD_SOCKET"

static enum connection_status interrupted(sheard_rpc_error *error) {
    return connection_fail(error, CONNECTION_INTERRUPTED, NULL, "interrupted");
}

/* Wait for `events` (or a hang-up) on fd; if fd is -1, only for the time. */
static enum connection_status wait_for(int fd, short events, double deadline,
                                       sheard_rpc_error *error) {
    for (;;) {
        if (progress_interrupted())
            return interrupted(error);
        const double left_ms = ceil(1000.0 * (deadline - clock_s(CLOCK_MONOTONIC)));
        if (left_ms <= 0.0) {
            return connection_fail(error, CONNECTION_SILENT,
                                   "the service is stuck or very busy: systemctl status sheard; "
                                   "--reply-timeout waits longer",
                                   "the service does not answer");
        }
        struct pollfd p = {.fd = fd, .events = events};
        const int n = poll(&p, 1, left_ms < SLICE_MS ? (int)left_ms : SLICE_MS);
        if (n > 0)
            return CONNECTION_OK;
        if (n < 0 && errno != EINTR) {
            return connection_fail(error, CONNECTION_FAILED, NULL, "cannot wait: %s",
                                   strerror(errno));
        }
    }
}

/* Write "group sheard", the group that may connect, into buf; "" if it is unknown. */
static void name_group(const char *path, char *buf, size_t size) {
    struct stat st;
    buf[0] = '\0';
    if (stat(path, &st) == 0) {
        const struct group *g = getgrgid(st.st_gid);
        if (g != NULL)
            snprintf(buf, size, " (%s)", g->gr_name);
    }
}

static enum connection_status say_why(const char *path, int why, sheard_rpc_error *error) {
    char group[96];
    char advice[240];
    switch (why) {
    case ENOENT:
    case ENOTDIR:
        return connection_fail(error, CONNECTION_UNREACHABLE, HOW_TO_START, "there is no socket %s",
                               path);
    case ECONNREFUSED:
        return connection_fail(
            error, CONNECTION_UNREACHABLE,
            "the service has stopped: systemctl start sheard; systemctl status sheard shows why",
            "nobody listens at the socket %s", path);
    case EACCES:
    case EPERM:
        name_group(path, group, sizeof group);
        snprintf(advice, sizeof advice,
                 "become a member of the socket's group%s: an administrator does usermod -aG, then "
                 "log in again",
                 group);
        return connection_fail(error, CONNECTION_DENIED, advice, "you may not connect to %s", path);
    default:
        return connection_fail(error, CONNECTION_UNREACHABLE, HOW_TO_START,
                               "cannot connect to %s: %s", path, strerror(why));
    }
}

static enum connection_status connect_to(int s, const struct sockaddr_un *address, double deadline,
                                         sheard_rpc_error *error) {
    while (connect(s, (const struct sockaddr *)address, sizeof *address) != 0) {
        if (errno != EAGAIN && errno != EINTR)
            return say_why(address->sun_path, errno, error);
        if (progress_interrupted())
            return interrupted(error);
        if (clock_s(CLOCK_MONOTONIC) >= deadline) {
            return connection_fail(error, CONNECTION_SILENT,
                                   "the service is stuck or very busy: systemctl status sheard",
                                   "the service does not accept connections at %s",
                                   address->sun_path);
        }
        poll(NULL, 0, BACKLOG_MS); /* the listener's backlog is full, for which there is no event */
    }
    return CONNECTION_OK;
}

enum connection_status socket_io_connect(const char *path, double deadline, int *fd,
                                         sheard_rpc_error *error) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    *fd = -1;
    if (!text_set(address.sun_path, sizeof address.sun_path, path)) {
        return connection_fail(error, CONNECTION_UNREACHABLE, "give a shorter path",
                               "the path of a socket has at most %zu bytes: %s",
                               sizeof address.sun_path - 1, path);
    }
    CLEANUP(release_fd) int s = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (s < 0) {
        return connection_fail(error, CONNECTION_FAILED, NULL, "cannot make a socket: %s",
                               strerror(errno));
    }
    TRY(connect_to(s, &address, deadline, error));
    *fd = s;
    s = -1;
    return CONNECTION_OK;
}

enum connection_status socket_io_send(int fd, const char *bytes, size_t n, double deadline,
                                      sheard_rpc_error *error) {
    while (n > 0) {
        const ssize_t sent = send(fd, bytes, n, MSG_NOSIGNAL);
        if (sent > 0) {
            bytes += sent;
            n -= (size_t)sent;
        } else if (errno == EPIPE || errno == ECONNRESET) {
            return CONNECTION_OK;
        } else if (errno == EAGAIN) {
            TRY(wait_for(fd, POLLOUT, deadline, error));
        } else if (errno != EINTR) {
            return connection_fail(error, CONNECTION_UNREACHABLE, NULL,
                                   "cannot write to the service: %s", strerror(errno));
        }
    }
    return CONNECTION_OK;
}

enum connection_status socket_io_receive(int fd, char *buf, size_t size, size_t *n, double deadline,
                                         sheard_rpc_error *error) {
    for (;;) {
        const ssize_t got = recv(fd, buf, size, 0);
        if (got > 0) {
            *n = (size_t)got;
            return CONNECTION_OK;
        }
        if (got == 0 || errno == ECONNRESET) {
            return connection_fail(
                error, CONNECTION_UNREACHABLE,
                "systemctl status sheard shows whether it was stopped; accepted jobs "
                "go on when it is started again",
                "the service has closed the connection");
        }
        if (errno != EAGAIN && errno != EINTR) {
            return connection_fail(error, CONNECTION_UNREACHABLE, NULL,
                                   "cannot read from the service: %s", strerror(errno));
        }
        TRY(wait_for(fd, POLLIN, deadline, error));
    }
}
