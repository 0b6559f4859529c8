/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Provide the whole table of settings: the daemon's own rows, then the measurement's as section
 * [measure]. */
#include "table.h"

#include "base/spelling.h"
#include "origin.h"

#include <assert.h>
#include <string.h>

/* In the order of the rows. */
static const struct {
    const char *name, *help;
} sections[] = {
    {"daemon", "The process, its socket and its threads."},
    {"spool",
     "The watch folder: files that appear in DIRECTORY/incoming are measured, and then moved to "
     "DIRECTORY/done or DIRECTORY/failed."},
    {"catalogues", "One result catalog per job, with a row per stamp."},
    {"access",
     "Who may do what, and which files clients may name. A client's file is only read if that "
     "client may read it."},
    {"limits", "Bounds that keep one client, or all of them, from taking the service down."},
    {"reader",
     "Bounds on the sandboxed process that reads one file. A file that needs more fails, and "
     "nothing else does."},
    {"plans",
     "A plan is what the measurement prepares for one shape of stamps, settings and PSF: tables, "
     "transforms, the PSF's own spectrum. Plans are kept in memory for later files that need the "
     "same."},
    {"retry",
     "Jobs that failed for reasons that pass: a full disk, a file that vanished, no memory."},
    {"retention", "How long the records of finished jobs are kept."},
    {"measure",
     "The measurement, for jobs that do not say otherwise. Jobs keep the settings that they were "
     "accepted with."},
};
enum { N_SECTIONS = sizeof sections / sizeof sections[0] };

size_t sheard_settings_count(void) {
    size_t n_measure = 0;
    (void)shear_settings_table(&n_measure);
    return config_n_rows + n_measure;
}

sheard_setting sheard_setting_at(size_t i) {
    assert(i < sheard_settings_count());
    if (i < config_n_rows)
        return config_rows[i];
    size_t n = 0;
    const shear_setting_def *def = &shear_settings_table(&n)[i - config_n_rows];
    return (sheard_setting){.section = "measure",
                            .key = def->name,
                            .type = SHEARD_T_MEASURE,
                            .choices = def->choices,
                            .unit = def->unit,
                            .help = def->help,
                            .measure = def};
}

ptrdiff_t sheard_setting_find(const char *section, const char *key) {
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        sheard_setting s = sheard_setting_at(i);
        if (strcmp(s.section, section) == 0 && spelling_same(s.key, key))
            return (ptrdiff_t)i;
    }
    return -1;
}

size_t config_at(const char *section, const char *key) {
    const ptrdiff_t index = sheard_setting_find(section, key);
    assert(index >= 0);
    return (size_t)index;
}

const char *sheard_section_help(const char *section) {
    for (size_t i = 0; i < N_SECTIONS; i++) {
        if (strcmp(sections[i].name, section) == 0)
            return sections[i].help;
    }
    return NULL;
}

const char *config_nearest_section(const char *name) {
    spelling s = {.given = name};
    for (size_t i = 0; i < N_SECTIONS; i++)
        spelling_consider(&s, sections[i].name);
    return s.best;
}

const char *config_nearest_key(const char *section, const char *key) {
    spelling s = {.given = key};
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        if (strcmp(sheard_setting_at(i).section, section) == 0)
            spelling_consider(&s, sheard_setting_at(i).key);
    }
    return s.best;
}

const char *config_section_of(const char *key) {
    for (size_t i = 0; i < sheard_settings_count(); i++) {
        if (spelling_same(sheard_setting_at(i).key, key))
            return sheard_setting_at(i).section;
    }
    return NULL;
}

void *config_member(sheard_config *config, const sheard_setting *s) {
    assert(s->type != SHEARD_T_MEASURE);
    return (char *)config + s->offset;
}

const void *config_const_member(const sheard_config *config, const sheard_setting *s) {
    assert(s->type != SHEARD_T_MEASURE);
    return (const char *)config + s->offset;
}
