/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "doctor/internal.h"

#include <pwd.h>
#include <stdlib.h>
#include <unistd.h>

/* Set the socket: the configuration's, unless --socket names another one. */
static void choose_socket(doctor *d) {
    const char *environment = getenv("SHEARD_SOCKET");
    const bool named = d->service.socket != connection_default_path() ||
                       (environment != NULL && environment[0] != '\0');
    if (!named && d->socket != NULL && d->socket[0] != '\0')
        d->service.socket = d->socket;
}

/* Look from the service's side, if it replies. */
static void look(doctor *d) {
    if (d->reached)
        doctor_use_paths(d);
    doctor_check_config(d);
    if (d->told) {
        doctor_check_view(d);
    } else {
        const struct passwd *me = getpwuid(geteuid());
        doctor_warn(d, "view", "start the service and run doctor again, which then asks it",
                    "no service answers: what follows is what is visible to %s",
                    me != NULL ? me->pw_name : "this user");
        doctor_check_disks(d);
    }
    if (!d->reached || !doctor_check_probe(d))
        doctor_check_kernel(d);
}

void doctor_run(doctor *d) {
    doctor_check_program(d);
    choose_socket(d);
    doctor_check_socket(d);
    doctor_check_service(d);
    look(d);
}

void doctor_deinit(doctor *d) {
    sheard_reply_deinit(&d->status, SHEARD_METHOD_STATUS);
    service_close(&d->service);
    free(d->program);
    free(d->state_dir);
    free(d->socket);
    free(d->spool);
    free(d->roots);
}
