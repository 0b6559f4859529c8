/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/processors.h: how many processors this process may keep busy. */
#pragma once

/* Return the number of processors in this process's affinity mask (CPUAffinity=, taskset), limited
 * by the quotas of its control groups (CPUQuota=, a container's), rounded up. At least 1. */
int processors_count(void);

/* Return the smallest quota of the control group and those around it, in processors; 0: no quota.
 * `membership`: path of /proc/self/cgroup; `top`: where control groups (version 2) are mounted. */
int processors_quota(const char *membership, const char *top);
