/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages that are not lines: job files, sources as the store keeps them, the files beside inputs.
 */
#include "rpc/envelope.h"
#include "rpc/methods.h"
#include "json/dump.h"

#include <string.h>

static int not_object(sheard_rpc_error *error, const char *what) {
    return sheard_rpc_fail(error, SHEARD_RPC_BAD_PARAMETER, NULL, "%s must be one object", what);
}

int sheard_job_file_parse(sheard_msg_submit *submit, const char *text, size_t n,
                          const shear_settings *defaults, sheard_rpc_error *error) {
    *error = (sheard_rpc_error){.code = SHEARD_RPC_OK};
    memset(submit, 0, sizeof *submit);
    sheard_rpc_limits limits = sheard_rpc_request_limits;
    limits.line = SHEARD_MSG_JOB_FILE_MAX;
    json_t *root = rpc_read_line(text, n, &limits, NULL, error);
    int rc = error->code;
    if (root != NULL) {
        rc = json_is_object(root) ? rpc_read_submit(submit, root, defaults, error)
                                  : not_object(error, "a job file");
    }
    json_decref(root);
    return rc;
}

void sheard_submit_deinit(sheard_msg_submit *submit) {
    msg_deinit(submit, &msg_submit);
}

/* In *text, malloc'd. Takes the reference. */
static int dump(char **text, json_t *object, size_t flags, const char *tail,
                sheard_rpc_error *error) {
    *text = rpc_dump(object, flags, tail, NULL);
    json_decref(object);
    return *text != NULL ? SHEARD_RPC_OK : rpc_no_memory(error);
}

int sheard_source_text(char **text, const sheard_msg_source *source, sheard_rpc_error *error) {
    *text = NULL;
    json_t *object = msg_write(source, &msg_source, MSG_SPARSE, error);
    return object != NULL ? dump(text, object, 0, "", error) : error->code;
}

static int parse(void *message, const msg_table *table, unsigned mode, const char *text, size_t n,
                 sheard_rpc_error *error) {
    *error = (sheard_rpc_error){.code = SHEARD_RPC_OK};
    memset(message, 0, table->size);
    json_t *root = rpc_read_line(text, n, &sheard_rpc_reply_limits, NULL, error);
    int rc = error->code;
    if (root != NULL) {
        rc = json_is_object(root) ? msg_read(message, table, root, mode, error)
                                  : not_object(error, "this text");
    }
    json_decref(root);
    return rc;
}

int sheard_source_parse(sheard_msg_source *source, const char *text, sheard_rpc_error *error) {
    return parse(source, &msg_source, MSG_STRICT, text, strlen(text), error);
}

void sheard_source_deinit(sheard_msg_source *source) {
    msg_deinit(source, &msg_source);
}

int sheard_side_text(char **text, const sheard_msg_side *side, sheard_rpc_error *error) {
    *text = NULL;
    json_t *object = msg_write(side, &msg_side, 0, error);
    return object != NULL ? dump(text, object, JSON_INDENT(2), "\n", error) : error->code;
}

int sheard_side_parse(sheard_msg_side *side, const char *text, size_t n, sheard_rpc_error *error) {
    return parse(side, &msg_side, 0, text, n, error);
}

void sheard_side_deinit(sheard_msg_side *side) {
    msg_deinit(side, &msg_side);
}
