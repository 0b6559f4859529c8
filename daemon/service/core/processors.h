/* SPDX-License-Identifier: GPL-3.0-or-later */
/* service/core/processors.h: how many processors this process may keep busy. */
#ifndef SHEARD_SERVICE_PROCESSORS_H
#define SHEARD_SERVICE_PROCESSORS_H

/* Those that it may run on (CPUAffinity=, taskset), and no more than the quotas of its control
 * groups (CPUQuota=, a container's) allow, rounded up. At least 1. */
int processors_count(void);

/* What the quotas allow; 0: as many as there are. `membership`: /proc/self/cgroup; `top`: where
 * control groups (version 2) are mounted. */
int processors_quota(const char *membership, const char *top);

#endif
