/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Acquire sockets that systemd has opened: descriptors from 3 on, as in sd_listen_fds(3). */
#include "base/text.h"

#include "base/cleanup.h"
#include "server/server.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { FIRST_FD = 3 };

static const char advice[] = "ListenStream= in sheard.socket must name one path, with Accept=no";

/* Return the text as a decimal number from 0 to max, or -1 if it is not one. */
static int64_t read_number(const char *text, int64_t max) {
    int64_t value = -1;
    const bool is_digit = text != NULL && *text >= '0' && *text <= '9';
    return is_digit && text_to_int64(text, &value) && value <= max ? value : -1;
}

static int get_int_option(int fd, int option) {
    int value = -1;
    socklen_t size = sizeof value;
    return getsockopt(fd, SOL_SOCKET, option, &value, &size) == 0 ? value : -1;
}

static int check_socket(int fd, shear_error *err) {
    if (get_int_option(fd, SO_DOMAIN) != AF_UNIX || get_int_option(fd, SO_TYPE) != SOCK_STREAM ||
        get_int_option(fd, SO_ACCEPTCONN) != 1) {
        return shear_fail(err, SHEAR_E_SETTING, advice,
                          "descriptor %d from systemd is not a listening Unix stream socket", fd);
    }
    if (fcntl(fd, F_SETFD, FD_CLOEXEC) != 0) {
        return shear_fail(err, SHEAR_E_IO, NULL, "descriptor %d from systemd: %s", fd,
                          strerror(errno));
    }
    return SHEAR_OK;
}

static int acquire(int *fds, size_t capacity, size_t *n, shear_error *err) {
    const char *count_text = getenv("LISTEN_FDS");
    if (count_text == NULL || read_number(getenv("LISTEN_PID"), INT32_MAX) != getpid()) {
        return SHEAR_OK; /* the variables were inherited, and meant for another process */
    }
    const int64_t count = read_number(count_text, 4096);
    if (count < 0 || (size_t)count > capacity) {
        return shear_fail(err, SHEAR_E_SETTING, advice,
                          "LISTEN_FDS is '%.20s'; expected a number up to %zu", count_text,
                          capacity);
    }
    for (int i = 0; i < (int)count; i++) {
        TRY(check_socket(FIRST_FD + i, err));
        fds[i] = FIRST_FD + i;
    }
    *n = (size_t)count;
    return SHEAR_OK;
}

int server_activation(int *fds, size_t capacity, size_t *n, shear_error *err) {
    *n = 0;
    const int code = acquire(fds, capacity, n, err);
    unsetenv("LISTEN_PID");
    unsetenv("LISTEN_FDS");
    unsetenv("LISTEN_FDNAMES");
    return code;
}
