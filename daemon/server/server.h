/* SPDX-License-Identifier: GPL-3.0-or-later */
/* server/server.h: the Unix stream socket that clients talk to. It turns bytes into requests and
 * replies into bytes (docs/protocol.md); what a request means is the owner's business. It knows no
 * SQL and no engine.
 *
 * Threads: every function here and every callback is called by one thread, the loop's. Work on a
 * connection that a call causes (writing, reading on, closing) is done in a later iteration of the
 * loop, so any function may be called from any callback.
 *
 * Time is given in slices of `slice_us`, after which the loop looks at its other events. In a
 * slice, the user (uid) who has had the least time lately comes first, then that user's connection
 * that has had the least: each has one request, or one step of the work of one (server_defer), done
 * at a time. So whoever asks for little is answered at once, whatever the others ask for. */
/* clang-format off */
/* What a client may do to the others is bounded:
 *   unread replies  a connection is not read from, and what it asked is not begun, before all that
 *                   was sent to it is in the socket's buffer. All connections together have
 *                   `unsent_bytes` for what is not, each user at most half: where that is used up,
 *                   deferred work waits, a connection has one request at a time, and one that has
 *                   taken nothing for `crowded_ms` is dropped
 *   work            one connection of a user has its deferred work done at a time, in the order in
 *                   which they came; the work of a client that has gone is dropped
 *   requests        a connection with `in_flight` short requests unanswered is not read from until
 *                   one is answered. Long ones (wait, submit with wait) have the same limit of
 *                   their own, beyond which they are refused with too_many_requests: they may last
 *                   for hours, and a client must be able to cancel what it waits for
 *   notifications   beyond SERVER_NOTICE_BYTES or SERVER_NOTICES that a client has not read, or a
 *                   quarter of `unsent_bytes` that nobody has read, they are left out, and `lost`
 *                   tells how many when the client reads again
 *   connections     `connections` in all, `user_connections` of a user; the last
 *                   `reserved_connections` are for administrators, who have no limit of their own
 *   silence         neither requests, subscriptions nor unread replies, or in the middle of a line,
 *                   for `idle_timeout_ms`: error idle_timeout, and the end
 *   not reading     nothing taken of what is queued for `stall_timeout_ms`, or more than
 *                   `queue_bytes` of it: the client is dropped
 *   a long line     error line_too_long, and the end: what follows it cannot be trusted
 * Any other malformed line is answered with its error, and the connection goes on. A client that
 * shuts down its writing side still gets its replies and notifications. */
/* clang-format on */
#ifndef SHEARD_SERVER_H
#define SHEARD_SERVER_H

#include "access/access.h"
#include "sheard/rpc.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>
#include <uv.h>

typedef struct server server;

/* Bounds of the notifications that one client has not read. */
enum { SERVER_NOTICES = 4096, SERVER_NOTICE_BYTES = 2 << 20 };

/* A connection's number is never used again, and never 0. */
typedef struct server_handle {
    uint64_t connection;
    uint64_t request; /* of that connection, from 1 */
} server_handle;

typedef struct server_request {
    server_handle handle; /* to reply with, at any time */
    /* As of its connect; valid until `closed` was called for the connection. */
    const access_peer *peer;
    /* Freed when the handler returns, unless the handler has copied the struct and zeroed it: then
     * the copy is the owner's to deinit. */
    sheard_request *request;
} server_request;

typedef struct server_handlers {
    /* A request of a known method with good parameters. Reply once, now or later. */
    void (*request)(void *context, const server_request *request);
    /* The connection is gone, with all its requests and subscriptions. May be NULL. */
    void (*closed)(void *context, uint64_t connection);
    /* Is the peer an administrator? NULL: nobody is. */
    bool (*is_admin)(void *context, const access_peer *peer);
    void *context;
} server_handlers;

/* 0 (or NULL) in any of them: as server_limits_init says, but for the times in ms: never. */
typedef struct server_limits {
    size_t line_bytes;           /* not above sheard_rpc_request_limits.line */
    size_t connections;          /* beyond: error too_many_connections, and the end */
    size_t user_connections;     /* of a user that is no administrator */
    size_t reserved_connections; /* of `connections`, for administrators; at most a quarter */
    size_t in_flight;            /* requests of a connection, short and long ones each */
    size_t subscriptions;        /* jobs and fields subscriptions by a connection */
    size_t queue_bytes;          /* of a connection; one more reply may lie above it */
    size_t unsent_bytes;         /* of all */
    size_t slice_us;             /* the last thing that is begun may take longer */
    int64_t idle_timeout_ms;     /* 0: never */
    int64_t stall_timeout_ms;    /* 0: never */
    int64_t crowded_ms;          /* 0: never */
} server_limits;
/* 64 KiB, 2048, a quarter of `connections`, 16, 64, 1024, 32 MiB, 64 MiB, 3 ms, 10 min, 1 min,
 * 5 s. */
void server_limits_init(server_limits *limits);

