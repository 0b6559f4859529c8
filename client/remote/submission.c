/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/submission.h"

#include "base/cleanup.h"
#include "base/text.h"
#include "cmdline/input_path.h"
#include "terminal/message.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* ---- Job files ---- */

static enum exit_code read_all(FILE *in, const char *name, char *buf, size_t size, size_t *n) {
    *n = fread(buf, 1, size, in);
    if (ferror(in) != 0)
        return message_fail(EXIT_CODE_INPUT, NULL, "cannot read %s: %s", name, strerror(errno));
    if (*n == size) {
        return message_fail(EXIT_CODE_INPUT, NULL,
                            "%s is not a job file: it has more than %d bytes", name,
                            SHEARD_MSG_JOB_FILE_MAX);
    }
    return EXIT_CODE_DONE;
}

static enum exit_code parse_job(submission *s, const char *name, const char *text, size_t n) {
    sheard_rpc_error error = {0};
    if (sheard_job_file_parse(&s->parsed, text, n, NULL, &error) != 0) {
        return message_fail(error.code == SHEARD_RPC_OUT_OF_MEMORY ? EXIT_CODE_OTHER
                                                                   : EXIT_CODE_INPUT,
                            error.advice, "%s: %s [%s]", name, error.message, error.name);
    }
    return EXIT_CODE_DONE;
}

static enum exit_code read_job_from(submission *s, FILE *in, const char *shown) {
    const size_t size = SHEARD_MSG_JOB_FILE_MAX + 1;
    size_t n = 0;
    CLEANUP(release_free) char *text = malloc(size);
    if (text == NULL)
        return message_no_memory();
    TRY(read_all(in, shown, text, size, &n));
    return parse_job(s, shown, text, n);
}

static enum exit_code read_job_file(submission *s, const char *name) {
    if (strcmp(name, "-") == 0)
        return read_job_from(s, stdin, "standard input");
    CLEANUP(release_file) FILE *in = fopen(name, "re");
    if (in == NULL)
        return message_fail(EXIT_CODE_INPUT, NULL, "cannot open %s: %s", name, strerror(errno));
    return read_job_from(s, in, name);
}

/* ---- Options ---- */

static enum exit_code set_images(submission *s, const submission_options *o) {
    shear_error err = {0};
    if (part_input_init(&s->parts, &o->parts, true, &err) != 0)
        return message_error(&err);
    sheard_source_set(&s->params.submit.source, &s->parts.input);
    return EXIT_CODE_DONE;
}

static enum exit_code set_file(submission *s, const char *name, const submission_options *o) {
    shear_error err = {0};
    shear_input input = shear_input_of_file(NULL);
    if (input_path_absolute(name, &s->path, &err) != 0)
        return message_error(&err);
    input.path = s->path;
    input.mosaic = o->parts.mosaic;
    sheard_source_set(&s->params.submit.source, &input);
    return EXIT_CODE_DONE;
}

/* Return the line of `text` (canonical settings, or NULL) for `name`, including its \n; or NULL. */
static const char *find_line(const char *text, const char *name) {
    const size_t n = strlen(name);
    while (text != NULL && *text != '\0') {
        if (strncmp(text, name, n) == 0 && text[n] == '=')
            return text;
        const char *end = strchr(text, '\n');
        text = end != NULL ? end + 1 : NULL;
    }
    return NULL;
}

/* Combine the options' settings with those of the job file that no option overrides. */
static void set_settings(submission *s, const option_settings *ours) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    for (size_t i = 0; i < n && i < SETTINGS_OPTIONS_MAX; i++) {
        char value[64];
        const char *line = find_line(s->parsed.settings, table[i].name);
        if (ours->given[i]) {
            shear_settings_format(&ours->values, &table[i], value, sizeof value);
            text_append(s->settings, sizeof s->settings, "%s=%s\n", table[i].name, value);
        } else if (line != NULL) {
            text_append(s->settings, sizeof s->settings, "%.*s\n", (int)strcspn(line, "\n"), line);
        }
    }
    s->params.submit.settings = s->settings[0] != '\0' ? s->settings : NULL;
}

static void set_options(submission *s, const submission_options *o) {
    sheard_msg_submit *m = &s->params.submit;
    m->field = o->field != NULL ? o->field : m->field;
    m->key = o->key != NULL ? o->key : m->key;
    m->priority = o->has_priority ? o->priority : m->priority;
    m->force = m->force || o->force;
    m->wait = false; /* the client waits by separate requests, to show progress */
    set_settings(s, &o->settings);
}

static bool is_job_file(const char *name) {
    const size_t n = strlen(name);
    return strcmp(name, "-") == 0 || (n > 5 && strcmp(name + n - 5, ".json") == 0);
}

static enum exit_code set_source(submission *s, const char *name, const submission_options *o) {
    if (name == NULL)
        return set_images(s, o);
    if (!is_job_file(name))
        return set_file(s, name, o);
    const enum exit_code code = read_job_file(s, name);
    s->params.submit = s->parsed; /* owns the strings */
    return code;
}

enum exit_code submission_init(submission *s, const char *name, const submission_options *o) {
    *s = (submission){0};
    sheard_params_init(&s->params, SHEARD_METHOD_SUBMIT);
    TRY(set_source(s, name, o));
    set_options(s, o);
    return EXIT_CODE_DONE;
}

void submission_deinit(submission *s) {
    sheard_submit_deinit(&s->parsed);
    part_input_deinit(&s->parts);
    free(s->path);
}
