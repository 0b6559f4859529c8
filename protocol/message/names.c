/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of states and kinds, in the order of the enums. "" is null in JSON. */
#include "message/table.h"

#include <assert.h>

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

static_assert(sizeof msg_job_states / sizeof msg_job_states[0] == SHEARD_N_JOB_STATES + 1,
              "a name for each state");

#define NAME_OF(function, names)                                                                   \
    const char *function(int index) {                                                              \
        return msg_name(names, index);                                                             \
    }
NAME_OF(sheard_job_state_name, msg_job_states)
NAME_OF(sheard_job_class_name, msg_job_classes)
NAME_OF(sheard_job_outcome_name, msg_job_outcomes)
NAME_OF(sheard_job_phase_name, msg_job_phases)
NAME_OF(sheard_job_origin_name, msg_job_origins)
NAME_OF(sheard_attempt_outcome_name, msg_attempt_outcomes)
NAME_OF(sheard_server_state_name, msg_server_states)

bool sheard_job_state_is_final(int state) {
    return state >= SHEARD_JOB_DONE && state <= SHEARD_JOB_RETRACTED;
}
