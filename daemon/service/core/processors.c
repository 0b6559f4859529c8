/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/processors.h"

#include "base/cleanup.h"
#include "engine/machine.h"

#include <sched.h>

/* Read cpu.max: "QUOTA PERIOD", or "max PERIOD". Return the quota in processors, rounded up, or
 * INT64_MAX. */
static int64_t quota_of(const char *group) {
    char path[MACHINE_PATH_SIZE + 512];
    char text[64] = "";
    char *end = text;
    snprintf(path, sizeof path, "%s/cpu.max", group);
    CLEANUP(release_file) FILE *file = fopen(path, "re");
    const bool got = file != NULL && fgets(text, sizeof text, file) != NULL;
    const long long quota = got ? strtoll(text, &end, 10) : 0;
    const long long period = strtoll(end, NULL, 10);
    return quota > 0 && period > 0 && quota / period < 1000000 ? (quota + period - 1) / period
                                                               : INT64_MAX;
}

int processors_quota(const char *membership, const char *top) {
    char group[MACHINE_PATH_SIZE];
    if (!machine_group(membership, group))
        return 0;
    const int64_t least = machine_least_limit(top, group, quota_of);
    return least < INT64_MAX ? (int)least : 0;
}

int processors_count(void) {
    cpu_set_t set;
    const int quota = processors_quota("/proc/self/cgroup", "/sys/fs/cgroup");
    /* EINVAL: the machine has more than 1024 processors */
    long count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set)
                                                             : sysconf(_SC_NPROCESSORS_ONLN);
    count = quota > 0 && quota < count ? quota : count;
    return count > 0 ? (int)count : 1;
}
