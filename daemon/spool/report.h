/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/report.h: what the spool says: lines for the owner's log, and what is wrong now. */
#ifndef SHEARD_SPOOL_REPORT_H
#define SHEARD_SPOOL_REPORT_H

#include "spool/spool.h"

void report_line(const spool *s, enum spool_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* What keeps files from being acquired, for those who ask (spool_get_stats). */
void report_trouble(spool *s, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Nothing keeps them any more. */
void report_no_trouble(spool *s);

#endif
