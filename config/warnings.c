/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warn of settings that are allowed but will hardly work on this system. */
#include "base/accounts.h"
#include "origin.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

/* Return whether the user database answered and does not have the name. */
static bool is_unknown(bool user, const char *name) {
    unsigned id;
    return (user ? accounts_find_user(name, &id) : accounts_find_group(name, &id)) == ENOENT;
}

static void warn_names(const sheard_config *c, sheard_problems *problems, const char *key,
                       const sheard_list *names, bool users) {
    for (size_t i = 0; i < names->n; i++) {
        const char *name = names->items[i];
        const bool is_number = name[strspn(name, "0123456789")] == '\0'; /* is valid, too */
        if (!is_number && is_unknown(users, name)) {
            problems_warn(problems, c, config_at("access", key),
                          "remove it, or reload the service once there is one: until then "
                          "nobody has its rights",
                          "[access] %s: this system has no %s '%s'", key, users ? "user" : "group",
                          name);
        }
    }
}

static void warn_accounts(const sheard_config *c, sheard_problems *problems) {
    warn_names(c, problems, "admin_users", &c->access.admin_users, true);
    warn_names(c, problems, "admin_groups", &c->access.admin_groups, false);
    warn_names(c, problems, "submit_groups", &c->access.submit_groups, false);
    warn_names(c, problems, "priority_users", &c->access.priority_users, true);
    warn_names(c, problems, "priority_groups", &c->access.priority_groups, false);
    if (c->daemon.socket_group[0] != '\0' && is_unknown(false, c->daemon.socket_group)) {
        problems_warn(problems, c, config_at("daemon", "socket_group"),
                      "without it the service does not start",
                      "[daemon] socket_group: this system has no group '%s'",
                      c->daemon.socket_group);
    }
}

static void warn_roots(const sheard_config *c, sheard_problems *problems) {
    const sheard_list *roots = &c->access.data_roots;
    const size_t index = config_at("access", "data_roots");
    for (size_t i = 0; i < roots->n; i++) {
        struct stat st;
        const char *root = roots->items[i];
        if (strcmp(root, "/") == 0) {
            problems_warn(
                problems, c, index, "name the directories that hold data",
                "[access] data_roots: '/' lets clients name every file that they may read");
        } else if (stat(root, &st) != 0) {
            problems_warn(problems, c, index,
                          "jobs beneath it wait until the service sees it; this is what the user "
                          "who runs the check sees",
                          "[access] data_roots: '%s': %s", root, strerror(errno));
        } else if (!S_ISDIR(st.st_mode)) {
            problems_warn(problems, c, index, NULL, "[access] data_roots: '%s' is not a directory",
                          root);
        }
    }
}

/* Descriptors beside the clients': database, spool and log; and, per active job, its input, shared
 * memory, socket and catalog. */
enum { OWN_DESCRIPTORS = 64, JOB_DESCRIPTORS = 6 };

int64_t sheard_config_own_descriptors(const sheard_config *config) {
    return OWN_DESCRIPTORS + JOB_DESCRIPTORS * config->daemon.max_active_jobs;
}

static void warn_descriptors(const sheard_config *c, sheard_problems *problems) {
    struct rlimit limit;
    uint64_t needed = (uint64_t)(c->limits.connections + sheard_config_own_descriptors(c));
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_max < needed) {
        problems_warn(problems, c, config_at("limits", "connections"),
                      "lower it, or raise LimitNOFILE in sheard.service",
                      "[limits] connections: needs %" PRIu64
                      " file descriptors; this process may have %" PRIu64,
                      needed, (uint64_t)limit.rlim_max);
    }
}

void sheard_config_warnings(const sheard_config *config, sheard_problems *problems) {
    warn_accounts(config, problems);
    warn_roots(config, problems);
    warn_descriptors(config, problems);
    if ((config->daemon.socket_mode & 0002) != 0) {
        problems_warn(problems, config, config_at("daemon", "socket_mode"),
                      "use 0660 and socket_group, unless that is meant",
                      "[daemon] socket_mode: every user of this system may connect");
    }
}
