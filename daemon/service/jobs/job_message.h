/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_message.h: a job as the protocol tells it. */
#ifndef SHEARD_SERVICE_JOB_MESSAGE_H
#define SHEARD_SERVICE_JOB_MESSAGE_H

#include "sheard/messages.h"
#include "store/store.h"

typedef struct service service;

/* Texts are borrowed from the record. Deinit it. */
void job_to_message(service *s, const store_job *job, sheard_msg_job *out);
void job_message_deinit(sheard_msg_job *out);
/* The job has another state, or is known better, on disk: tell those who watch it. */
void job_message_publish(service *s, const store_job *job);
/* Once a second: what the running jobs are at, to those who asked for it. */
void job_message_publish_progress(service *s);

#endif
