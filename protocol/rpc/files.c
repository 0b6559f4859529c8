/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read and write messages that are not lines: job files, sources for the store, and the report
 * files beside inputs. */
#include "message/table.h"
#include "rpc/envelope.h"
#include "rpc/submit.h"

#include <string.h>

int sheard_job_file_parse(sheard_msg_submit *submit, const char *text, size_t n,
                          const shear_settings *defaults, sheard_rpc_error *error) {
    memset(submit, 0, sizeof *submit);
    sheard_rpc_limits limits = sheard_rpc_request_limits;
    limits.line = SHEARD_MSG_JOB_FILE_MAX;
    json_auto_t *root = rpc_read_object(text, n, &limits, "a job file", error);
    return root != NULL ? submit_read(submit, root, defaults, error) : error->code;
}

void sheard_submit_deinit(sheard_msg_submit *submit) {
    msg_deinit(submit, &msg_submit);
}

static int parse(void *message, const msg_table *table, unsigned mode, const char *text, size_t n,
                 sheard_rpc_error *error) {
    memset(message, 0, table->size);
    json_auto_t *root = rpc_read_object(text, n, &sheard_rpc_reply_limits, "this text", error);
    return root != NULL ? msg_read(message, table, root, mode, error) : error->code;
}

int sheard_source_text(char **text, const sheard_msg_source *source, sheard_rpc_error *error) {
    json_t *object = msg_write(source, &msg_source, MSG_SPARSE, error);
    return rpc_write_text(text, NULL, object, 0, "", error);
}

int sheard_source_parse(sheard_msg_source *source, const char *text, sheard_rpc_error *error) {
    return parse(source, &msg_source, MSG_STRICT, text, strlen(text), error);
}

void sheard_source_deinit(sheard_msg_source *source) {
    msg_deinit(source, &msg_source);
}

int sheard_side_text(char **text, const sheard_msg_side *side, sheard_rpc_error *error) {
    json_t *object = msg_write(side, &msg_side, 0, error);
    return rpc_write_text(text, NULL, object, JSON_INDENT(2), "\n", error);
}

int sheard_side_parse(sheard_msg_side *side, const char *text, size_t n, sheard_rpc_error *error) {
    return parse(side, &msg_side, 0, text, n, error);
}

void sheard_side_deinit(sheard_msg_side *side) {
    msg_deinit(side, &msg_side);
}
