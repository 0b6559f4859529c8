/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "notify/notify.h"

#include "base/cleanup.h"
#include "base/clock.h"
#include "base/text.h"
#include "shear/text.h"

#include <errno.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MESSAGE_SIZE = 1024 };

/* Return the text as a decimal number without a sign, or 0 if it is not one. */
static int64_t read_number(const char *text) {
    int64_t value = 0;
    const bool is_digit = text != NULL && *text >= '0' && *text <= '9';
    return is_digit && text_to_int64(text, &value) ? value : 0;
}

static int set_address(notify *n, const char *name, shear_error *err) {
    const size_t length = strlen(name);
    if ((name[0] != '/' && name[0] != '@') || length < 2 || length > sizeof n->address.sun_path) {
        return shear_fail(err, SHEAR_E_SETTING, "leave NOTIFY_SOCKET to systemd",
                          "NOTIFY_SOCKET is '%.120s': neither a path nor an abstract socket", name);
    }
    n->address = (struct sockaddr_un){.sun_family = AF_UNIX};
    memcpy(n->address.sun_path, name, length);
    n->address_size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length);
    if (name[0] == '@') {
        n->address.sun_path[0] = '\0'; /* the length ends an abstract name */
    }
    return SHEAR_OK;
}

static int64_t read_watchdog(void) {
    const int64_t usec = read_number(getenv("WATCHDOG_USEC"));
    const char *pid = getenv("WATCHDOG_PID");
    const bool ours = pid == NULL || read_number(pid) == getpid();
    return !ours || usec == 0 ? 0 : usec < 1000 ? 1 : usec / 1000;
}

static int open_socket(notify *n, const char *name, shear_error *err) {
    TRY(set_address(n, name, err));
    n->fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    return n->fd >= 0 ? SHEAR_OK
                      : shear_fail(err, SHEAR_E_IO, NULL, "no socket to notify systemd: %s",
                                   strerror(errno));
}

int notify_init(notify *n, shear_error *err) {
    const char *name = getenv("NOTIFY_SOCKET");
    *n = (notify){.fd = -1};
    const int code = name != NULL && name[0] != '\0' ? open_socket(n, name, err) : SHEAR_OK;
    if (n->fd >= 0)
        n->watchdog_ms = read_watchdog();
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    unsetenv("WATCHDOG_PID");
    return code;
}

void notify_deinit(notify *n) {
    if (n->fd >= 0)
        close(n->fd);
    *n = (notify){.fd = -1};
}

static int send_text(const notify *n, const char *text, shear_error *err) {
    if (n->fd < 0)
        return SHEAR_OK;
    ssize_t sent;
    do {
        sent = sendto(n->fd, text, strlen(text), MSG_NOSIGNAL | MSG_DONTWAIT,
                      (const struct sockaddr *)&n->address, n->address_size);
    } while (sent < 0 && errno == EINTR);
    return sent >= 0
               ? SHEAR_OK
               : shear_fail(err, SHEAR_E_IO, NULL, "cannot notify systemd: %s", strerror(errno));
}

/* Send a state with a status, without line breaks: they would begin another assignment. */
static int send_with_status(const notify *n, const char *state, const char *status,
                            shear_error *err) {
    char text[MESSAGE_SIZE];
    const int begin = snprintf(text, sizeof text, "%s", state);
    if (status != NULL) {
        char clean[MESSAGE_SIZE];
        snprintf(text + begin, sizeof text - (size_t)begin, "STATUS=%s",
                 shear_text_clean(status, clean, sizeof clean));
    }
    return send_text(n, text, err);
}

int notify_ready(const notify *n, const char *status, shear_error *err) {
    return send_with_status(n, "READY=1\n", status, err);
}

/* The time is required by Type=notify-reload. */
int notify_reloading(const notify *n, shear_error *err) {
    char text[MESSAGE_SIZE];
    snprintf(text, sizeof text, "RELOADING=1\nMONOTONIC_USEC=%" PRId64, clock_us(CLOCK_MONOTONIC));
    return send_text(n, text, err);
}

int notify_stopping(const notify *n, const char *status, shear_error *err) {
    return send_with_status(n, "STOPPING=1\n", status, err);
}

int notify_watchdog(const notify *n, shear_error *err) {
    return send_text(n, "WATCHDOG=1", err);
}
