/* SPDX-License-Identifier: GPL-3.0-or-later */
/* job_action.h: what cancel, retry and retract share: one request for each of several jobs. */
#ifndef CLIENT_REMOTE_JOB_ACTION_H
#define CLIENT_REMOTE_JOB_ACTION_H

#include "remote/service.h"

/* Ask `method` (cancel, retry or retract) for each job of the command line. Returns an exit code.
 */
int job_action_run(const command *self, int method, int argc, char **argv);

#endif
