/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contradictions between settings. */
#include "origin.h"

#include <string.h>

/* Report it where the later of two settings was written: the one that somebody chose. */
static int contradiction(const sheard_config *config, sheard_problems *problems, const char *a,
                         const char *b, const shear_error *error) {
    char section[32];
    char where[sizeof problems->kept[0].where];
    size_t best = 0;
    int best_line = -2;
    const char *names[] = {a, b};
    for (int i = 0; i < 2; i++) {
        const char *dot = strchr(names[i], '.');
        snprintf(section, sizeof section, "%.*s", (int)(dot - names[i]), names[i]);
        size_t index = (size_t)sheard_setting_find(section, dot + 1);
        int line = config->lines[index];
        int rank = line < 0 ? INT32_MAX : line;
        if (rank > best_line) {
            best = index;
            best_line = rank;
        }
    }
    return problems_add(problems, config_where(config, best, where, sizeof where), error);
}

/* Whether path a is b or beneath it; both are tidy. */
static bool is_within(const char *a, const char *b) {
    size_t n = strlen(b);
    if (strcmp(b, "/") == 0) {
        return true;
    }
    return strncmp(a, b, n) == 0 && (a[n] == '\0' || a[n] == '/');
}

static void check_outside_spool(const sheard_config *c, const char *name, const char *path,
                                sheard_problems *problems) {
    shear_error error;
    if (c->spool.enabled && is_within(path, c->spool.directory)) {
        (void)shear_fail(&error, SHEAR_E_SETTING, "choose a directory outside the watch folder",
                         "%s %.180s is within spool.directory %.180s", name, path,
                         c->spool.directory);
        (void)contradiction(c, problems, name, "spool.directory", &error);
    }
}

static void check_directories(const sheard_config *c, sheard_problems *problems) {
    shear_error error;
    check_outside_spool(c, "daemon.state_dir", c->daemon.state_dir, problems);
    if (!c->catalogues.enabled) {
        return;
    }
    check_outside_spool(c, "catalogues.directory", c->catalogues.directory, problems);
    if (strcmp(c->catalogues.directory, c->daemon.state_dir) == 0) {
        (void)shear_fail(&error, SHEAR_E_SETTING, "a directory within it will do",
                         "catalogues.directory is daemon.state_dir itself");
        (void)contradiction(c, problems, "daemon.state_dir", "catalogues.directory", &error);
    }
}

/* The reader's own code, libraries and buffers beside the shared memory. */
#define READER_OWN_BYTES (INT64_C(48) << 20)

static void check_numbers(const sheard_config *c, sheard_problems *problems) {
    shear_error error;
    if (c->retry.first_delay_ms > c->retry.max_delay_ms) {
        (void)shear_fail(&error, SHEAR_E_SETTING, NULL,
                         "retry.first_delay is longer than retry.max_delay");
        (void)contradiction(c, problems, "retry.first_delay", "retry.max_delay", &error);
    }
    if (c->reader.shared_memory_bytes > c->reader.memory_bytes - READER_OWN_BYTES) {
        (void)shear_fail(&error, SHEAR_E_SETTING, "raise memory or lower shared_memory",
                         "reader.memory does not hold reader.shared_memory and the 48M of the "
                         "reader itself");
        (void)contradiction(c, problems, "reader.memory", "reader.shared_memory", &error);
    }
}

static void check_measure(const sheard_config *c, sheard_problems *problems) {
    shear_error error;
    char where[sizeof problems->kept[0].where];
    size_t best = (size_t)sheard_setting_find("measure", "interpolation");
    if (shear_settings_check(&c->measure, &error) == SHEAR_OK) {
        return;
    }
    for (size_t i = best; i < sheard_settings_count(); i++) {
        bool later = c->lines[i] == ORIGIN_COMMAND_LINE || c->lines[i] > c->lines[best];
        best = later && c->lines[best] != ORIGIN_COMMAND_LINE ? i : best;
    }
    (void)shear_prefix(&error, error.code, "[measure]");
    (void)problems_add(problems, config_where(c, best, where, sizeof where), &error);
}

int sheard_config_check(const sheard_config *config, sheard_problems *problems) {
    size_t before = problems->n_errors;
    check_directories(config, problems);
    check_numbers(config, problems);
    check_measure(config, problems);
    return problems->n_errors == before ? SHEAR_OK : SHEAR_E_SETTING;
}
