/* SPDX-License-Identifier: GPL-3.0-or-later */
/* follow.h: wait until jobs have ended, with a progress bar on a terminal (submit --wait, wait). */
#pragma once

#include "remote/follow_sum.h"
#include "remote/service.h"

#include <stddef.h>

typedef struct follow_options {
    double timeout_s; /* NAN: no limit */
    bool quiet;       /* no progress bar */
    bool answers;     /* with service.json, print the replies to `wait` */
} follow_options;

/* Wait for ids[n], then print a table of their results (not with service.json), and the reasons of
 * those that are not done to standard error. Returns follow_exit_code, or another exit code if an
 * error has been printed. */
enum exit_code follow_jobs(service *s, const int64_t *ids, size_t n, const follow_options *options);
