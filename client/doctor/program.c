/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of the daemon's program and its configuration. The program itself checks the
 * configuration. */
#include "base/cleanup.h"
#include "doctor/conf_text.h"
#include "doctor/internal.h"
#include "doctor/run_program.h"
#include "shear/version.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

static int ask(const char *config, const char *program, const char *what, char **text) {
    const char *argv[] = {program, what, config != NULL ? "--config" : NULL, config, NULL};
    return run_program(argv, text);
}

/* Return the first line that contains `word` but not `other` (unless NULL), truncated; or NULL. */
static const char *line_with(const char *text, const char *word, const char *other, char *buf,
                             size_t size) {
    while (*text != '\0') {
        const size_t n = strcspn(text, "\n");
        snprintf(buf, size, "%.*s", (int)n, text);
        if (strstr(buf, word) != NULL && (other == NULL || strstr(buf, other) == NULL))
            return buf;
        text += n + (text[n] == '\n');
    }
    return NULL;
}

static void check_version(doctor *d, const char *program) {
    CLEANUP(release_free) char *text = NULL;
    const int code = ask(NULL, program, "--version", &text);
    if (code != 0 || text == NULL) {
        doctor_fail(d, "program", "install sheard again", "%s cannot be run (exit code %d)",
                    program, code);
    } else if (strstr(text, SHEAR_VERSION_STRING) == NULL) {
        doctor_warn(d, "program", "install shearctl and sheard of the same release",
                    "%s is %.*s, shearctl is %s", program, (int)strcspn(text, "\n"), text,
                    SHEAR_VERSION_STRING);
    } else {
        doctor_ok(d, "program", "%s, %.*s", program, (int)strcspn(text, "\n"), text);
    }
}

void doctor_check_config(doctor *d) {
    char line[400];
    CLEANUP(release_free) char *text = NULL;
    if (d->program == NULL)
        return;
    if (d->told && access(d->config, R_OK) != 0) {
        doctor_warn(d, "config", "run doctor as root",
                    "%s, which the service uses, cannot be read by you: %s", d->config,
                    strerror(errno));
        return;
    }
    const int code = ask(d->config, d->program, "--check-config", &text);
    const char *said = text != NULL ? text : "";
    const char *name = d->config != NULL ? d->config : "the configuration";
    if (code != 0) {
        const char *why = line_with(said, "error", NULL, line, sizeof line);
        doctor_fail(d, "config", "correct the file; sheard --check-config lists all of its errors",
                    "%s is not valid: %s", name, why != NULL ? why : "no reason was given");
    } else if (line_with(said, "warning", d->told ? "data_roots" : NULL, line, sizeof line) !=
               NULL) {
        /* data roots: the service reports on them later */
        doctor_warn(d, "config", "sheard --check-config lists all errors", "%s", line);
    } else {
        doctor_ok(d, "config", "%s is valid", name);
    }
}

static void read_config(doctor *d) {
    CLEANUP(release_free) char *text = NULL;
    if (ask(d->config, d->program, "--print-config", &text) != 0 || text == NULL)
        return;
    d->state_dir = conf_text_value(text, "daemon", "state_dir");
    d->socket = conf_text_value(text, "daemon", "socket");
    d->spool = conf_text_value(text, "spool", "directory");
    d->roots = conf_text_value(text, "access", "data_roots");
    CLEANUP(release_free) char *enabled = conf_text_value(text, "spool", "enabled");
    d->has_spool = enabled != NULL && strcmp(enabled, "true") == 0;
}

void doctor_check_program(doctor *d) {
    d->program = run_program_find("sheard");
    if (d->program == NULL) {
        doctor_warn(d, "program", "install sheard, or run doctor where the service runs",
                    "sheard is not installed here: its configuration cannot be examined");
        return;
    }
    check_version(d, d->program);
    read_config(d);
}
