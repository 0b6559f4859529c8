/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reader/exchange.h"

#include "base/cleanup.h"
#include "base/clock.h"
#include "reader/child_process.h"
#include "reader/child_stderr.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <sys/socket.h>

/* ---- failures of the child itself ---- */

/* Return the recorded failure. */
static int fail_again(const reader *r, shear_error *err) {
    if (err != NULL)
        *err = r->failure;
    return r->failed;
}

/* Describe the failure in why[]. Return the code to record. */
static int find_reason(reader *r, int code, char *why, size_t size) {
    char end[160] = "it is gone";
    char said[240] = "";
    const int exit_code = child_process_reap(&r->pid, code != READER_E_DIED, end, sizeof end);
    child_stderr_read(r->child_stderr, said, sizeof said);
    snprintf(why, size, "%s%s%s",
             code == READER_E_HUNG       ? "no answer in time, it was stopped"
             : code == READER_E_STOPPED  ? "no answer yet when it was to stop"
             : code == READER_E_PROTOCOL ? "its answer made no sense, it was stopped"
                                         : end,
             said[0] != '\0' ? "; it said: " : "", said);
    /* The exit codes of the dynamic linker, or of a shell, for a program that did not start. */
    const bool never_started = exit_code == 126 || exit_code == 127;
    return code == READER_E_DIED && never_started ? SHEAR_E_IO : code;
}

int exchange_give_up(reader *r, int code, const char *what, shear_error *err) {
    char why[420];
    r->failed = find_reason(r, code, why, sizeof why);
    shear_fail(&r->failure, r->failed,
               r->failed == SHEAR_E_IO
                   ? "install sheard again, with the libraries that it needs"
                   : "the file is damaged in a way that CFITSIO does not survive, or the limits in "
                     "section [reader] are too small for it",
               "the reader failed to %s: %s", what, why);
    return fail_again(r, err);
}

/* ---- requests and replies ---- */

bool exchange_is_stopping(const reader *r) {
    return r->stop != NULL && atomic_load(r->stop);
}

/* Wait for a reply. Return SHEAR_OK if there is something to receive, READER_E_HUNG,
 * READER_E_STOPPED, or, with *err filled, the code of scratch_check if the unpacked copies take too
 * much room. */
static int wait_for_answer(reader *r, shear_error *err) {
    enum { LOOK_MS = 50, GRACE_MS = 700 };
    struct pollfd p = {.fd = r->socket, .events = POLLIN};
    int64_t end_ms = clock_ms(CLOCK_MONOTONIC) + r->timeout_ms;
    bool stopping = false;
    for (;;) {
        const int64_t left_ms = end_ms - clock_ms(CLOCK_MONOTONIC);
        const int ready = poll(&p, 1,
                               (int)(left_ms < 0         ? 0
                                     : left_ms < LOOK_MS ? left_ms
                                                         : LOOK_MS));
        if (ready > 0 || (ready < 0 && errno != EINTR)) {
            return SHEAR_OK; /* recv reports the error, if there is one */
        }
        TRY(scratch_check(&r->scratch, false, err));
        if (ready == 0 && left_ms <= LOOK_MS)
            return stopping ? READER_E_STOPPED : READER_E_HUNG;
        if (!stopping && exchange_is_stopping(r)) {
            stopping = true;
            end_ms = end_ms < clock_ms(CLOCK_MONOTONIC) + GRACE_MS
                         ? end_ms
                         : clock_ms(CLOCK_MONOTONIC) + GRACE_MS;
        }
    }
}

/* Return the error that the child reports. Its lack of memory has a code apart from that of the
 * daemon's. */
static int failed_answer(const reader_reply *reply, shear_error *err) {
    const bool memory = reply->code == SHEAR_E_NOMEM;
    const int code = memory ? READER_E_MEMORY : reply->code;
    if (err != NULL) {
        *err = reply->error;
        err->code = code;
        if (memory && err->advice[0] == '\0')
            snprintf(err->advice, sizeof err->advice, "allow the reader more ([reader] memory)");
    }
    return code;
}

/* Receive without waiting. The message of a child that has ended comes after the error of its end,
 * so it takes a second call. */
static ssize_t receive(const reader *r, reader_reply *reply) {
    ssize_t got = recv(r->socket, reply, sizeof *reply, MSG_DONTWAIT);
    if (got < 0 && (errno == ECONNRESET || errno == EPIPE))
        got = recv(r->socket, reply, sizeof *reply, MSG_DONTWAIT);
    return got;
}

/* Kill the child: its unpacked copies are too large, or others need the room. Return the error
 * `why`. */
static int evict(reader *r, const shear_error *why, shear_error *err) {
    child_process_reap(&r->pid, true, NULL, 0);
    r->failure = *why;
    r->failed = why->code;
    return fail_again(r, err);
}

static bool is_reply_to(const reader_request *request, const reader_reply *reply, ssize_t size) {
    return size == (ssize_t)sizeof *reply && reply->version == READER_WIRE_VERSION &&
           reply->op == request->op && reply->code >= 0 && reply->code <= SHEAR_E_FULL;
}

/* Send the request and receive its reply, or record a failure. */
static int converse(reader *r, const reader_request *request, const char *what, reader_reply *reply,
                    shear_error *err) {
    shear_error why;
    reader_request sent = *request;
    sent.version = READER_WIRE_VERSION;
    if (send(r->socket, &sent, sizeof sent, MSG_NOSIGNAL) == (ssize_t)sizeof sent) {
        const int waited = wait_for_answer(r, &why);
        if (waited == SHEAR_E_FULL || waited == SHEAR_E_FORMAT)
            return evict(r, &why, err);
        if (waited != SHEAR_OK)
            return exchange_give_up(r, waited, what, err);
    }
    const ssize_t got = receive(r, reply);
    if (got <= 0)
        return exchange_give_up(r, READER_E_DIED, what, err);
    if (!is_reply_to(request, reply, got))
        return exchange_give_up(r, READER_E_PROTOCOL, what, err);
    reply->error.message[sizeof reply->error.message - 1] = '\0';
    reply->error.advice[sizeof reply->error.advice - 1] = '\0';
    return SHEAR_OK;
}

int exchange_ask(reader *r, const reader_request *request, const char *what, reader_reply *reply,
                 shear_error *err) {
    shear_error why;
    *reply = (reader_reply){.code = SHEAR_E_INTERNAL};
    if (r->failed != 0)
        return fail_again(r, err);
    TRY(converse(r, request, what, reply, err));
    const bool full = reply->code == SHEAR_E_FULL;
    const int kept = scratch_check(&r->scratch, full, &why);
    if (kept != SHEAR_OK && (full || reply->code == SHEAR_OK || kept == SHEAR_E_FORMAT)) {
        return evict(r, &why, err); /* a file that can never fit is the cause of any error */
    }
    return reply->code == SHEAR_OK ? SHEAR_OK : failed_answer(reply, err);
}
