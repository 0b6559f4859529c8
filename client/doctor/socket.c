/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of the socket, and of the service that listens on it. */
#include "doctor/internal.h"
#include "remote/status_text.h"
#include "shear/version.h"

#include <errno.h>
#include <grp.h>
#include <inttypes.h>
#include <pwd.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void name_owner(const struct stat *st, char *buf, size_t size) {
    const struct passwd *user = getpwuid(st->st_uid);
    const struct group *group = getgrgid(st->st_gid);
    snprintf(buf, size, "%s:%s", user != NULL ? user->pw_name : "?",
             group != NULL ? group->gr_name : "?");
}

static void check_permissions(doctor *d, const char *path, const struct stat *st) {
    char owner[160];
    name_owner(st, owner, sizeof owner);
    const unsigned mode = st->st_mode & 07777U;
    if (access(path, W_OK) != 0) {
        doctor_fail(d, "permissions",
                    "become a member of that group (usermod -aG), and log in again",
                    "the socket is %04o %s, and you may not connect", mode, owner);
    } else if (mode & S_IWOTH) {
        doctor_warn(d, "permissions", "set socket_mode = 0660 (or SocketMode= in sheard.socket)",
                    "the socket is %04o %s: everybody on this machine may connect", mode, owner);
    } else {
        const bool member = group_member(st->st_gid) != 0;
        doctor_ok(d, "permissions", "the socket is %04o %s, you may connect%s", mode, owner,
                  member ? " as a member of the group" : "");
    }
}

void doctor_check_socket(doctor *d) {
    struct stat st;
    const char *path = d->service.socket;
    if (lstat(path, &st) != 0) {
        const bool denied = errno == EACCES;
        doctor_fail(d, "socket",
                    denied ? "its directory must be searchable by you (RuntimeDirectoryMode=0755)"
                           : "start the service: systemctl start sheard; or name its socket with "
                             "--socket or SHEARD_SOCKET",
                    "%s: %s", path, strerror(errno));
        return;
    }
    if (!S_ISSOCK(st.st_mode)) {
        doctor_fail(d, "socket", "name the service's socket", "%s is not a socket", path);
        return;
    }
    doctor_ok(d, "socket", "%s is there", path);
    check_permissions(d, path, &st);
}

static void check_release(doctor *d) {
    const sheard_msg_welcome *w = connection_welcome(d->service.connection);
    const char *server = w->server != NULL ? w->server : "?";
    const size_t n = strlen(server);
    const size_t v = strlen(SHEAR_VERSION_STRING);
    const bool same = n >= v && strcmp(server + n - v, SHEAR_VERSION_STRING) == 0;
    doctor_report(d, "release", same ? SHEARD_CHECK_OK : SHEARD_CHECK_WARN,
                  "install one release, and restart the service",
                  "the service is %s, shearctl %s; they speak version %" PRId64 " of the protocol",
                  server, SHEAR_VERSION_STRING, w->protocol);
    doctor_ok(d, "rights", "you are user %" PRId64 "%s", w->uid,
              w->admin ? ", an administrator of the service"
                       : ", not an administrator of the service");
}

static void check_state(doctor *d) {
    const sheard_msg_status *s = &d->status.status;
    if (s->state != SHEARD_SERVER_RUNNING) {
        doctor_warn(d, "service", "start it again when it has stopped", "the service is %s",
                    sheard_server_state_name(s->state));
    } else {
        doctor_ok(d, "service", "running, process %" PRId64 ", %" PRId64 " workers", s->pid,
                  s->workers.total);
    }
    if (s->queue.capacity > 0 && s->queue.length >= s->queue.capacity) {
        doctor_warn(d, "queue", "wait, or raise [limits] queue",
                    "the queue is full (%" PRId64 " jobs)", s->queue.length);
    }
    for (size_t i = 0; i < s->n_problems; i++) {
        char line[800];
        doctor_warn(d, "service", "see the service's log: journalctl -u sheard", "%s",
                    status_text_problem(s, i, line, sizeof line));
    }
}

void doctor_check_service(doctor *d) {
    sheard_rpc_error error = {0};
    service *s = &d->service;
    enum connection_status status =
        connection_open(&s->connection, s->socket, s->reply_timeout_s, &error);
    if (status == CONNECTION_OK) {
        check_release(d);
        status = connection_call(s->connection, SHEARD_METHOD_STATUS, NULL, s->reply_timeout_s,
                                 &d->status, NULL, &error);
    }
    d->reached = status == CONNECTION_OK;
    if (d->reached) {
        check_state(d);
    } else {
        doctor_fail(d, "service", error.advice, "%s", error.message);
    }
}
