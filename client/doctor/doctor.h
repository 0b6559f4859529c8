/* SPDX-License-Identifier: GPL-3.0-or-later */
/* doctor.h: what `shearctl doctor` looks at, and how it tells. Each check says one or more
 * check results; none of them changes anything. */
#ifndef CLIENT_DOCTOR_DOCTOR_H
#define CLIENT_DOCTOR_DOCTOR_H

#include "remote/service.h"
#include "sheard/check_result.h"

#include <stdbool.h>

typedef struct doctor {
    service service;
    const char *config;  /* --config, or the service's; NULL: the installed one */
    int worst;           /* enum sheard_check_level, of all that was said */
    bool reached;        /* the service answered, and: */
    sheard_reply status; /* that is its state */
    bool told;           /* ... and it told its paths */
    char *program;       /* the daemon's; NULL: not here. Owned, and: */
    /* The service's paths, or else the configuration's; NULL where they are not known. */
    char *state_dir, *socket, *spool, *roots;
    bool has_spool;
} doctor;

/* One check result: a line, its remedy on another, or JSON. `remedy` may be NULL. */
void doctor_say(doctor *d, const char *subject, int level, const char *remedy, const char *format,
                ...) __attribute__((format(printf, 5, 6)));

/* The checks, in their order. */
void doctor_check_program(doctor *d); /* the daemon's program; and reads its configuration */
void doctor_check_socket(doctor *d);
void doctor_check_service(doctor *d);
void doctor_take_paths(doctor *d); /* of the service that answers */
void doctor_check_config(doctor *d);
/* With the service's eyes: state, spool, data roots; and whether it can measure (false: it did not
 * tell). */
void doctor_check_told(doctor *d);
bool doctor_check_probe(doctor *d);
/* With our own. */
void doctor_check_disks(doctor *d); /* state, spool, their clocks, data roots */
void doctor_check_system(doctor *d);

/* Parts of these. */
void doctor_say_room(doctor *d, const char *subject, const char *path, int64_t left);
void doctor_say_no_roots(doctor *d);
void doctor_check_local(doctor *d, const char *path); /* no network file system? */
void doctor_check_clock(doctor *d);                   /* the spool's */
/* A file without a name in this directory, open for writing; or -1, and errno. */
int doctor_scratch_file(const char *directory);
/* May the service's user (root looks for that) or we write there? Says so where not. */
bool doctor_try_write(doctor *d, const char *subject, const char *directory);

#endif
