/* SPDX-License-Identifier: GPL-3.0-or-later */
/* follow.h: wait until jobs are finished, with a progress bar on a terminal (submit --wait, wait).
 */
#ifndef CLIENT_REMOTE_FOLLOW_H
#define CLIENT_REMOTE_FOLLOW_H

#include "remote/follow_sum.h"
#include "remote/service.h"

#include <stddef.h>

typedef struct follow_options {
    double timeout_s; /* NAN: as long as it takes */
    bool quiet;       /* no progress bar */
    bool answers;     /* with service.json, print the answers to wait */
} follow_options;

/* Wait for ids[n], then print a table of how they ended (not with service.json), and on standard
 * error why those that are not done are not. Returns follow_exit_code; or another one, with an
 * error printed. */
enum exit_code follow_jobs(service *s, const int64_t *ids, size_t n, const follow_options *options);

#endif
