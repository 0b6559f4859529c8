/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/child_process.h: the end of a child process. */
#ifndef SHEARD_READER_CHILD_PROCESS_H
#define SHEARD_READER_CHILD_PROCESS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* Reap the child (*pid becomes 0) and tell how it ended, into end[size]. Returns its exit code, -1
 * where it has none. Unless it is to be killed now, it has a second: a child whose socket is closed
 * may still be dying. */
int child_process_reap(pid_t *pid, bool kill_now, char *end, size_t size);

#endif
