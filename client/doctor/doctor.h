/* SPDX-License-Identifier: GPL-3.0-or-later */
/* doctor.h: checks of the installation of the service (`shearctl doctor`). Each check reports one
 * or more results and changes nothing. */
#pragma once

#include "remote/service.h"
#include "sheard/check_result.h"

#include <stdbool.h>

typedef struct doctor {
    service service;
    const char *config;            /* --config, or that of the service; NULL: the installed one */
    enum sheard_check_level worst; /* of all reported results */
    bool reached;                  /* the service replied to `status` */
    sheard_reply status;           /* that reply; valid if `reached` */
    bool told;                     /* `status` contains the service's paths */
    char *program; /* path of the daemon's program; NULL: not on this machine. Owned */
    /* Paths of the service, or else those of the configuration; NULL if unknown. Owned. */
    char *state_dir, *socket, *spool, *roots;
    bool has_spool;
} doctor;

/* Run all checks. On entry doctor.service is parsed, but not connected. */
void doctor_run(doctor *d);
void doctor_deinit(doctor *d);
