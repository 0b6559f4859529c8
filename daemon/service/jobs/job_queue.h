/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_queue.h: start queued jobs in the engine. A job is marked running in one group,
 * and starts when that group is on disk. */
#pragma once

typedef struct service service;

/* Mark as many jobs as may run at the same time. Call at the end of a turn whose group is on
 * disk. */
void job_queue_fill(service *s);
/* Stop all running jobs and put them back into the queue; they resume at the next start. */
void job_queue_stop_all(service *s);
