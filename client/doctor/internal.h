/* SPDX-License-Identifier: GPL-3.0-or-later */
/* internal.h: the checks, and how they report. */
#ifndef CLIENT_DOCTOR_INTERNAL_H
#define CLIENT_DOCTOR_INTERNAL_H

#include "doctor/doctor.h"

/* One check result: a line, its remedy on another, or JSON. `remedy` may be NULL. */
void doctor_report(doctor *d, const char *subject, enum sheard_check_level level,
                   const char *remedy, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
#define doctor_ok(d, subject, ...)   doctor_report(d, subject, SHEARD_CHECK_OK, NULL, __VA_ARGS__)
#define doctor_warn(d, subject, ...) doctor_report(d, subject, SHEARD_CHECK_WARN, __VA_ARGS__)
#define doctor_fail(d, subject, ...) doctor_report(d, subject, SHEARD_CHECK_FAIL, __VA_ARGS__)

/* The checks, in their order. */
void doctor_check_program(doctor *d); /* the daemon's program; and reads its configuration */
void doctor_check_socket(doctor *d);
void doctor_check_service(doctor *d);
void doctor_use_paths(doctor *d); /* of the service that answers */
void doctor_check_config(doctor *d);
/* As the service sees them: state, spool, data roots; and whether it can measure (false: it did not
 * tell). */
void doctor_check_view(doctor *d);
bool doctor_check_probe(doctor *d);
/* With our own. */
void doctor_check_disks(doctor *d); /* state, spool, their clocks, data roots */
void doctor_check_kernel(doctor *d);

/* Parts of these. */
void doctor_report_space(doctor *d, const char *subject, const char *path, int64_t left);
void doctor_report_no_roots(doctor *d);
void doctor_check_local(doctor *d, const char *path); /* no network file system? */
void doctor_check_clock(doctor *d);                   /* the spool's */
/* May the service's user (root looks for that) or we write there? If not, that is reported. */
bool doctor_test_write(doctor *d, const char *subject, const char *directory);

#endif
