/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/machine.h"

#include "base/cleanup.h"
#include "base/text.h"

#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

enum { PATH_SIZE = 4300 };

static int64_t least(int64_t a, int64_t b) {
    return a < b ? a : b;
}

/* Return the number in a file of the group; INT64_MAX for "max" or if there is no such file. */
static int64_t read_limit(const char *group, const char *name) {
    char path[PATH_SIZE + 512];
    char line[32] = "";
    int64_t bytes = 0;
    snprintf(path, sizeof path, "%s/%s", group, name);
    CLEANUP(release_file) FILE *f = fopen(path, "re");
    if (f == NULL || fgets(line, sizeof line, f) == NULL)
        return INT64_MAX;
    line[strcspn(line, "\n")] = '\0';
    return text_to_int64(line, &bytes) && bytes > 0 ? bytes : INT64_MAX;
}

static int64_t memory_of(const char *group) {
    return least(read_limit(group, "memory.max"), read_limit(group, "memory.high"));
}

/* Get the group's name. False, with the empty name: there is none. It is in the line "0::/path",
 * that of version 2. */
static bool read_group(const char *membership, char group[PATH_SIZE]) {
    char line[PATH_SIZE];
    CLEANUP(release_file) FILE *f = fopen(membership, "re");
    group[0] = '\0';
    while (f != NULL && fgets(line, sizeof line, f) != NULL) {
        if (strncmp(line, "0::", 3) == 0) {
            line[strcspn(line, "\n")] = '\0';
            text_set(group, PATH_SIZE, line + 3);
        }
    }
    return group[0] != '\0';
}

/* Return the least of the limits of a group and its parents. `limit_of` returns that of a group's
 * directory, or INT64_MAX if it has none. */
static int64_t least_limit(const char *root, const char *group,
                           int64_t (*limit_of)(const char *directory)) {
    char path[PATH_SIZE + 256];
    int64_t limit = INT64_MAX;
    snprintf(path, sizeof path, "%s%s", root, group);
    for (const size_t top = strlen(root); strlen(path) >= top;) {
        limit = least(limit, limit_of(path));
        char *slash = strrchr(path, '/');
        if (slash == NULL)
            break;
        *slash = '\0';
    }
    return limit;
}

int64_t machine_cgroup_memory(const char *membership, const char *root) {
    char group[PATH_SIZE];
    (void)read_group(membership, group);
    return least_limit(root, group, memory_of);
}

int64_t machine_memory(void) {
    const long pages = sysconf(_SC_PHYS_PAGES);
    const long page = sysconf(_SC_PAGESIZE);
    struct rlimit space;
    int64_t bytes = machine_cgroup_memory("/proc/self/cgroup", "/sys/fs/cgroup");
    if (pages > 0 && page > 0)
        bytes = least(bytes, (int64_t)pages * page);
    if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur < INT64_MAX)
        bytes = least(bytes, (int64_t)space.rlim_cur);
    return bytes;
}

/* Read cpu.max: "QUOTA PERIOD", or "max PERIOD". Return the quota in processors, rounded up, or
 * INT64_MAX. */
static int64_t quota_of(const char *group) {
    char path[PATH_SIZE + 512];
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

int machine_cgroup_quota(const char *membership, const char *root) {
    char group[PATH_SIZE];
    if (!read_group(membership, group))
        return 0;
    const int64_t limit = least_limit(root, group, quota_of);
    return limit < INT64_MAX ? (int)limit : 0;
}

int machine_processors(void) {
    cpu_set_t set;
    const int quota = machine_cgroup_quota("/proc/self/cgroup", "/sys/fs/cgroup");
    /* EINVAL: the machine has more than 1024 processors */
    long count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set)
                                                             : sysconf(_SC_NPROCESSORS_ONLN);
    count = quota > 0 && quota < count ? quota : count;
    return count > 0 ? (int)count : 1;
}
