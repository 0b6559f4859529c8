/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/machine.h: what this process may use of the machine. */
#ifndef SHEARD_ENGINE_MACHINE_H
#define SHEARD_ENGINE_MACHINE_H

#include <stdint.h>

/* Bytes of memory: of the machine, or less where RLIMIT_AS or a control group says so. */
int64_t machine_memory(void);

/* The least memory.max or memory.high of the version 2 control group that the file `membership`
 * (/proc/self/cgroup) names beneath `root` (/sys/fs/cgroup), and of those above it; INT64_MAX
 * where there is no limit. */
int64_t machine_cgroup_memory(const char *membership, const char *root);

#endif
