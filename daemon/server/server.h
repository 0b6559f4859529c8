/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/server.h: the Unix stream socket for clients: it parses bytes into requests and formats
 * replies (docs/protocol.md). The owner acts on the requests. The server uses neither the store nor
 * the engine.
 *
 * Threads: all functions and callbacks run in one thread, the loop's. Calls
 * only schedule writing, reading and closing, which the loop does in a later iteration. So any
 * function may be called from any callback.
 *
 * Scheduling: requests are processed in slices of `slice_us`; between them the loop handles its
 * other events. In a slice, the user (uid) charged with the least processor time is next, and of
 * that user's connections the one charged with the least. Each time, one request or one step of
 * deferred work (server_defer) is done. So a client with few requests is answered at once, however
 * many the others have. */
/* clang-format off */
/* Limits on what a client may use:
 *   unread replies  a connection is not read from, and its next request is not begun, before all
 *                   replies to it are in the socket's buffer. Replies that are not may take
 *                   `unsent_bytes` for all connections, and half of that per user. Beyond, deferred
 *                   work waits, a connection has one request at a time, and one that has taken
 *                   nothing for `crowded_ms` is closed
 *   work            per user, the deferred work of one connection at a time is done, in order of
 *                   arrival; the work of a closed connection is dropped
 *   requests        a connection with `in_flight` unanswered short requests is not read from until
 *                   one is answered. Long ones (wait, submit with wait) may last for hours, and the
 *                   client must be able to cancel them; so they have the same limit apart, and are
 *                   refused with too_many_requests beyond it
 *   notifications   beyond SERVER_NOTICE_BYTES or SERVER_NOTICES that a client has not read, or a
 *                   quarter of `unsent_bytes` unread by all, notifications are left out; a
 *                   notification `lost` has their number once the client reads again
 *   connections     `connections` in all, `user_connections` per user; the last
 *                   `reserved_connections` are for administrators, who have no limit per user
 *   idleness        a connection without requests, subscriptions and unread replies, or in the
 *                   middle of a line, for `idle_timeout_ms`: error idle_timeout, then closed
 *   not reading     a client that has taken nothing of its queue for `stall_timeout_ms`, or has
 *                   more than `queue_bytes` queued, is closed
 *   long lines      error line_too_long, then closed: what follows cannot be interpreted
 * Any other malformed line is answered with its error, and the connection stays open. A client that
 * shuts down its writing side still gets its replies and notifications. */
/* clang-format on */
#pragma once

#include "access/access.h"
#include "sheard/rpc.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>
#include <uv.h>

typedef struct server server;

/* Limits of the notifications that one client has not read. */
enum { SERVER_NOTICES = 4096, SERVER_NOTICE_BYTES = 2 << 20 };

/* Identifies a request. A connection's number is never used again, and never 0. */
typedef struct server_handle {
    uint64_t connection;
    uint64_t request; /* of that connection, from 1 */
} server_handle;

typedef struct server_request {
    server_handle handle; /* to reply with, at any time */
    /* The client, as of its connect; valid until `closed` was called for the connection. */
    const access_peer *peer;
    /* Freed when the handler returns. To keep it, copy the struct and zero the original: the owner
     * then calls sheard_request_deinit on the copy. */
    sheard_request *request;
} server_request;

typedef struct server_handlers {
    /* Handle a request of a known method with valid parameters. Reply once, now or later. */
    void (*request)(void *context, const server_request *request);
    /* The connection is gone, with all its requests and subscriptions. May be NULL. */
    void (*closed)(void *context, uint64_t connection);
    /* Return whether the peer is an administrator. NULL: nobody is. */
    bool (*is_admin)(void *context, const access_peer *peer);
    void *context;
} server_handlers;

/* Limits of the server, none of them 0 but those that say so. */
typedef struct server_limits {
    size_t line_bytes;           /* at most sheard_rpc_request_limits.line */
    size_t connections;          /* of all users; one more is refused and closed */
    size_t user_connections;     /* of a user that is not an administrator; 0: a quarter */
    size_t reserved_connections; /* of `connections`, for administrators; at most a quarter */
    size_t in_flight; /* unanswered requests of a connection, short and long ones counted apart */
    size_t subscriptions;     /* jobs and fields that a connection may watch */
    size_t queue_bytes;       /* of a connection; one more reply may exceed it */
    size_t unsent_bytes;      /* of all connections */
    size_t slice_us;          /* length of a slice; the last request begun may exceed it */
    int64_t idle_timeout_ms;  /* 0: never */
    int64_t stall_timeout_ms; /* 0: never */
    int64_t crowded_ms;       /* 0: never */
} server_limits;
/* Set the defaults: 64 KiB, 2048, a quarter of `connections`, 16, 64, 1024, 32 MiB, 64 MiB, 3 ms,
 * 10 min, 1 min, 5 s. */
void server_limits_init(server_limits *limits);

typedef struct server_options {
    const char *path;  /* of the socket; at most 107 bytes */
    unsigned mode;     /* of the socket file, such as 0660: exactly, whatever the umask */
    const char *group; /* the socket file's group; NULL or "": the process's own */
    const int *fds; /* [n_fds] listening sockets (server_activation); `path`, `mode` and `group` are
                       then not used. The server closes them, also if the call fails */
    size_t n_fds;
    server_limits limits;
    const shear_settings *defaults; /* defaults of a submit's settings; copied; may be NULL */
    server_handlers handlers;
} server_options;

