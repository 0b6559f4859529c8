/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_queue.h: from the queue into the engine. A job is marked running in one group,
 * and starts when that is on disk. */
#ifndef SHEARD_SERVICE_JOB_QUEUE_H
#define SHEARD_SERVICE_JOB_QUEUE_H

typedef struct service service;

/* Start as many jobs as there is place for. When a turn has ended and its group is on disk. */
void job_queue_fill(service *s);
/* Give all back: they go on at the next start. */
void job_queue_stop_all(service *s);

#endif
