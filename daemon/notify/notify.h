/* SPDX-License-Identifier: GPL-3.0-or-later */
/* notify/notify.h: notify systemd of the service's state, and that it is alive (sd_notify(3), the
 * watchdog), without libsystemd. One thread. No call blocks: SHEAR_E_IO means that a message cannot
 * be sent at once. Without NOTIFY_SOCKET all calls do nothing and succeed. */
#pragma once

#include "shear/error.h"

#include <stdint.h>
#include <sys/socket.h>
#include <sys/un.h>

typedef struct notify {
    int fd; /* -1: no NOTIFY_SOCKET */
    struct sockaddr_un address;
    socklen_t address_size;
    int64_t watchdog_ms; /* systemd kills a service that is silent for so long; 0: never */
} notify;

/* Read NOTIFY_SOCKET (a path, or @ and an abstract name), WATCHDOG_USEC and WATCHDOG_PID, and
 * remove them from the environment. On an error *n is as without NOTIFY_SOCKET. */
int notify_init(notify *n, shear_error *err);
void notify_deinit(notify *n); /* further calls do nothing */

/* Report that the service is ready. `status` is one line for systemctl status, or NULL; line breaks
 * in it become blanks. */
int notify_ready(const notify *n, const char *status, shear_error *err);
/* Report that a reload begins; notify_ready reports its end. */
int notify_reloading(const notify *n, shear_error *err);
/* Report that the service stops. */
int notify_stopping(const notify *n, const char *status, shear_error *err);
/* Report that the service is alive, at least twice per watchdog_ms. */
int notify_watchdog(const notify *n, shear_error *err);
