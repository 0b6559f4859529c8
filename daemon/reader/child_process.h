/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/child_process.h: wait for the end of a child process. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* Reap the child (*pid becomes 0; if it is 0 already, nothing happens), and describe how it ended
 * in end[size], which may be NULL. Return its exit code, or -1 if it has none. With kill_now it is
 * killed at once; otherwise it has a second to end by itself, because a child whose socket is
 * closed may still be ending. */
int child_process_reap(pid_t *pid, bool kill_now, char *end, size_t size);
