/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/job_thread.h: the thread of one job. */
#ifndef SHEARD_ENGINE_JOB_THREAD_H
#define SHEARD_ENGINE_JOB_THREAD_H

/* From opening to the last event; the argument is a job that is in the engine's list. Frees it. */
void *job_thread_main(void *j);

#endif
