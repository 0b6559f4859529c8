/* SPDX-License-Identifier: GPL-3.0-or-later */
/* doctor.h: what `shearctl doctor` looks at, and how it tells. Each check says one or more
 * findings; none of them changes anything. */
#ifndef CLIENT_DOCTOR_H
#define CLIENT_DOCTOR_H

#include "service.h"
#include "sheard/finding.h"

#include <stdbool.h>

struct doctor {
    struct service service;
    const char *config; /* --config, or NULL */
    int worst;          /* enum shear_finding_level, of all that was said */
    bool reached;       /* the service answered, and: */
    shear_reply status; /* that is its state */
    /* The configuration, NULL where it is not known. Owned. */
    char *state_dir, *socket, *spool, *roots;
    bool has_spool;
};

/* One finding: a line, its remedy on another, or JSON. `remedy` may be NULL. */
void doctor_say(struct doctor *d, const char *subject, int level, const char *remedy,
                const char *format, ...) __attribute__((format(printf, 5, 6)));

/* The checks, in their order. */
void doctor_check_program(struct doctor *d); /* the daemon's program, and its configuration */
void doctor_check_socket(struct doctor *d);
void doctor_check_service(struct doctor *d);
void doctor_check_disks(struct doctor *d); /* state, spool, their clocks, data roots */
void doctor_check_system(struct doctor *d);

#endif
