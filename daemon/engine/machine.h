/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/machine.h: the memory that this process may use. */
#pragma once

#include <stdint.h>

/* Return the memory of the machine in bytes, or less if RLIMIT_AS or a control group limits it. */
int64_t machine_memory(void);

/* Return the least memory.max or memory.high, in bytes, of a version 2 control group and its
 * parents, or INT64_MAX if there is no limit. `membership` (/proc/self/cgroup) is a file with the
 * group's name, `root` (/sys/fs/cgroup) the directory of all groups. */
int64_t machine_cgroup_memory(const char *membership, const char *root);
