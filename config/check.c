/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Check for contradictions between settings. */
#include "origin.h"

#include <string.h>

/* Return which of two settings was set later: probably it is the wrong one. */
static size_t later(const sheard_config *c, size_t a, size_t b) {
    if (c->lines[a] == ORIGIN_COMMAND_LINE)
        return a;
    return c->lines[b] == ORIGIN_COMMAND_LINE || c->lines[b] > c->lines[a] ? b : a;
}

static void report(const sheard_config *c, size_t index, const shear_error *error,
                   sheard_problems *problems) {
    char where[sizeof problems->kept[0].where];
    (void)problems_add(problems, config_where(c, index, where, sizeof where), error);
}

/* Return whether path a is b or beneath it; both are tidied. */
static bool is_within(const char *a, const char *b) {
    size_t n = strlen(b);
    if (strcmp(b, "/") == 0)
        return true;
    return strncmp(a, b, n) == 0 && (a[n] == '\0' || a[n] == '/');
}

static void check_outside_spool(const sheard_config *c, const char *section, const char *key,
                                const char *path, sheard_problems *problems) {
    shear_error error;
    if (c->spool.enabled && is_within(path, c->spool.directory)) {
        (void)shear_fail(&error, SHEAR_E_SETTING, "choose a directory outside the watch folder",
                         "%s.%s %.180s is within spool.directory %.180s", section, key, path,
                         c->spool.directory);
        report(c, later(c, config_at(section, key), config_at("spool", "directory")), &error,
               problems);
    }
}

static void check_directories(const sheard_config *c, sheard_problems *problems) {
    shear_error error;
    check_outside_spool(c, "daemon", "state_dir", c->daemon.state_dir, problems);
    if (!c->catalogs.enabled)
        return;
    check_outside_spool(c, "catalogues", "directory", c->catalogs.directory, problems);
    if (strcmp(c->catalogs.directory, c->daemon.state_dir) == 0) {
        (void)shear_fail(&error, SHEAR_E_SETTING, "a directory within it will do",
                         "catalogues.directory is daemon.state_dir itself");
        report(c, later(c, config_at("daemon", "state_dir"), config_at("catalogues", "directory")),
               &error, problems);
    }
}

/* Memory of the reader's code, libraries and buffers, beside the shared memory. */
#define READER_OWN_BYTES (INT64_C(48) << 20)

static void check_numbers(const sheard_config *c, sheard_problems *problems) {
    shear_error error;
    if (c->retry.first_delay_ms > c->retry.max_delay_ms) {
        (void)shear_fail(&error, SHEAR_E_SETTING, NULL,
                         "retry.first_delay is longer than retry.max_delay");
        report(c, later(c, config_at("retry", "first_delay"), config_at("retry", "max_delay")),
               &error, problems);
    }
    if (c->reader.shared_memory_bytes > c->reader.memory_bytes - READER_OWN_BYTES) {
        (void)shear_fail(&error, SHEAR_E_SETTING, "raise memory or lower shared_memory",
                         "reader.memory does not hold reader.shared_memory and the 48M of the "
                         "reader itself");
        report(c, later(c, config_at("reader", "memory"), config_at("reader", "shared_memory")),
               &error, problems);
    }
}

static void check_measure(const sheard_config *c, sheard_problems *problems) {
    shear_error error;
    if (shear_settings_check(&c->measure, &error) == SHEAR_OK)
        return;
    size_t latest = config_at("measure", "interpolation");
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        if (sheard_setting_at(i).type == SHEARD_T_MEASURE)
            latest = later(c, latest, i);
    }
    (void)shear_prefix(&error, error.code, "[measure]");
    report(c, latest, &error, problems);
}

int sheard_config_check(const sheard_config *config, sheard_problems *problems) {
    size_t before = problems->n_errors;
    check_directories(config, problems);
    check_numbers(config, problems);
    check_measure(config, problems);
    return problems->n_errors == before ? SHEAR_OK : SHEAR_E_SETTING;
}
