/* SPDX-License-Identifier: GPL-3.0-or-later */
/* submission.h: what `shearctl submit` sends, made from the command line and job files. */
#ifndef CLIENT_REMOTE_SUBMISSION_H
#define CLIENT_REMOTE_SUBMISSION_H

#include "cmdline/part_options.h"
#include "sheard/rpc.h"

#include <stdbool.h>

/* What the options say. Texts point into argv. */
typedef struct submission_options {
    part_options parts;
    const char *field, *key;
    int64_t priority;
    bool has_priority, force;
    option_settings settings;
} submission_options;

/* One submit request, and what its texts are kept in. */
typedef struct submission {
    sheard_params params;     /* .submit, to be sent */
    sheard_msg_submit parsed; /* of a job file */
    char *path;               /* of a field file */
    part_input parts;
    char settings[SHEARD_MSG_SETTINGS_SIZE];
} submission;

/* From `name`: a field file, a job file (*.json), "-" (a job file on standard input) or NULL (the
 * images of the options). Options beat what a job file says. Returns an exit code, with an error
 * printed; deinit *s either way. */
enum exit_code submission_init(submission *s, const char *name, const submission_options *o);
void submission_deinit(submission *s);

#endif
