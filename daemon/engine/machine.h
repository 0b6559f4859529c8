/* SPDX-License-Identifier: GPL-3.0-or-later */
/* engine/machine.h: the memory that this process may use, and the limits of control groups
 * (version 2). `membership` is a file with the group's name (/proc/self/cgroup), `root` the
 * directory of all groups (/sys/fs/cgroup). */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { MACHINE_PATH_SIZE = 4300 };

/* Return the memory of the machine in bytes, or less if RLIMIT_AS or a control group limits it. */
int64_t machine_memory(void);

/* Return the least memory.max or memory.high, in bytes, of a control group and its parents, or
 * INT64_MAX if there is no limit. */
int64_t machine_cgroup_memory(const char *membership, const char *root);

/* Get the group's name. False, with the empty name: there is none. */
bool machine_group(const char *membership, char group[MACHINE_PATH_SIZE]);
/* Return the least of the limits of a group and its parents. `limit_of` returns that of a group's
 * directory, or INT64_MAX if it has none. */
int64_t machine_least_limit(const char *root, const char *group,
                            int64_t (*limit_of)(const char *directory));
