/* SPDX-License-Identifier: GPL-3.0-or-later */
/* submission.h: the requests of `shearctl submit`, built from the command line and job files. */
#pragma once

#include "cmdline/part_options.h"
#include "sheard/rpc.h"

#include <stdbool.h>

/* The command line options. Strings point into argv. */
typedef struct submission_options {
    part_options parts;
    const char *field, *key;
    int64_t priority;
    bool has_priority, force;
    option_settings settings;
} submission_options;

/* One submit request, and the memory for its strings. */
typedef struct submission {
    sheard_params params;     /* .submit, the request */
    sheard_msg_submit parsed; /* from a job file */
    char *path;               /* of a field file, owned */
    part_input parts;
    char settings[SHEARD_MSG_SETTINGS_SIZE];
} submission;

/* Build the request for `name`: a field file, a job file (*.json), "-" (a job file on standard
 * input) or NULL (the parts in the options). Options override the job file. Returns an exit code;
 * on failure an error has been printed. Call submission_deinit in either case. */
enum exit_code submission_init(submission *s, const char *name, const submission_options *o);
void submission_deinit(submission *s);
