/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Jobs, as replies and notifications tell of them. */
#include "message/table.h"

static const msg_member progress_members[] = {
    MSG_COUNT_(sheard_msg_progress, done, 0),
    MSG_INT_(sheard_msg_progress, total, "total", 0, INT64_MAX, -1, MSG_NULLABLE),
    MSG_REAL_(sheard_msg_progress, rate, 0, INT64_MAX),
    MSG_REAL_(sheard_msg_progress, eta_s, 0, INT64_MAX),
    MSG_NAME_(sheard_msg_progress, phase, "phase", msg_phases, 0),
    MSG_INT_(sheard_msg_progress, bytes_done, "bytes_done", 0, INT64_MAX, -1, MSG_NULLABLE),
    MSG_INT_(sheard_msg_progress, bytes_total, "bytes_total", 0, INT64_MAX, -1, MSG_NULLABLE),
};
const msg_table msg_progress = {MSG_TABLE_(sheard_msg_progress, progress_members), .check = NULL};

static const msg_member job_members[] = {
    MSG_COUNT_(sheard_msg_job, id, MSG_REQUIRED),
    MSG_NAME_(sheard_msg_job, state, "state", msg_states, MSG_REQUIRED),
    MSG_NAME_(sheard_msg_job, job_class, "class", msg_classes, 0),
    MSG_SAID_(sheard_msg_job, code, 0),
    MSG_SAID_(sheard_msg_job, message, 0),
    MSG_SAID_(sheard_msg_job, advice, 0),
    MSG_SAID_(sheard_msg_job, field, 0),
    MSG_OBJECT_(sheard_msg_job, source, "source", sheard_msg_source, &msg_source, 0),
    MSG_INT_(sheard_msg_job, owner, "owner", 0, UINT32_MAX, 0, 0),
    MSG_SAID_(sheard_msg_job, user, 0),
    MSG_NAME_(sheard_msg_job, origin, "origin", msg_origins, 0),
    MSG_INT_(sheard_msg_job, priority, "priority", -SHEARD_MSG_PRIORITY_MAX,
             SHEARD_MSG_PRIORITY_MAX, 0, 0),
    MSG_BOOL_(sheard_msg_job, force, 0),
    MSG_SAID_(sheard_msg_job, key, 0),
    MSG_BOOL_(sheard_msg_job, cancel_asked, 0),
    MSG_TIME_(sheard_msg_job, created_ms, "created"),
    MSG_TIME_(sheard_msg_job, started_ms, "started"),
    MSG_TIME_(sheard_msg_job, finished_ms, "finished"),
    MSG_TIME_(sheard_msg_job, not_before_ms, "not_before"),
    MSG_COUNT_(sheard_msg_job, attempts, 0),
    MSG_OBJECT_(sheard_msg_job, progress, "progress", sheard_msg_progress, &msg_progress, 0),
    MSG_NAME_(sheard_msg_job, outcome, "outcome", msg_outcomes, 0),
    MSG_INT_(sheard_msg_job, duplicate_of, "duplicate_of", 0, INT64_MAX, 0, MSG_NULLABLE),
    MSG_SETTINGS_(sheard_msg_job, settings),
    MSG_SAID_(sheard_msg_job, digest, 0),
    MSG_SAID_(sheard_msg_job, checksum, 0),
    MSG_RAW_(sheard_msg_job, result),
    MSG_TEXT_(sheard_msg_job, catalog, "catalogue", 0, 0),
    MSG_SAID_(sheard_msg_job, dropped_name, 0),
    MSG_SAID_(sheard_msg_job, file_now, 0),
};
const msg_table msg_job = {MSG_TABLE_(sheard_msg_job, job_members), .check = NULL};

static const msg_member attempt_members[] = {
    MSG_COUNT_(sheard_msg_attempt, number, MSG_REQUIRED),
    MSG_TIME_(sheard_msg_attempt, started_ms, "started"),
    MSG_TIME_(sheard_msg_attempt, ended_ms, "ended"),
    MSG_NAME_(sheard_msg_attempt, outcome, "ending", msg_attempt_outcomes, 0),
    MSG_NAME_(sheard_msg_attempt, job_class, "class", msg_classes, 0),
    MSG_SAID_(sheard_msg_attempt, code, 0),
    MSG_SAID_(sheard_msg_attempt, message, 0),
};
static const msg_table attempt = {MSG_TABLE_(sheard_msg_attempt, attempt_members), .check = NULL};

static const msg_member shown_members[] = {
    MSG_OBJECT_(sheard_msg_shown, job, "job", sheard_msg_job, &msg_job, MSG_REQUIRED),
    MSG_OBJECTS_(sheard_msg_shown, history, sheard_msg_attempt, &attempt),
};
const msg_table msg_shown = {MSG_TABLE_(sheard_msg_shown, shown_members), .check = NULL};

static const msg_member submitted_members[] = {
    MSG_OBJECT_(sheard_msg_submitted, job, "job", sheard_msg_job, &msg_job, MSG_REQUIRED),
    MSG_BOOL_(sheard_msg_submitted, known, 0),
};
const msg_table msg_submitted = {MSG_TABLE_(sheard_msg_submitted, submitted_members),
                                 .check = NULL};

static const msg_member page_members[] = {
    MSG_OBJECTS_(sheard_msg_job_page, jobs, sheard_msg_job, &msg_job),
    MSG_SAID_(sheard_msg_job_page, cursor, 0),
};
const msg_table msg_job_page = {MSG_TABLE_(sheard_msg_job_page, page_members), .check = NULL};

static const msg_member waited_members[] = {
    MSG_OBJECTS_(sheard_msg_waited, jobs, sheard_msg_job, &msg_job),
    MSG_BOOL_(sheard_msg_waited, timed_out, 0),
};
const msg_table msg_waited = {MSG_TABLE_(sheard_msg_waited, waited_members), .check = NULL};

/* ---- Notifications ---- */

static const msg_member changed_members[] = {
    MSG_OBJECT_(sheard_msg_job_changed, job, "job", sheard_msg_job, &msg_job, MSG_REQUIRED),
};
const msg_table msg_job_changed = {MSG_TABLE_(sheard_msg_job_changed, changed_members),
                                   .check = NULL};

static const msg_member job_progress_members[] = {
    MSG_COUNT_(sheard_msg_job_progress, id, MSG_REQUIRED),
    MSG_OBJECT_(sheard_msg_job_progress, progress, "progress", sheard_msg_progress, &msg_progress,
                MSG_REQUIRED),
};
const msg_table msg_job_progress = {MSG_TABLE_(sheard_msg_job_progress, job_progress_members),
                                    .check = NULL};

/* ---- The file beside an input ---- */

static const msg_member side_members[] = {
    MSG_SAID_(sheard_msg_side, file, MSG_REQUIRED),
    MSG_NAME_(sheard_msg_side, state, "state", msg_states, MSG_REQUIRED),
    MSG_SAID_(sheard_msg_side, code, 0),
    MSG_SAID_(sheard_msg_side, message, 0),
    MSG_SAID_(sheard_msg_side, advice, 0),
    MSG_TIME_(sheard_msg_side, written_ms, "written"),
    MSG_SAID_(sheard_msg_side, version, 0),
    MSG_OBJECT_(sheard_msg_side, job, "job", sheard_msg_job, &msg_job, MSG_NULLABLE),
};
const msg_table msg_side = {MSG_TABLE_(sheard_msg_side, side_members), .check = NULL};
