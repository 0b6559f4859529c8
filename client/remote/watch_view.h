/* SPDX-License-Identifier: GPL-3.0-or-later */
/* watch_view.h: a snapshot of the service for `shearctl watch`: the requests for it, and its
 * output. */
#pragma once

#include "remote/service.h"

#include <stdio.h>

enum { WATCH_STATUS, WATCH_ACTIVE, WATCH_FINISHED, WATCH_FIELDS, WATCH_PARTS = WATCH_FIELDS + 12 };

/* A request and its reply. */
typedef struct watch_part {
    int method;
    const char *field; /* of the request, or NULL; a string of another part */
    sheard_reply reply;
    char *text; /* the reply as received, with service.json */
} watch_part;

typedef struct watch_view {
    watch_part parts[WATCH_PARTS]; /* [n]; from WATCH_FIELDS on, the fields of the preceding jobs */
    size_t n;
} watch_view;

/* Request a snapshot from the service; nothing is printed on errors. Call watch_view_deinit in
 * either case. */
enum connection_status watch_view_init(watch_view *view, service *s, int64_t n_jobs,
                                       sheard_rpc_error *error);
void watch_view_deinit(watch_view *view);

/* Print it, with or without colours. Returns an exit code. */
enum exit_code watch_view_print(const watch_view *view, FILE *out, bool colours);
/* Print one JSON object on one line: status, active, finished, fields. */
void watch_view_json(const watch_view *view, FILE *out);
