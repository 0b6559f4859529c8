/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/report.h: what the spool reports: lines for the owner's log, and the present trouble. */
#pragma once

#include "spool/spool.h"

void report_line(const spool *s, enum spool_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Set the trouble that keeps files from being acquired (see spool_get_stats). */
void report_trouble(spool *s, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Clear the trouble. */
void report_no_trouble(spool *s);
