/* SPDX-License-Identifier: GPL-3.0-or-later */
/* protocol_probe: what the code knows of the protocol, for protocol/schema.py and
 * tests/system/test_protocol_docs.py.
 *   protocol_probe tables   all codes, methods, notifications and messages, as JSON
 *   protocol_probe check    lines "KIND[ METHOD]<tab>TEXT" from standard input, each answered by
 * "ok" or "CODE: MESSAGE"; KIND is request, reply, error, notification, job-file or side-file */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rpc/methods.h"
#include "json/settings.h"
#include "json/tree.h"

/* ---- tables ---- */

static void print_table(const msg_table *table);

static void print_names(const char *const *names) {
    printf(",\"names\":[");
    for (int i = 0; names[i]; i++)
        printf("%s\"%s\"", i > 0 ? "," : "", names[i]);
    printf("]");
}

static void print_member(const msg_member *m) {
    static const char *const types[] = {
        [MSG_BOOL] = "bool",       [MSG_INT] = "int",           [MSG_REAL] = "real",
        [MSG_TEXT] = "text",       [MSG_NAME] = "name",         [MSG_TIME] = "time",
        [MSG_RAW] = "raw",         [MSG_SETTINGS] = "settings", [MSG_STATES] = "states",
        [MSG_INTS] = "ints",       [MSG_TEXTS] = "texts",       [MSG_OBJECT] = "object",
        [MSG_OBJECTS] = "objects", [MSG_MERGED] = "merged",
    };
    printf("{\"name\":\"%s\",\"type\":\"%s\",\"required\":%s,\"nullable\":%s,\"plain\":%s,"
           "\"absolute\":%s,\"min\":%" PRId64 ",\"max\":%" PRId64 ",\"item_max\":%" PRId64
           ",\"fallback\":%" PRId64,
           m->name, types[m->type], m->flags & MSG_REQUIRED ? "true" : "false",
           m->flags & MSG_NULLABLE ? "true" : "false", m->flags & MSG_PLAIN ? "true" : "false",
           m->flags & MSG_ABSOLUTE ? "true" : "false", m->min, m->max, m->item_max, m->fallback);
    if (m->names != NULL)
        print_names(m->names);
    if (m->table != NULL) {
        printf(",\"table\":\"%s\",\"members\":", m->table->name);
        print_table(m->table);
    }
    printf("}");
}

static void print_table(const msg_table *table) {
    printf("[");
    for (size_t i = 0; i < table->n; i++) {
        printf("%s", i > 0 ? "," : "");
        print_member(&table->members[i]);
    }
    printf("]");
}

static void print_codes(void) {
    printf("{\"codes\":[");
    for (int i = 1; i < SHEARD_N_RPC_CODES; i++) {
        const sheard_rpc_code_info *c = sheard_rpc_code_get(i);
        printf("%s{\"name\":\"%s\",\"number\":%d,\"retry\":%s,\"class\":\"%s\"}", i > 1 ? "," : "",
               c->name, c->number, c->retry ? "true" : "false",
               sheard_job_class_name(c->job_class));
    }
    printf("]");
}

/* Is a request without any refused? */
static bool needs_params(const msg_table *table) {
    sheard_params params;
    sheard_rpc_error error;
    const bool refused = msg_read(&params, table, NULL, MSG_STRICT, &error) != SHEARD_RPC_OK;
    msg_deinit(&params, table);
    return refused;
}

static void print_methods(void) {
    printf(",\"methods\":[");
    for (int i = 0; i < SHEARD_N_METHODS; i++) {
        printf("%s{\"name\":\"%s\",\"admin\":%s,\"needs_params\":%s,\"params\":", i > 0 ? "," : "",
               rpc_methods[i].name, rpc_methods[i].admin ? "true" : "false",
               needs_params(rpc_methods[i].params) ? "true" : "false");
        print_table(rpc_methods[i].params);
        printf(",\"table\":\"%s\",\"reply\":", rpc_methods[i].reply->name);
        print_table(rpc_methods[i].reply);
        printf("}");
    }
    printf("],\"notifications\":[");
    for (int i = 0; i < SHEARD_N_NOTICES; i++) {
        printf("%s{\"name\":\"%s\",\"table\":\"%s\",\"params\":", i > 0 ? "," : "",
               rpc_notices[i].name, rpc_notices[i].params->name);
        print_table(rpc_notices[i].params);
        printf("}");
    }
    printf("],\"side\":");
    print_table(&msg_side);
}