/* Create a server, and listen. SHEAR_E_EXISTS means that another process listens at the path, or
 * that the path is not a socket of this user; it is left alone then. The socket file of a server
 * that has died is replaced. The file "PATH.lock" exists while the server lives. From this call on
 * the process ignores SIGPIPE. On success the server is freed by server_close; on failure it is
 * freed by the loop, which must run once more. */
int server_open(server **out, uv_loop_t *loop, const server_options *options, shear_error *err);

/* Store the listening sockets that systemd passes (LISTEN_PID, LISTEN_FDS) into fds[capacity], and
 * their number into *n. The variables are removed from the environment. */
int server_activation(int *fds, size_t capacity, size_t *n, shear_error *err);

/* Write the paths of the listening sockets, joined by ", ", into out[size]. */
void server_sockets(const server *s, char *out, size_t size);

/* Change the limits. New limits of connections and line lengths apply to later connections. */
void server_set_limits(server *s, const server_limits *limits);
/* Change the defaults of a submit's settings (copied); NULL: none. */
void server_set_defaults(server *s, const shear_settings *defaults);

/* ---- replies ---- */

/* Send the reply to a request. Nothing happens if the connection is gone or the request has been
 * answered. */
void server_reply(server *s, server_handle to, const sheard_reply *reply);
void server_reply_error(server *s, server_handle to, const sheard_rpc_error *error);
/* Send a line of sheard_reply_line or sheard_error_line that has the request's own id. `line` is
 * taken over in any case; NULL sends the error out_of_memory. */
void server_reply_line(server *s, server_handle to, char *line, size_t n);

/* ---- deferred work, for requests that take long ---- */

enum server_step { SERVER_MORE, SERVER_PAUSE };

typedef struct server_work {
    /* Do one step, of a millisecond or so. If the request is answered in it, the return value does
     * not matter. SERVER_MORE: call again soon. SERVER_PAUSE: call again only after server_wake;
     * the connection's next request may be begun meanwhile. */
    enum server_step (*step)(void *context);
    /* Free the work: the request has been answered, or its connection is gone. Never called within
     * a step. */
    void (*drop)(void *context);
    void *context;
} server_work;

/* Have the request's work done in its user's share of the time. Return false if the request has
 * been answered or the connection is gone: `drop` was called. */
bool server_defer(server *s, server_handle to, const server_work *work);
/* Resume paused work. Nothing happens if it is gone. */
void server_wake(server *s, server_handle to);

/* ---- subscriptions ---- */

/* Add to, or remove from, what the connection watches. On an error
 * (SHEARD_RPC_TOO_MANY_SUBSCRIPTIONS, SHEARD_RPC_OUT_OF_MEMORY, or SHEARD_RPC_STOPPING if the
 * connection is gone) nothing changes. *now receives the totals; it may be NULL. */
int server_subscribe(server *s, uint64_t connection, const sheard_msg_subscribe *what,
                     sheard_msg_subscribed *now, sheard_rpc_error *error);
int server_unsubscribe(server *s, uint64_t connection, const sheard_msg_subscribe *what,
                       sheard_msg_subscribed *now, sheard_rpc_error *error);
/* Return whether any connection watches it. If none does, the notification need not be made. */
bool server_is_watched(const server *s, enum sheard_notice notice, int64_t job, const char *field);
/* Send a notification to all that watch `job` (0: none), `field` (NULL: none) or everything.
 * job_progress goes only to those who subscribed to progress, server_state to everybody with a
 * subscription. */
void server_publish(server *s, enum sheard_notice notice, int64_t job, const char *field,
                    const sheard_notice_params *params);

/* End the subscriptions to a finished job by its number. */
void server_end_job(server *s, int64_t job);

/* ---- closing ---- */

/* Accept no more connections, and remove the socket file. Open connections go on. */
void server_stop_accepting(server *s);
/* Stop accepting and reading, answer open requests with the error `stopping`, write what is queued
 * for at most flush_ms, close everything, call `done` (may be NULL) and free the server. The other
 * functions may be called until `done`. A second call of this one can only shorten the time. */
void server_close(server *s, int64_t flush_ms, void (*done)(void *context), void *context);

/* ---- statistics ---- */

/* Counters since the start, except for the first four. */
typedef struct server_statistics {
    uint64_t connections, subscribers, queued_bytes; /* now; a notification counts per client */
    uint64_t unsent_bytes;                           /* now; memory of replies and notifications */
    uint64_t accepted, refused;
    uint64_t dropped;  /* connections closed because the client did not read */
    uint64_t timeouts; /* idle connections closed */
    uint64_t lines;
    uint64_t requests[SHEARD_N_METHODS];
    uint64_t errors[SHEARD_N_RPC_CODES]; /* error replies, without those of server_reply_line */
    uint64_t bytes_in, bytes_out;
    uint64_t notices, lost;
} server_statistics;
void server_get_statistics(const server *s, server_statistics *statistics);
