/* SPDX-License-Identifier: GPL-3.0-or-later */
/* watch_view.h: a picture of the service at one moment (watch): what is asked for, and how it
 * looks. */
#ifndef CLIENT_REMOTE_WATCH_VIEW_H
#define CLIENT_REMOTE_WATCH_VIEW_H

#include "remote/service.h"

#include <stdio.h>

enum { WATCH_STATUS, WATCH_ACTIVE, WATCH_FINISHED, WATCH_FIELDS, WATCH_PARTS = WATCH_FIELDS + 12 };

/* A question and its answer. */
typedef struct watch_part {
    int method;
    const char *field; /* that it is about, or NULL; a text of another part */
    sheard_reply reply;
    char *text; /* the reply as it came, with service.json */
} watch_part;

typedef struct watch_view {
    watch_part parts[WATCH_PARTS]; /* [n], from WATCH_FIELDS on the fields of the jobs before */
    size_t n;
} watch_view;

/* Ask the service; nothing is printed on errors. Returns an enum connection_status. *view must be
 * deinited either way. */
enum connection_status watch_view_init(watch_view *view, service *s, int64_t n_jobs,
                                       sheard_rpc_error *error);
void watch_view_deinit(watch_view *view);

/* Lines of at most `columns` (0: any), with colours or without. Returns an exit code. */
enum exit_code watch_view_print(const watch_view *view, FILE *out, bool colours, int columns);
/* One JSON object on one line: status, active, finished, fields. */
void watch_view_json(const watch_view *view, FILE *out);

#endif
