/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The names of states and kinds. "" is null in JSON. The order is that of the enums. */
#include "message/table.h"

const char *const msg_job_states[] = {"queued", "running",   "waiting",   "done",
                                      "failed", "cancelled", "retracted", NULL};
const char *const msg_job_classes[] = {"", "transient", "data", "bug", NULL};
const char *const msg_job_outcomes[] = {"", "counted", "duplicate", NULL};
const char *const msg_job_phases[] = {"",          "opening",   "hashing",   "waiting_memory",
                                      "preparing", "measuring", "finishing", NULL};
const char *const msg_job_origins[] = {"spool", "socket", NULL};
const char *const msg_attempt_outcomes[] = {"",         "done",        "failed", "cancelled",
                                            "released", "interrupted", NULL};
const char *const msg_server_states[] = {"running", "draining", "stopping", NULL};
const char *const msg_shutdown_modes[] = {"drain", "now", NULL};

const char *sheard_job_state_name(int state) {
    return msg_name(msg_job_states, state);
}

const char *sheard_job_class_name(int job_class) {
    return msg_name(msg_job_classes, job_class);
}

const char *sheard_job_outcome_name(int outcome) {
    return msg_name(msg_job_outcomes, outcome);
}

const char *sheard_job_phase_name(int phase) {
    return msg_name(msg_job_phases, phase);
}

const char *sheard_job_origin_name(int origin) {
    return msg_name(msg_job_origins, origin);
}

const char *sheard_attempt_outcome_name(int outcome) {
    return msg_name(msg_attempt_outcomes, outcome);
}

const char *sheard_server_state_name(int state) {
    return msg_name(msg_server_states, state);
}

bool sheard_job_state_is_final(int state) {
    return state >= SHEARD_JOB_DONE && state <= SHEARD_JOB_RETRACTED;
}
