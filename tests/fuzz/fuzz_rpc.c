/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any bytes as what a client or a service may send: neither must crash, leak or contradict itself,
 * whatever they are. The first byte chooses the method of replies and how the rest is cut into
 * pieces. */
#include "fuzz_rpc.h"

#include "sheard/frame.h"
#include "sheard/rpc.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void demand(bool holds, const char *what) {
    if (!holds) {
        fprintf(stderr, "fuzz_rpc: does not hold: %s\n", what);
        abort();
    }
}

/* What was taken can be said, and what was said is taken and said again in the same words. */
static void say_again(const sheard_request *request) {
    char *once = NULL;
    char *twice = NULL;
    size_t n = 0;
    sheard_rpc_error error;
    sheard_request back;
    const int rc =
        sheard_request_line(&once, &n, &request->id, request->method, &request->params, &error);
    demand(rc == SHEARD_RPC_OK || rc == SHEARD_RPC_LINE_TOO_LONG, /* escapes may be longer now */
           "a request that was taken can be written");
    if (rc != SHEARD_RPC_OK)
        return;
    if (sheard_request_parse(&back, once, n - 1, NULL, &error) == SHEARD_RPC_OK) {
        demand(sheard_rpc_id_equal(&back.id, &request->id), "the id stays");
        demand(sheard_request_line(&twice, &n, &back.id, back.method, &back.params, &error) ==
                       SHEARD_RPC_OK &&
                   strcmp(once, twice) == 0,
               "a request is written in the same words again");
    } else {
        demand(error.code == SHEARD_RPC_TOO_COMPLEX, "a request that was written is taken");
    }
    sheard_request_deinit(&back);
    free(once);
    free(twice);
}

static void as_request(const char *line, size_t n) {
    sheard_request request;
    sheard_rpc_error error = {0};
    const int rc = sheard_request_parse(&request, line, n, NULL, &error);
    demand(rc == error.code, "the code returned is the code told");
    demand((rc == SHEARD_RPC_OK) == (request.method >= 0), "an error has no method");
    if (rc == SHEARD_RPC_OK) {
        say_again(&request);
    } else {
        char *answer = NULL;
        size_t length = 0;
        sheard_message heard;
        demand(sheard_error_line(&answer, &length, &request.id, &error) == SHEARD_RPC_OK &&
                   sheard_message_parse(&heard, answer, length - 1, &error) == SHEARD_RPC_OK &&
                   heard.kind == SHEARD_MESSAGE_ERROR && heard.error.code == rc &&
                   sheard_rpc_id_equal(&heard.id, &request.id),
               "an error can be told");
        sheard_message_deinit(&heard);
        free(answer);
    }
    sheard_request_deinit(&request);
}

static void as_reply(const char *line, size_t n, int method) {
    sheard_message message;
    sheard_rpc_error error = {0};
    if (sheard_message_parse(&message, line, n, &error) == SHEARD_RPC_OK &&
        message.kind == SHEARD_MESSAGE_REPLY) {
        sheard_reply reply;
        char *text = NULL;
        if (sheard_message_reply(&message, method, &reply, &error) == SHEARD_RPC_OK) {
            size_t length = 0;
            demand(sheard_reply_line(&text, &length, &message.id, method, &reply, &error) ==
                       SHEARD_RPC_OK,
                   "a reply that was understood can be written");
        }
        free(text);
        sheard_reply_deinit(&reply, method);
    }
    sheard_message_deinit(&message);
}

static void as_files(const char *text, size_t n) {
    sheard_msg_submit submit;
    sheard_msg_side side;
    sheard_rpc_error error;
    (void)sheard_job_file_parse(&submit, text, n, NULL, &error);
    sheard_submit_deinit(&submit);
    (void)sheard_side_parse(&side, text, n, &error);
    sheard_side_deinit(&side);
}

static void as_stream(const char *bytes, size_t n, size_t piece, int method) {
    sheard_frame frame;
    sheard_frame_init(&frame, sheard_rpc_request_limits.line);
    for (size_t at = 0; at < n; at += piece) {
        const char *input = bytes + at;
        size_t left = piece < n - at ? piece : n - at;
        const char *line = NULL;
        size_t length = 0;
        for (enum sheard_frame_event event;
             (event = sheard_frame_next(&frame, &input, &left, &line, &length)) !=
             SHEARD_FRAME_MORE;) {
            if (event == SHEARD_FRAME_LINE) {
                as_request(line, length);
                as_reply(line, length, method);
            }
        }
    }
    sheard_frame_deinit(&frame);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    if (size > 1) {
        const char *text = (const char *)bytes + 1;
        as_stream(text, size - 1, 1u + bytes[0] / 16u * 37u, bytes[0] % SHEARD_N_METHODS);
        as_files(text, size - 1);
    }
    return 0;
}
