/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of the messages about jobs. */
#include "message/table.h"

static const msg_member progress_members[] = {
    MSG(progress, done),
    MSG_NUMBER(progress, total, 0, INT64_MAX, -1, MSG_NULLABLE),
    MSG(progress, rate),
    MSG(progress, eta_s),
    MSG_NAMED(progress, phase, "phase", msg_job_phases, 0),
    MSG_NUMBER(progress, bytes_done, 0, INT64_MAX, -1, MSG_NULLABLE),
    MSG_NUMBER(progress, bytes_total, 0, INT64_MAX, -1, MSG_NULLABLE),
};
MSG_TABLE(progress, NULL);

static const msg_member job_members[] = {
    MSG_NEEDED(job, id),
    MSG_NAMED(job, state, "state", msg_job_states, MSG_REQUIRED),
    MSG_NAMED(job, job_class, "class", msg_job_classes, 0),
    MSG(job, code),
    MSG(job, message),
    MSG(job, advice),
    MSG(job, field),
    MSG_STRUCT(job, source, source, 0),
    MSG_NUMBER(job, owner, 0, UINT32_MAX, 0, 0),
    MSG(job, user),
    MSG_NAMED(job, origin, "origin", msg_job_origins, 0),
    MSG_NUMBER(job, priority, -SHEARD_MSG_PRIORITY_MAX, SHEARD_MSG_PRIORITY_MAX, 0, 0),
    MSG(job, force),
    MSG(job, key),
    MSG(job, cancel_asked),
    MSG_WHEN(job, created),
    MSG_WHEN(job, started),
    MSG_WHEN(job, finished),
    MSG_WHEN(job, not_before),
    MSG(job, attempts),
    MSG_STRUCT(job, progress, progress, 0),
    MSG_NAMED(job, outcome, "outcome", msg_job_outcomes, 0),
    MSG_NUMBER(job, duplicate_of, 0, INT64_MAX, 0, MSG_NULLABLE),
    MSG_JSON(job, settings, MSG_SETTINGS),
    MSG(job, digest),
    MSG(job, checksum),
    MSG_JSON(job, result, MSG_RAW),
    MSG_STRING_AS(job, catalog, "catalogue", 0, 0),
    MSG(job, dropped_name),
    MSG(job, file_now),
};
MSG_TABLE(job, NULL);

static const msg_member attempt_members[] = {
    MSG_NEEDED(attempt, number),
    MSG_WHEN(attempt, started),
    MSG_WHEN(attempt, ended),
    MSG_NAMED(attempt, outcome, "ending", msg_attempt_outcomes, 0),
    MSG_NAMED(attempt, job_class, "class", msg_job_classes, 0),
    MSG(attempt, code),
    MSG(attempt, message),
};
static MSG_TABLE(attempt, NULL);

MSG_WHOLE(shown, MSG_STRUCT(shown, job, job, MSG_REQUIRED), MSG_LISTED(shown, history, attempt));

MSG_WHOLE(submitted, MSG_STRUCT(submitted, job, job, MSG_REQUIRED), MSG(submitted, known));

MSG_WHOLE(job_page, MSG_LISTED(job_page, jobs, job), MSG(job_page, cursor));

MSG_WHOLE(waited, MSG_LISTED(waited, jobs, job), MSG(waited, timed_out));

/* ---- Notifications ---- */

MSG_WHOLE(job_changed, MSG_STRUCT(job_changed, job, job, MSG_REQUIRED));

MSG_WHOLE(job_progress, MSG_NEEDED(job_progress, id),
          MSG_STRUCT(job_progress, progress, progress, MSG_REQUIRED));

/* ---- The report file beside an input ---- */

static const msg_member side_members[] = {
    MSG_NEEDED(side, file), MSG_NAMED(side, state, "state", msg_job_states, MSG_REQUIRED),
    MSG(side, code),        MSG(side, message),
    MSG(side, advice),      MSG_WHEN(side, written),
    MSG(side, version),     MSG_STRUCT(side, job, job, MSG_NULLABLE),
};
MSG_TABLE(side, NULL);
