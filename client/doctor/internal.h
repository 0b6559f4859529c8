/* SPDX-License-Identifier: GPL-3.0-or-later */
/* internal.h: the single checks of `shearctl doctor`, and the function that reports a result. */
#pragma once

#include "doctor/doctor.h"

/* Report one result: a line with its remedy, unless it is OK, on the next line, or JSON. `remedy`
 * may be NULL. */
void doctor_report(doctor *d, const char *subject, enum sheard_check_level level,
                   const char *remedy, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
#define doctor_ok(d, subject, ...)   doctor_report(d, subject, SHEARD_CHECK_OK, NULL, __VA_ARGS__)
#define doctor_warn(d, subject, ...) doctor_report(d, subject, SHEARD_CHECK_WARN, __VA_ARGS__)
#define doctor_fail(d, subject, ...) doctor_report(d, subject, SHEARD_CHECK_FAIL, __VA_ARGS__)

/* The checks, in the order in which they run. */
void doctor_check_program(doctor *d); /* the daemon's program; also reads its configuration */
void doctor_check_socket(doctor *d);
void doctor_check_service(doctor *d);
void doctor_use_paths(doctor *d); /* use the paths of the running service */
void doctor_check_config(doctor *d);
/* Check state, spool and data roots as the running service sees them; then whether it can measure
 * (false: it did not report that). */
void doctor_check_view(doctor *d);
bool doctor_check_probe(doctor *d);
/* Check them as this process sees them. */
void doctor_check_disks(doctor *d); /* state, spool, their clocks, data roots */
void doctor_check_kernel(doctor *d);

/* Parts of the checks. */
void doctor_report_space(doctor *d, const char *subject, const char *path, int64_t left);
void doctor_report_no_roots(doctor *d);
void doctor_check_local(doctor *d, const char *path); /* warn of a network file system */
void doctor_check_clock(doctor *d);                   /* of the spool's file system */