typedef struct server_options {
    const char *path;  /* of the socket; at most 107 bytes */
    unsigned mode;     /* its permissions, such as 0660: exactly, whatever the umask */
    const char *group; /* its group's name; NULL or "": the process's own */
    const int *fds;    /* [n_fds] listening sockets (server_activation); then the three above are
                        * not used. They are the server's from the call on, also when it fails */
    size_t n_fds;
    server_limits limits;
    const shear_settings *defaults; /* of a submit's settings; copied; or NULL */
    server_handlers handlers;
} server_options;

/* Listen. SHEAR_E_EXISTS: the path belongs to a living server, or to something that is no socket
 * of ours: it is left alone. The socket file of a server that has died is replaced. Beside the path
 * there is "PATH.lock" while the server lives.
 * From here on the process ignores SIGPIPE. On success the server is freed by server_close; on
 * failure by the loop, which must run once more. */
int server_open(server **out, uv_loop_t *loop, const server_options *options, shear_error *err);

/* Listening sockets that systemd passes (LISTEN_PID, LISTEN_FDS), into fds[capacity]; *n is their
 * number. The variables are removed from the environment. */
int server_activation(int *fds, size_t capacity, size_t *n, shear_error *err);

/* The paths of the sockets that it listens on, joined by ", ", into out[size]. */
void server_sockets(const server *s, char *out, size_t size);

/* After a reload. A new limit of connections or lines counts for connections to come. */
void server_set_limits(server *s, const server_limits *limits);
void server_set_defaults(server *s, const shear_settings *defaults);

/* ---- replies ---- */

/* The reply of the handle's method. Nothing happens where the connection is gone or the request
 * has been answered. */
void server_reply(server *s, server_handle to, const sheard_reply *reply);
void server_reply_error(server *s, server_handle to, const sheard_rpc_error *error);
/* A line of sheard_reply_line or sheard_error_line, made elsewhere with the request's own id; taken
 * over, also when nothing happens. NULL: error out_of_memory. */
void server_reply_line(server *s, server_handle to, char *line, size_t n);
/* Is somebody still waiting for it? */
bool server_is_open(const server *s, server_handle handle);

/* ---- work that takes longer than a request may ---- */

enum server_step { SERVER_MORE, SERVER_PAUSE };

typedef struct server_work {
    /* A step: a millisecond or so, at most a few. The request is answered in one of them: what is
     * returned then does not matter. Else SERVER_MORE: soon again. SERVER_PAUSE: not before
     * server_wake, and the connection's next request may be begun. */
    enum server_step (*step)(void *context);
    /* The request has been answered, or nobody waits for it any more. Never called in a step. */
    void (*drop)(void *context);
    void *context;
} server_work;

/* Have the request's work done in its user's share of the time. False (the request has been
 * answered, or the connection is gone): `drop` was called. */
bool server_defer(server *s, server_handle to, const server_work *work);
/* The work may go on now. Nothing happens where it is gone. */
void server_wake(server *s, server_handle to);

/* ---- subscriptions ---- */

/* Add to (take away from) what the connection watches, all of it or, on an error, nothing:
 * SHEARD_RPC_TOO_MANY_SUBSCRIPTIONS, SHEARD_RPC_OUT_OF_MEMORY. *now may be NULL. */
int server_subscribe(server *s, uint64_t connection, const sheard_msg_subscribe *what,
                     sheard_msg_subscribed *now, sheard_rpc_error *error);
int server_unsubscribe(server *s, uint64_t connection, const sheard_msg_subscribe *what,
                       sheard_msg_subscribed *now, sheard_rpc_error *error);
/* Does anybody watch it? To save the work of making a notification. */
bool server_is_watched(const server *s, enum sheard_notice notice, int64_t job, const char *field);
/* Send to all that watch `job` (0: none), `field` (NULL: none) or everything. job_progress goes
 * only to those who asked for progress, server_state to everybody with a subscription. */
void server_publish(server *s, enum sheard_notice notice, int64_t job, const char *field,
                    const sheard_notice_params *params);

/* The job is final: subscriptions to it by its number end. */
void server_end_job(server *s, int64_t job);

/* ---- the end ---- */

/* No new connections; those that are go on. The socket file is removed. */
void server_stop_accepting(server *s);
/* Stop accepting and reading, answer open requests with error `stopping`, write what is queued for
 * at most flush_ms, close everything, call `done` (may be NULL), free the server. Until `done`, the
 * other functions may be called; this one once more shortens the time, and no more than that. */
void server_close(server *s, int64_t flush_ms, void (*done)(void *context), void *context);

/* ---- numbers ---- */

/* Since the start, but for the first four. */
typedef struct server_statistics {
    uint64_t connections, subscribers, queued_bytes; /* now; each text counted for each client */
    uint64_t unsent_bytes;                           /* now; memory that texts take */
    uint64_t accepted, refused;
    uint64_t dropped;  /* clients that did not read */
    uint64_t timeouts; /* idle */
    uint64_t lines;
    uint64_t requests[SHEARD_N_METHODS];
    uint64_t errors[SHEARD_N_RPC_CODES]; /* error replies (not those of server_reply_line) */
    uint64_t bytes_in, bytes_out;
    uint64_t notices, lost;
} server_statistics;
void server_get_statistics(const server *s, server_statistics *statistics);

#endif
