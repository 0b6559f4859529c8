/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Load the file's values into a config. A value may continue on further lines, so it is set when
 * the next one begins. */
#include "base/buffer.h"
#include "base/cleanup.h"
#include "file.h"
#include "ini_text.h"
#include "origin.h"
#include "value.h"

#include <stdlib.h>
#include <string.h>

typedef struct loader {
    sheard_config *config;
    sheard_problems *problems;
    const char *path;
    char section[64];
    bool has_section, known_section;
    bool holds; /* `text` holds a value of setting `index` from line `line` */
    size_t index;
    int line;
    buffer text; /* lines are separated by '\n' */
    int *seen;   /* [sheard_settings_count()] line of the file that set it, or 0 */
    int code;    /* SHEAR_OK or SHEAR_E_NOMEM */
    shear_error error;
} loader;

static void report(loader *l, int line, const shear_error *error) {
    char where[sizeof l->problems->kept[0].where];
    problems_add(l->problems, place_in_file(l->path, line, where, sizeof where), error);
}

static void on_fault(void *context, int line, const char *advice, const char *message) {
    shear_error error;
    (void)shear_fail(&error, SHEAR_E_SETTING, advice, "%s", message);
    report(context, line, &error);
}

/* Set the value held, if there is one. */
static void flush(loader *l) {
    shear_error error;
    if (!l->holds)
        return;
    l->holds = false;
    CLEANUP(release_free) char *text = buffer_take(&l->text, NULL);
    if (text == NULL) {
        l->code = shear_fail(&l->error, SHEAR_E_NOMEM, NULL, "out of memory for the configuration");
    } else if (config_set_at(l->config, l->index, text, l->line, &error) != SHEAR_OK) {
        report(l, l->line, &error);
    }
}

static void on_section(void *context, int line, const char *name) {
    loader *l = context;
    shear_error error;
    flush(l);
    snprintf(l->section, sizeof l->section, "%s", name);
    l->has_section = true;
    l->known_section = sheard_section_help(name) != NULL;
    if (!l->known_section) {
        (void)config_unknown_section(name, &error);
        report(l, line, &error);
    }
}

static void continue_value(loader *l, int line, const char *more) {
    if (!l->holds) {
        return; /* the key has been reported */
    }
    const sheard_setting s = sheard_setting_at(l->index);
    if (!value_is_list(&s)) {
        char message[160];
        snprintf(message, sizeof message,
                 "this line begins with a space and so goes on with '%s' of line %d", s.key,
                 l->line);
        on_fault(l, line, "remove the space; only lists go on in further lines", message);
        return;
    }
    buffer_add_text(&l->text, "\n");
    buffer_add_text(&l->text, more);
}

/* Find the setting. Return false, and report the reason, if it is unknown or already set by this
 * file. */
static bool identify(loader *l, int line, const char *key) {
    shear_error error;
    if (!l->has_section) {
        on_fault(l, line, "write a [section] above it", "this setting comes before any section");
        return false;
    }
    if (!l->known_section) {
        return false; /* the section's line has been reported */
    }
    if (config_find(l->section, key, &l->index, &error) != SHEAR_OK) {
        report(l, line, &error);
        return false;
    }
    if (l->seen[l->index] != 0) {
        (void)shear_fail(&error, SHEAR_E_SETTING, "keep one of them",
                         "[%s] %s: was already set in line %d", l->section,
                         sheard_setting_at(l->index).key, l->seen[l->index]);
        report(l, line, &error);
        return false;
    }
    return true;
}

static void on_value(void *context, int line, const char *key, const char *text) {
    loader *l = context;
    if (key == NULL) {
        continue_value(l, line, text);
        return;
    }
    flush(l);
    if (!identify(l, line, key))
        return;
    l->seen[l->index] = line;
    l->line = line;
    l->holds = true;
    buffer_add_text(&l->text, text);
}

static int load_text(loader *l, const char *text, size_t size) {
    ini_events events = {l, on_section, on_value, on_fault};
    l->seen = calloc(sheard_settings_count(), sizeof *l->seen);
    if (l->seen == NULL)
        return shear_fail(&l->error, SHEAR_E_NOMEM, NULL, "out of memory for the configuration");
    ini_text_read(text, size, &events);
    flush(l);
    free(l->seen);
    return l->code;
}

/* Record the file's path, and clear the origins of all values. */
static int renew_path(sheard_config *config, const char *path, shear_error *err) {
    char *copy = strdup(path);
    if (copy == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the configuration");
    free(config->path);
    config->path = copy;
    memset(config->lines, 0, sheard_settings_count() * sizeof *config->lines);
    return SHEAR_OK;
}

static int load(loader *l, bool may_miss) {
    CLEANUP(release_free) char *text = NULL;
    size_t size = 0;
    TRY(renew_path(l->config, l->path, &l->error));
    int code = file_read(l->path, may_miss, &text, &size, &l->error);
    if (code != SHEAR_OK || text == NULL)
        return code;
    return load_text(l, text, size);
}

int config_load_file(sheard_config *config, const char *path, bool may_miss,
                     sheard_problems *problems) {
    loader l = {.config = config, .problems = problems, .path = path};
    const size_t errors_before = problems->n_errors;
    const int code = load(&l, may_miss);
    if (code != SHEAR_OK) {
        report(&l, 0, &l.error);
        return code;
    }
    return problems->n_errors == errors_before ? SHEAR_OK : SHEAR_E_SETTING;
}

int sheard_config_load(sheard_config *config, const char *path, sheard_problems *problems) {
    const char *usual = sheard_config_default_path();
    bool may_miss = path == NULL || strcmp(path, usual) == 0;
    return config_load_file(config, path != NULL ? path : usual, may_miss, problems);
}
