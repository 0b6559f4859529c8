/* SPDX-License-Identifier: GPL-3.0-or-later */
/* doctor.h: is the set-up of the service sound? Each check reports one or more results; none of
 * them changes anything. */
#ifndef CLIENT_DOCTOR_DOCTOR_H
#define CLIENT_DOCTOR_DOCTOR_H

#include "remote/service.h"
#include "sheard/check_result.h"

#include <stdbool.h>

typedef struct doctor {
    service service;
    const char *config;            /* --config, or the service's; NULL: the installed one */
    enum sheard_check_level worst; /* of all that was reported */
    bool reached;                  /* the service answered, and: */
    sheard_reply status;           /* that is its state */
    bool told;                     /* ... and it told its paths */
    char *program;                 /* the daemon's; NULL: not here. Owned, and: */
    /* The service's paths, or else the configuration's; NULL if they are not known. */
    char *state_dir, *socket, *spool, *roots;
    bool has_spool;
} doctor;

/* Look at everything; doctor.service is parsed and not connected. */
void doctor_run(doctor *d);
void doctor_deinit(doctor *d);

#endif
