/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields, as replies and notifications tell of them. */
#include "message/table.h"

static const msg_member contribution_members[] = {
    MSG_NEEDED(contribution, id), MSG(contribution, job),    MSG(contribution, checksum),
    MSG(contribution, n_stamps),  MSG(contribution, n_used), MSG_WHEN(contribution, counted),
};
static MSG_TABLE(contribution, NULL);

static const msg_member culprit_members[] = {MSG(culprit, job), MSG(culprit, contribution),
                                             MSG(culprit, file), MSG(culprit, checksum)};
static MSG_TABLE(culprit, NULL);

static const msg_member field_row_members[] = {
    MSG_JSON(field_row, report, MSG_MERGED),
    MSG_NEEDED(field_row, digest),
    MSG(field_row, jobs),
    MSG(field_row, unfinished),
    MSG(field_row, partial),
    MSG_IDS(field_row, running, SHEARD_MSG_LIST_MAX, 0),
    MSG_WHEN(field_row, updated),
    MSG_LISTED(field_row, contributions, contribution),
    MSG(field_row, more),
    MSG(field_row, files_left_out),
    MSG(field_row, reason),
    MSG_STRUCT(field_row, culprit, culprit, MSG_NULLABLE),
};
static MSG_TABLE(field_row, NULL);

static const msg_member field_result_members[] = {
    MSG_NEEDED(field_result, field),
    MSG(field_result, mixed),
    MSG_LISTED(field_result, rows, field_row),
};
MSG_TABLE(field_result, NULL);

static const msg_member summary_members[] = {
    MSG_NEEDED(summary, field), MSG_NEEDED(summary, digest),
    MSG(summary, g1),           MSG(summary, g1_err),
    MSG(summary, g2),           MSG(summary, g2_err),
    MSG(summary, n_stamps),     MSG(summary, n_used),
    MSG(summary, jobs),         MSG(summary, unfinished),
    MSG(summary, partial),      MSG(summary, mixed),
    MSG_WHEN(summary, updated), MSG(summary, reason),
};
MSG_TABLE(summary, NULL);

static const msg_member field_page_members[] = {
    MSG_LISTED(field_page, fields, summary),
    MSG(field_page, cursor),
};
MSG_TABLE(field_page, NULL);

static const msg_member forgotten_members[] = {
    MSG_NEEDED(forgotten, field),
    MSG(forgotten, rows),
    MSG(forgotten, contributions),
    MSG(forgotten, jobs),
};
MSG_TABLE(forgotten, NULL);

static const msg_member field_changed_members[] = {
    MSG_STRUCT(field_changed, field, summary, MSG_REQUIRED)};
MSG_TABLE(field_changed, NULL);
