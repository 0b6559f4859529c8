/* SPDX-License-Identifier: GPL-3.0-or-later */
/* reader/launch.h: starting the reader child with what it is to have, and nothing else. */
#ifndef SHEARD_READER_LAUNCH_H
#define SHEARD_READER_LAUNCH_H

#include "reader/reader.h"

#include <sys/types.h>

/* Start sheard-reader on these files (see reader_start), its end of the socket pair and the shared
 * memory; all of them stay the caller's. Returns 0 or errno. */
int launch_reader(pid_t *pid, const shear_input *input, const int *fds, int child_socket,
                  int memory_fd, const reader_limits *limits);

#endif
