/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/jobs/job_message.h: a job as a message of the protocol, with its progress,
 * rate and time left. */
#pragma once

#include "sheard/messages.h"
#include "store/store.h"

typedef struct service service;

/* Fill *out; its texts are borrowed from the record. Deinit it. */
void job_to_message(service *s, const store_job *job, sheard_msg_job *out);
void job_message_deinit(sheard_msg_job *out);
/* Publish a job whose state or field's name has changed, on disk, to subscribers. */
void job_message_publish(service *s, const store_job *job);
/* Publish the progress of the running jobs to subscribers. Call once a second. */
void job_message_publish_progress(service *s);
