/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tests/unit/server_fixture.h: a server in a directory and a loop of its own, and clients that are
 * plain descriptors. Nothing sleeps: whoever waits runs the loop until what it waits for is there.
 */
#pragma once

#include "server/server.h"

enum { FX_REQUESTS = 40000 };

typedef struct fixture {
    char dir[64];
    char path[96];
    uv_loop_t loop;
    server *s;
    server_options options;
    bool hold; /* keep requests; else metrics is answered at once, with reply_bytes of text */
    size_t reply_bytes;
    bool admins;                        /* all clients are administrators */
    server_handle handles[FX_REQUESTS]; /* [n] of all requests, in the order of arrival */
    int methods[FX_REQUESTS];
    size_t n;
    uint64_t closed[FX_REQUESTS]; /* [n_closed] */
    size_t n_closed;
    uid_t peer_uid;
    size_t peer_groups;
    bool done;
} fixture;

/* The directory and the loop, the options of a server on `path`; no server yet. */
void fx_init(fixture *f);
void fx_deinit(fixture *f);
void fx_open(fixture *f);
/* Closes the server and runs the loop until it has gone. */
void fx_close(fixture *f, int64_t flush_ms);
int fx_setup(void **state); /* all of it, and the reverse */
int fx_teardown(void **state);

/* A turn of the loop that does not wait. */
void fx_turn(fixture *f);
/* Turn until `condition`; the test fails after 20 s. */
#define FX_UNTIL(f, condition)                                                                     \
    do {                                                                                           \
        const uint64_t end_ = uv_hrtime() + UINT64_C(20000000000);                                 \
        while (!(condition)) {                                                                     \
            assert_true(uv_hrtime() < end_);                                                       \
            fx_turn(f);                                                                            \
        }                                                                                          \
    } while (0)

server_statistics fx_statistics(const fixture *f);
/* Whether the request is unanswered and its connection open. */
bool fx_is_open(const fixture *f, server_handle handle);

/* ---- clients ---- */

typedef struct client {
    int fd;
    char *text; /* [n] read and not yet given as lines */
    size_t n;
    bool ended;
} client;

void cl_connect(const fixture *f, client *c);
void cl_close(client *c);
/* All of it, with turns where the socket is full. */
void cl_send(fixture *f, client *c, const char *text, size_t n);
void cl_say(fixture *f, client *c, const char *text);
/* As much as goes; the number of bytes. */
size_t cl_push(client *c, const char *text, size_t n);
/* Read what is there. True: there is a line. */
bool cl_has_line(client *c);
/* The next line, with turns until it is there; a message that the caller deinits. */
sheard_message cl_next(fixture *f, client *c);
/* The next line is the error `code`. Its id, or -1 where that is null. */
int64_t cl_error(fixture *f, client *c, int code);
/* The next line is a reply: its id. */
int64_t cl_reply(fixture *f, client *c);
/* The next line is this notification; its number (job, count). */
int64_t cl_notice(fixture *f, client *c, int notice);
/* Nothing more comes, and the other side has closed. */
void cl_ended(fixture *f, client *c);

/* Text of a request, static until the next. */
const char *request_text(int64_t id, const char *method, const char *params);