static void print_settings(void) {
    static const char *const types[] = {[SHEAR_T_CHOICE] = "choice",
                                        [SHEAR_T_INT] = "int",
                                        [SHEAR_T_DOUBLE] = "double",
                                        [SHEAR_T_BOOL] = "bool"};
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    shear_settings defaults;
    shear_settings_init(&defaults);
    json_t *values = json_settings(&defaults);
    printf(",\"settings\":[");
    for (size_t i = 0; i < n; i++) {
        char *value = tree_dump(json_object_get(values, table[i].name), 0, "", NULL);
        printf("%s{\"name\":\"%s\",\"type\":\"%s\",\"default\":%s", i > 0 ? "," : "", table[i].name,
               types[table[i].type], value);
        printf(",\"min\":%.17g,\"max\":%.17g", table[i].min, table[i].max);
        const char *word = table[i].has_auto ? shear_setting_auto(&table[i]) : "";
        printf(",\"auto\":%s,\"word\":\"%s\"", strcmp(word, "auto") == 0 ? "true" : "false", word);
        if (table[i].choices != NULL)
            print_names(table[i].choices);
        printf("}");
        free(value);
    }
    json_decref(values);
    printf("]");
}

static int tables(void) {
    print_codes();
    print_methods();
    print_settings();
    const sheard_rpc_limits *l = &sheard_rpc_request_limits;
    printf(",\"limits\":{\"line\":%zu,\"depth\":%d,\"values\":%zu,\"text\":%zu,\"id\":%d,"
           "\"job_file\":%d,\"reply_line\":%zu}}\n",
           l->line, l->depth, l->values, l->text, SHEARD_RPC_ID_MAX, SHEARD_MSG_JOB_FILE_MAX,
           sheard_rpc_reply_limits.line);
    return 0;
}

/* ---- check ---- */

static int check_request(const char *text, int method, sheard_rpc_error *error) {
    sheard_request request;
    const int rc = sheard_request_parse(&request, text, strlen(text), NULL, error);
    const bool other = rc == SHEARD_RPC_OK && request.method != method;
    sheard_request_deinit(&request);
    return other ? sheard_rpc_fail(error, SHEARD_RPC_UNKNOWN_METHOD, NULL, "another method") : rc;
}

static int check_message(const char *text, enum sheard_message_kind kind, int method,
                         sheard_rpc_error *error) {
    sheard_message message;
    int rc = sheard_message_parse(&message, text, strlen(text), error);
    if (rc == SHEARD_RPC_OK && message.kind != kind)
        rc = sheard_rpc_fail(error, SHEARD_RPC_BAD_REPLY, NULL, "another kind of message");
    if (rc == SHEARD_RPC_OK && kind == SHEARD_MESSAGE_REPLY) {
        sheard_reply reply;
        rc = sheard_message_reply(&message, method, &reply, error);
        sheard_reply_deinit(&reply, method);
    }
    const bool unknown = (kind == SHEARD_MESSAGE_NOTICE && message.notice < 0) ||
                         (kind == SHEARD_MESSAGE_ERROR && message.error.code == SHEARD_RPC_UNKNOWN);
    if (rc == SHEARD_RPC_OK && unknown)
        rc = sheard_rpc_fail(error, SHEARD_RPC_UNKNOWN, NULL, "an unknown notification or code");
    sheard_message_deinit(&message);
    return rc;
}

static int check_job_file(const char *text, sheard_rpc_error *error) {
    sheard_msg_submit submit;
    const int rc = sheard_job_file_parse(&submit, text, strlen(text), NULL, error);
    sheard_submit_deinit(&submit);
    return rc;
}

static int check_side_file(const char *text, sheard_rpc_error *error) {
    sheard_msg_side side;
    const int rc = sheard_side_parse(&side, text, strlen(text), error);
    sheard_side_deinit(&side);
    return rc;
}

static int check(const char *kind, int method, const char *text, sheard_rpc_error *error) {
    if (strcmp(kind, "request") == 0)
        return check_request(text, method, error);
    if (strcmp(kind, "reply") == 0)
        return check_message(text, SHEARD_MESSAGE_REPLY, method, error);
    if (strcmp(kind, "error") == 0)
        return check_message(text, SHEARD_MESSAGE_ERROR, method, error);
    if (strcmp(kind, "notification") == 0)
        return check_message(text, SHEARD_MESSAGE_NOTICE, method, error);
    return strcmp(kind, "job-file") == 0 ? check_job_file(text, error)
                                         : check_side_file(text, error);
}

static int check_lines(void) {
    char *line = NULL;
    size_t size = 0;
    while (getline(&line, &size, stdin) > 0) {
        line[strcspn(line, "\n")] = '\0';
        char *text = strchr(line, '\t');
        if (text == NULL) {
            free(line);
            return 2;
        }
        *text++ = '\0';
        char *method = strchr(line, ' ');
        if (method != NULL)
            *method++ = '\0';
        sheard_rpc_error error = {0};
        if (check(line, method != NULL ? sheard_method_find(method) : -1, text, &error) ==
            SHEARD_RPC_OK) {
            printf("ok\n");
        } else {
            printf("%s: %s\n", error.name, error.message);
        }
    }
    free(line);
    return 0;
}

int main(int argc, char **argv) {
    const char *what = argc == 2 ? argv[1] : "";
    if (strcmp(what, "tables") == 0)
        return tables();
    if (strcmp(what, "check") == 0)
        return check_lines();
    fprintf(stderr, "usage: protocol_probe tables | check\n");
    return 2;
}
