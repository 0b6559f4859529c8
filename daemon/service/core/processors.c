/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "service/core/processors.h"

#include <sched.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_SIZE = 4096 };

/* Read cpu.max: "QUOTA PERIOD", or "max PERIOD". Return the quota in processors, rounded up; 0:
 * none. */
static int read_quota(const char *group) {
    char path[2 * PATH_SIZE + 16];
    char text[64] = "";
    char *end = text;
    snprintf(path, sizeof path, "%s/cpu.max", group);
    FILE *file = fopen(path, "re");
    if (file == NULL)
        return 0;
    const bool got = fgets(text, sizeof text, file) != NULL;
    fclose(file);
    const long long quota = got ? strtoll(text, &end, 10) : 0;
    const long long period = strtoll(end, NULL, 10);
    return quota > 0 && period > 0 && quota / period < 1000000
               ? (int)((quota + period - 1) / period)
               : 0;
}

/* Read the path of our group in the hierarchy of version 2, "0::PATH". False: there is none. */
static bool read_membership(const char *membership, char *path, size_t size) {
    char line[PATH_SIZE];
    bool found = false;
    FILE *file = fopen(membership, "re");
    while (file != NULL && !found && fgets(line, sizeof line, file) != NULL)
        found = strncmp(line, "0::/", 4) == 0;
    if (file != NULL)
        fclose(file);
    if (found) {
        line[strcspn(line, "\n")] = '\0';
        snprintf(path, size, "%s", line + 3);
    }
    return found;
}

int processors_quota(const char *membership, const char *top) {
    char path[PATH_SIZE];
    char group[2 * PATH_SIZE];
    int least = 0;
    if (!read_membership(membership, path, sizeof path))
        return 0;
    for (bool more = true; more;) {
        snprintf(group, sizeof group, "%.*s%s", PATH_SIZE - 1, top, path);
        const int quota = read_quota(group);
        least = quota > 0 && (least == 0 || quota < least) ? quota : least;
        char *slash = strrchr(path, '/');
        more = slash != NULL;
        if (more) {
            *slash = '\0'; /* the parent group: its quota includes all groups in it */
        }
    }
    return least;
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
