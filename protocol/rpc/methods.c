/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The one table of methods and of notifications. */
#include "rpc/methods.h"

#include <string.h>

const rpc_method rpc_methods[SHEARD_N_METHODS] = {
    [SHEARD_METHOD_HELLO] = {"hello", &msg_hello, &msg_welcome, false},
    [SHEARD_METHOD_SUBMIT] = {"submit", &msg_submit, &msg_submitted, false},
    [SHEARD_METHOD_JOB] = {"job", &msg_id, &msg_shown, false},
    [SHEARD_METHOD_JOBS] = {"jobs", &msg_jobs, &msg_job_page, false},
    [SHEARD_METHOD_WAIT] = {"wait", &msg_wait, &msg_waited, false},
    [SHEARD_METHOD_CANCEL] = {"cancel", &msg_id, &msg_job, false},
    [SHEARD_METHOD_RETRY] = {"retry", &msg_id, &msg_job, false},
    [SHEARD_METHOD_RETRACT] = {"retract", &msg_id, &msg_job, false},
    [SHEARD_METHOD_FIELD] = {"field", &msg_field, &msg_field_result, false},
    [SHEARD_METHOD_FIELDS] = {"fields", &msg_fields, &msg_field_page, false},
    [SHEARD_METHOD_FORGET] = {"forget", &msg_forget, &msg_forgotten, true},
    [SHEARD_METHOD_SUBSCRIBE] = {"subscribe", &msg_subscribe, &msg_subscribed, false},
    [SHEARD_METHOD_UNSUBSCRIBE] = {"unsubscribe", &msg_unsubscribe, &msg_subscribed, false},
    [SHEARD_METHOD_STATUS] = {"status", &msg_nothing, &msg_status, false},
    [SHEARD_METHOD_METRICS] = {"metrics", &msg_nothing, &msg_metrics, false},
    [SHEARD_METHOD_PROBE] = {"probe", &msg_nothing, &msg_probed, false},
    [SHEARD_METHOD_RELOAD] = {"reload", &msg_nothing, &msg_reloaded, true},
    [SHEARD_METHOD_DRAIN] = {"drain", &msg_nothing, &msg_stopping, true},
    [SHEARD_METHOD_SHUTDOWN] = {"shutdown", &msg_shutdown, &msg_stopping, true},
};

const rpc_notice rpc_notices[SHEARD_N_NOTICES] = {
    [SHEARD_NOTICE_JOB_CHANGED] = {"job_changed", &msg_job_changed},
    [SHEARD_NOTICE_JOB_PROGRESS] = {"job_progress", &msg_job_progress},
    [SHEARD_NOTICE_FIELD_CHANGED] = {"field_changed", &msg_field_changed},
    [SHEARD_NOTICE_SERVER_STATE] = {"server_state", &msg_stopping},
    [SHEARD_NOTICE_LOST] = {"lost", &msg_lost},
};

static bool is_method(int method) {
    return method >= 0 && method < SHEARD_N_METHODS;
}

const char *sheard_method_name(int method) {
    return is_method(method) ? rpc_methods[method].name : NULL;
}

const char *sheard_notice_name(int notice) {
    return notice >= 0 && notice < SHEARD_N_NOTICES ? rpc_notices[notice].name : NULL;
}

int sheard_method_find(const char *name) {
    for (int i = 0; i < SHEARD_N_METHODS; i++) {
        if (strcmp(rpc_methods[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

bool sheard_method_needs_admin(int method) {
    return is_method(method) && rpc_methods[method].admin;
}

/* In the order of enum sheard_method. */
const char *const *sheard_method_names(size_t *n) {
    static const char *const names[SHEARD_N_METHODS] = {
        "hello",   "submit", "job",    "jobs",   "wait",      "cancel",      "retry",
        "retract", "field",  "fields", "forget", "subscribe", "unsubscribe", "status",
        "metrics", "probe",  "reload", "drain",  "shutdown",
    };
    *n = SHEARD_N_METHODS;
    return names;
}
