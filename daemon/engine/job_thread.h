/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/job_thread.h: the main function of a job's own thread. */
#pragma once

/* Run a job, from opening its files to its last event, and free it. The argument is a job in the
 * engine's list. */
void *job_thread_main(void *j);
