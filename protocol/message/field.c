/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields, as replies and notifications tell of them. */
#include "message/table.h"

static const msg_member contribution_members[] = {
    MSG_COUNT_(sheard_msg_contribution, id, MSG_REQUIRED),
    MSG_COUNT_(sheard_msg_contribution, job, 0),
    MSG_SAID_(sheard_msg_contribution, checksum, 0),
    MSG_COUNT_(sheard_msg_contribution, n_stamps, 0),
    MSG_COUNT_(sheard_msg_contribution, n_used, 0),
    MSG_TIME_(sheard_msg_contribution, counted_ms, "counted"),
};
static const msg_table contribution = {MSG_TABLE_(sheard_msg_contribution, contribution_members),
                                       .check = NULL};

static const msg_member culprit_members[] = {
    MSG_INT_(sheard_msg_culprit, job, "job", 0, INT64_MAX, 0, 0),
    MSG_COUNT_(sheard_msg_culprit, contribution, 0),
    MSG_SAID_(sheard_msg_culprit, file, 0),
    MSG_SAID_(sheard_msg_culprit, checksum, 0),
};
static const msg_table culprit = {MSG_TABLE_(sheard_msg_culprit, culprit_members), .check = NULL};

static const msg_member row_members[] = {
    MSG_MERGED_(sheard_msg_field_row, report),
    MSG_SAID_(sheard_msg_field_row, digest, MSG_REQUIRED),
    MSG_COUNT_(sheard_msg_field_row, jobs, 0),
    MSG_COUNT_(sheard_msg_field_row, unfinished, 0),
    MSG_BOOL_(sheard_msg_field_row, partial, 0),
    MSG_INTS_(sheard_msg_field_row, running, SHEARD_MSG_LIST_MAX, 0),
    MSG_TIME_(sheard_msg_field_row, updated_ms, "updated"),
    MSG_OBJECTS_(sheard_msg_field_row, contributions, sheard_msg_contribution, &contribution),
    MSG_BOOL_(sheard_msg_field_row, more, 0),
    MSG_COUNT_(sheard_msg_field_row, files_left_out, 0),
    MSG_SAID_(sheard_msg_field_row, reason, 0),
    MSG_OBJECT_(sheard_msg_field_row, culprit, "culprit", sheard_msg_culprit, &culprit,
                MSG_NULLABLE),
};
static const msg_table row = {MSG_TABLE_(sheard_msg_field_row, row_members), .check = NULL};

static const msg_member result_members[] = {
    MSG_SAID_(sheard_msg_field_result, field, MSG_REQUIRED),
    MSG_BOOL_(sheard_msg_field_result, mixed, 0),
    MSG_OBJECTS_(sheard_msg_field_result, rows, sheard_msg_field_row, &row),
};
const msg_table msg_field_result = {MSG_TABLE_(sheard_msg_field_result, result_members),
                                    .check = NULL};

static const msg_member summary_members[] = {
    MSG_SAID_(sheard_msg_summary, field, MSG_REQUIRED),
    MSG_SAID_(sheard_msg_summary, digest, MSG_REQUIRED),
    MSG_REAL_(sheard_msg_summary, g1, 0, 0),
    MSG_REAL_(sheard_msg_summary, g1_err, 0, 0),
    MSG_REAL_(sheard_msg_summary, g2, 0, 0),
    MSG_REAL_(sheard_msg_summary, g2_err, 0, 0),
    MSG_COUNT_(sheard_msg_summary, n_stamps, 0),
    MSG_COUNT_(sheard_msg_summary, n_used, 0),
    MSG_COUNT_(sheard_msg_summary, jobs, 0),
    MSG_COUNT_(sheard_msg_summary, unfinished, 0),
    MSG_BOOL_(sheard_msg_summary, partial, 0),
    MSG_BOOL_(sheard_msg_summary, mixed, 0),
    MSG_TIME_(sheard_msg_summary, updated_ms, "updated"),
    MSG_SAID_(sheard_msg_summary, reason, 0),
};
const msg_table msg_summary = {MSG_TABLE_(sheard_msg_summary, summary_members), .check = NULL};

static const msg_member page_members[] = {
    MSG_OBJECTS_(sheard_msg_field_page, fields, sheard_msg_summary, &msg_summary),
    MSG_SAID_(sheard_msg_field_page, cursor, 0),
};
const msg_table msg_field_page = {MSG_TABLE_(sheard_msg_field_page, page_members), .check = NULL};

static const msg_member forgotten_members[] = {
    MSG_SAID_(sheard_msg_forgotten, field, MSG_REQUIRED),
    MSG_COUNT_(sheard_msg_forgotten, rows, 0),
    MSG_COUNT_(sheard_msg_forgotten, contributions, 0),
    MSG_COUNT_(sheard_msg_forgotten, jobs, 0),
};
const msg_table msg_forgotten = {MSG_TABLE_(sheard_msg_forgotten, forgotten_members),
                                 .check = NULL};

static const msg_member changed_members[] = {
    MSG_OBJECT_(sheard_msg_field_changed, field, "field", sheard_msg_summary, &msg_summary,
                MSG_REQUIRED),
};
const msg_table msg_field_changed = {MSG_TABLE_(sheard_msg_field_changed, changed_members),
                                     .check = NULL};
