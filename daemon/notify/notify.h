/* SPDX-License-Identifier: GPL-3.0-or-later */
/* notify/notify.h: what systemd wants to hear from a service (sd_notify(3)), without libsystemd.
 *
 * One thread. No call ever waits: a message that cannot be sent at once is SHEAR_E_IO. Where nobody
 * listens (no NOTIFY_SOCKET), all calls do nothing and succeed.
 */
#ifndef SHEARD_NOTIFY_H
#define SHEARD_NOTIFY_H

#include "shear/error.h"

#include <stdint.h>
#include <sys/socket.h>
#include <sys/un.h>

typedef struct notify {
    int fd; /* -1: nobody listens */
    struct sockaddr_un address;
    socklen_t address_size;
    int64_t watchdog_ms; /* systemd kills a service that is silent for so long; 0: it does not */
} notify;

/* From NOTIFY_SOCKET (a path, or @ and an abstract name), WATCHDOG_USEC and WATCHDOG_PID, which are
 * removed from the environment. On an error *n is as if nobody listened. */
int notify_init(notify *n, shear_error *err);
void notify_deinit(notify *n); /* more than once: fine */

/* `status` is one line for systemctl status; NULL: none. Line breaks in it become blanks. */
int notify_ready(const notify *n, const char *status, shear_error *err);
/* Before a reload; notify_ready after it. */
int notify_reloading(const notify *n, shear_error *err);
int notify_stopping(const notify *n, const char *status, shear_error *err);
int notify_status(const notify *n, const char *status, shear_error *err);
/* Still alive: at least twice in watchdog_ms. */
int notify_watchdog(const notify *n, shear_error *err);

#endif
