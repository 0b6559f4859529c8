/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/config.h"

#include "base/cleanup.h"
#include "base/io.h"
#include "base/text.h"
#include "origin.h"
#include "table.h"
#include "value.h"

#include <assert.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Find "PREFIX/etc/sheard/sheard.conf" of a program in PREFIX/sbin or PREFIX/bin. Return false if
 * it does not exist. */
static bool find_beneath_prefix(char *path, size_t size) {
    if (io_own_directory(path, size) != 0)
        return false;
    char *slash = strrchr(path, '/');
    if (slash == NULL)
        return false;
    *slash = '\0';
    return text_append(path, size, "/etc/sheard/sheard.conf") && access(path, F_OK) == 0;
}

const char *sheard_config_default_path(void) {
    static char beneath[PATH_MAX];
    return find_beneath_prefix(beneath, sizeof beneath) ? beneath : SHEARD_CONFIG_FILE;
}

/* Set a setting of the measurement. A preset does not change settings that the file has set
 * already. */
static int set_measure(sheard_config *config, const char *key, const char *text, shear_error *err) {
    enum { MOST = 64 }; /* more than there are settings of the measurement */
    bool given[MOST] = {false};
    const size_t n = sheard_settings_count() - config_n_rows;
    assert(n <= MOST);
    for (size_t i = 0; i < n; i++)
        given[i] = config->lines[config_n_rows + i] != ORIGIN_DEFAULT;
    const int code = shear_settings_give(&config->measure, given, key, text, err);
    return code == SHEAR_OK ? code : shear_prefix(err, code, "[measure]");
}

static int set_index(sheard_config *config, size_t index, const char *text, shear_error *err) {
    sheard_setting s = sheard_setting_at(index);
    if (s.type == SHEARD_T_MEASURE)
        return set_measure(config, s.key, text, err);
    value parsed;
    TRY(value_parse(&s, text, &parsed, err));
    void *member = config_member(config, &s);
    value_deinit(&s, member);
    memcpy(member, &parsed, value_size(&s));
    return SHEAR_OK;
}

int config_set_at(sheard_config *config, size_t index, const char *text, int line,
                  shear_error *err) {
    assert(index < sheard_settings_count() && line >= ORIGIN_EARLIER);
    TRY(set_index(config, index, text, err));
    config->lines[index] = line;
    return SHEAR_OK;
}

int sheard_config_init(sheard_config *config, shear_error *err) {
    *config = (sheard_config){.lines = calloc(sheard_settings_count(), sizeof(int))};
    if (config->lines == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the configuration");
    shear_settings_init(&config->measure);
    for (size_t i = 0; i < config_n_rows; i++) {
        const int code = config_set_at(config, i, config_rows[i].initial, ORIGIN_DEFAULT, err);
        if (code != SHEAR_OK) {
            sheard_config_deinit(config);
            return code;
        }
    }
    return SHEAR_OK;
}

void sheard_config_deinit(sheard_config *config) {
    for (size_t i = 0; i < config_n_rows; i++)
        value_deinit(&config_rows[i], config_member(config, &config_rows[i]));
    free(config->path);
    free(config->lines);
    *config = (sheard_config){0};
}

int config_unknown_section(const char *section, shear_error *err) {
    const char *near = config_nearest_section(section);
    char advice[80];
    snprintf(advice, sizeof advice, "did you mean [%s]?", near != NULL ? near : "");
    return shear_fail(err, SHEAR_E_SETTING,
                      near != NULL ? advice : "the sections are listed in sheard.conf(5)",
                      "there is no section [%.60s]", section);
}

static int unknown_key(const char *section, const char *key, shear_error *err) {
    const char *near = config_nearest_key(section, key);
    const char *home = config_section_of(key);
    char advice[120] = "the settings are listed in sheard.conf(5)";
    if (home != NULL) {
        snprintf(advice, sizeof advice, "it belongs in section [%s]", home);
    } else if (near != NULL) {
        snprintf(advice, sizeof advice, "did you mean %s?", near);
    }
    return shear_fail(err, SHEAR_E_SETTING, advice, "[%s] there is no setting '%.60s'", section,
                      key);
}

int config_find(const char *section, const char *key, size_t *index, shear_error *err) {
    if (sheard_section_help(section) == NULL)
        return config_unknown_section(section, err);
    ptrdiff_t found = sheard_setting_find(section, key);
    if (found < 0)
        return unknown_key(section, key, err);
    *index = (size_t)found;
    return SHEAR_OK;
}

int sheard_config_set(sheard_config *config, const char *section, const char *key, const char *text,
                      shear_error *err) {
    size_t index = 0;
    TRY(config_find(section, key, &index, err));
    return config_set_at(config, index, text, ORIGIN_COMMAND_LINE, err);
}

int sheard_config_assign(sheard_config *config, const char *assignment, shear_error *err) {
    const char *dot = strchr(assignment, '.');
    const char *equals = strchr(assignment, '=');
    if (dot == NULL || equals == NULL || equals < dot) {
        return shear_fail(err, SHEAR_E_SETTING, "as in daemon.workers=4",
                          "'%.200s' is not of the form section.key=value", assignment);
    }
    CLEANUP(release_free) char *section = strndup(assignment, (size_t)(dot - assignment));
    CLEANUP(release_free) char *key = strndup(dot + 1, (size_t)(equals - dot - 1));
    return section != NULL && key != NULL
               ? sheard_config_set(config, section, key, equals + 1, err)
               : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for '%.60s'", assignment);
}

char *sheard_config_format(const sheard_config *config, size_t index) {
    sheard_setting s = sheard_setting_at(index);
    if (s.type == SHEARD_T_MEASURE) {
        char buf[VALUE_TEXT_MAX];
        return strdup(shear_settings_format(&config->measure, s.measure, buf, sizeof buf));
    }
    return value_format(&s, config_const_member(config, &s));
}
