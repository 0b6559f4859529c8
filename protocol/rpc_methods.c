/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The one table of methods and of notifications. */
#include "rpc_methods.h"

#include <string.h>

const rpc_method rpc_methods[SHEAR_N_METHODS] = {
    [SHEAR_METHOD_HELLO] = {"hello", &msg_hello, &msg_welcome, false},
    [SHEAR_METHOD_SUBMIT] = {"submit", &msg_submit, &msg_submitted, false},
    [SHEAR_METHOD_JOB] = {"job", &msg_id, &msg_shown, false},
    [SHEAR_METHOD_JOBS] = {"jobs", &msg_jobs, &msg_job_page, false},
    [SHEAR_METHOD_WAIT] = {"wait", &msg_wait, &msg_waited, false},
    [SHEAR_METHOD_CANCEL] = {"cancel", &msg_id, &msg_job, false},
    [SHEAR_METHOD_RETRY] = {"retry", &msg_id, &msg_job, false},
    [SHEAR_METHOD_RETRACT] = {"retract", &msg_id, &msg_job, false},
    [SHEAR_METHOD_FIELD] = {"field", &msg_field, &msg_field_result, false},
    [SHEAR_METHOD_FIELDS] = {"fields", &msg_fields, &msg_field_page, false},
    [SHEAR_METHOD_FORGET] = {"forget", &msg_forget, &msg_forgotten, true},
    [SHEAR_METHOD_SUBSCRIBE] = {"subscribe", &msg_subscribe, &msg_subscribed, false},
    [SHEAR_METHOD_UNSUBSCRIBE] = {"unsubscribe", &msg_unsubscribe, &msg_subscribed, false},
    [SHEAR_METHOD_STATUS] = {"status", &msg_nothing, &msg_status, false},
    [SHEAR_METHOD_METRICS] = {"metrics", &msg_nothing, &msg_metrics, false},
    [SHEAR_METHOD_PROBE] = {"probe", &msg_nothing, &msg_probed, false},
    [SHEAR_METHOD_RELOAD] = {"reload", &msg_nothing, &msg_reloaded, true},
    [SHEAR_METHOD_DRAIN] = {"drain", &msg_nothing, &msg_stopping, true},
    [SHEAR_METHOD_SHUTDOWN] = {"shutdown", &msg_shutdown, &msg_stopping, true},
};

const rpc_notice rpc_notices[SHEAR_N_NOTICES] = {
    [SHEAR_NOTICE_JOB_CHANGED] = {"job_changed", &msg_job_changed},
    [SHEAR_NOTICE_JOB_PROGRESS] = {"job_progress", &msg_job_progress},
    [SHEAR_NOTICE_FIELD_CHANGED] = {"field_changed", &msg_field_changed},
    [SHEAR_NOTICE_SERVER_STATE] = {"server_state", &msg_stopping},
    [SHEAR_NOTICE_LOST] = {"lost", &msg_lost},
};

static bool is_method(int method) {
    return method >= 0 && method < SHEAR_N_METHODS;
}

const char *shear_method_name(int method) {
    return is_method(method) ? rpc_methods[method].name : NULL;
}

const char *shear_notice_name(int notice) {
    return notice >= 0 && notice < SHEAR_N_NOTICES ? rpc_notices[notice].name : NULL;
}

int shear_method_find(const char *name) {
    for (int i = 0; i < SHEAR_N_METHODS; i++) {
        if (strcmp(rpc_methods[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

bool shear_method_needs_admin(int method) {
    return is_method(method) && rpc_methods[method].admin;
}

/* In the order of enum shear_method. */
const char *const *shear_method_names(size_t *n) {
    static const char *const names[SHEAR_N_METHODS] = {
        "hello",   "submit", "job",    "jobs",   "wait",      "cancel",      "retry",
        "retract", "field",  "fields", "forget", "subscribe", "unsubscribe", "status",
        "metrics", "probe",  "reload", "drain",  "shutdown",
    };
    *n = SHEAR_N_METHODS;
    return names;
}
