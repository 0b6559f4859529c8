/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warn of settings that are allowed but will hardly work on this system. */
#include "origin.h"

#include <errno.h>
#include <grp.h>
#include <inttypes.h>
#include <pwd.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

enum { ENTRY_BYTES = 1 << 20 }; /* room for a group with very many members */

typedef struct warning_scene {
    const sheard_config *config;
    sheard_problems *problems;
    char where[sizeof((sheard_problem *)0)->where];
} warning_scene;

static const char *where(warning_scene *scene, const char *section, const char *key) {
    size_t index = (size_t)sheard_setting_find(section, key);
    return config_where(scene->config, index, scene->where, sizeof scene->where);
}

/* Return false only if the user database answered and does not have the name. */
static bool group_known(const char *name, char *buf) {
    struct group entry;
    struct group *found = NULL;
    int code = getgrnam_r(name, &entry, buf, ENTRY_BYTES, &found);
    return found != NULL || (code != 0 && code != ENOENT);
}

static bool user_known(const char *name, char *buf) {
    struct passwd entry;
    struct passwd *found = NULL;
    int code = getpwnam_r(name, &entry, buf, ENTRY_BYTES, &found);
    return found != NULL || (code != 0 && code != ENOENT);
}

static void warn_names(warning_scene *scene, const char *key, const sheard_list *names, bool users,
                       char *buf) {
    for (size_t i = 0; i < names->n; i++) {
        const char *name = names->items[i];
        const bool is_number = name[strspn(name, "0123456789")] == '\0'; /* is valid, too */
        if (!is_number && !(users ? user_known(name, buf) : group_known(name, buf))) {
            problems_warn(scene->problems, where(scene, "access", key),
                          "remove it, or reload the service once there is one: until then "
                          "nobody has its rights",
                          "[access] %s: this system has no %s '%s'", key, users ? "user" : "group",
                          name);
        }
    }
}

static void warn_accounts(warning_scene *scene) {
    const sheard_config *c = scene->config;
    char *buf = malloc(ENTRY_BYTES);
    if (buf == NULL)
        return;
    warn_names(scene, "admin_users", &c->access.admin_users, true, buf);
    warn_names(scene, "admin_groups", &c->access.admin_groups, false, buf);
    warn_names(scene, "submit_groups", &c->access.submit_groups, false, buf);
    warn_names(scene, "priority_users", &c->access.priority_users, true, buf);
    warn_names(scene, "priority_groups", &c->access.priority_groups, false, buf);
    if (c->daemon.socket_group[0] != '\0' && !group_known(c->daemon.socket_group, buf)) {
        problems_warn(scene->problems, where(scene, "daemon", "socket_group"),
                      "without it the service does not start",
                      "[daemon] socket_group: this system has no group '%s'",
                      c->daemon.socket_group);
    }
    free(buf);
}

static void warn_roots(warning_scene *scene) {
    const sheard_list *roots = &scene->config->access.data_roots;
    for (size_t i = 0; i < roots->n; i++) {
        struct stat st;
        const char *root = roots->items[i];
        if (strcmp(root, "/") == 0) {
            problems_warn(
                scene->problems, where(scene, "access", "data_roots"),
                "name the directories that hold data",
                "[access] data_roots: '/' lets clients name every file that they may read");
        } else if (stat(root, &st) != 0) {
            problems_warn(scene->problems, where(scene, "access", "data_roots"),
                          "jobs beneath it wait until the service sees it; this is what the user "
                          "who runs the check sees",
                          "[access] data_roots: '%s': %s", root, strerror(errno));
        } else if (!S_ISDIR(st.st_mode)) {
            problems_warn(scene->problems, where(scene, "access", "data_roots"), NULL,
                          "[access] data_roots: '%s' is not a directory", root);
        }
    }
}

/* Descriptors beside the clients': database, spool and log; and, per active job, its input, shared
 * memory, socket and catalog. */
enum { OWN_DESCRIPTORS = 64, JOB_DESCRIPTORS = 6 };

int64_t sheard_config_own_descriptors(const sheard_config *config) {
    return OWN_DESCRIPTORS + JOB_DESCRIPTORS * config->daemon.max_active_jobs;
}

static void warn_descriptors(warning_scene *scene) {
    const sheard_config *c = scene->config;
    struct rlimit limit;
    uint64_t needed = (uint64_t)(c->limits.connections + sheard_config_own_descriptors(c));
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_max < needed) {
        problems_warn(scene->problems, where(scene, "limits", "connections"),
                      "lower it, or raise LimitNOFILE in sheard.service",
                      "[limits] connections: needs %" PRIu64
                      " file descriptors; this process may have %" PRIu64,
                      needed, (uint64_t)limit.rlim_max);
    }
}

void sheard_config_warnings(const sheard_config *config, sheard_problems *problems) {
    warning_scene scene = {.config = config, .problems = problems};
    warn_accounts(&scene);
    warn_roots(&scene);
    warn_descriptors(&scene);
    if ((config->daemon.socket_mode & 0002) != 0) {
        problems_warn(problems, where(&scene, "daemon", "socket_mode"),
                      "use 0660 and socket_group, unless that is meant",
                      "[daemon] socket_mode: every user of this system may connect");
    }
}
