/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/machine.h: the memory and the processors that this process may use. */
#pragma once

#include <stdint.h>

/* Return the memory of the machine in bytes, or less if RLIMIT_AS or a control group limits it. */
int64_t machine_memory(void);
/* Return the number of processors in this process's affinity mask (CPUAffinity=, taskset), limited
 * by the quotas of its control groups (CPUQuota=, a container's), rounded up. At least 1. */
int machine_processors(void);

/* ---- control groups (version 2) ----
 *
 * `membership` (/proc/self/cgroup) is a file with the group's name, `root` (/sys/fs/cgroup) the
 * directory of all groups. */

/* Return the least memory.max or memory.high of the group and its parents, in bytes, or INT64_MAX
 * if there is no limit. */
int64_t machine_cgroup_memory(const char *membership, const char *root);
/* Return the smallest quota of the group and its parents, in processors; 0: no quota. */
int machine_cgroup_quota(const char *membership, const char *root);
