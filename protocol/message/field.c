/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of the messages about fields. */
#include "message/table.h"

MSG_PART(contribution, MSG_NEEDED(contribution, id), MSG(contribution, job),
         MSG(contribution, checksum), MSG(contribution, n_stamps), MSG(contribution, n_used),
         MSG_WHEN(contribution, counted));

MSG_PART(culprit, MSG(culprit, job), MSG(culprit, contribution), MSG(culprit, file),
         MSG(culprit, checksum));

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

MSG_WHOLE(field_result, MSG_NEEDED(field_result, field), MSG(field_result, mixed),
          MSG_LISTED(field_result, rows, field_row));

MSG_WHOLE(summary, MSG_NEEDED(summary, field), MSG_NEEDED(summary, digest), MSG(summary, g1),
          MSG(summary, g1_err), MSG(summary, g2), MSG(summary, g2_err), MSG(summary, n_stamps),
          MSG(summary, n_used), MSG(summary, jobs), MSG(summary, unfinished), MSG(summary, partial),
          MSG(summary, mixed), MSG_WHEN(summary, updated), MSG(summary, reason));

MSG_WHOLE(field_page, MSG_LISTED(field_page, fields, summary), MSG(field_page, cursor));

MSG_WHOLE(forgotten, MSG_NEEDED(forgotten, field), MSG(forgotten, rows),
          MSG(forgotten, contributions), MSG(forgotten, jobs));

MSG_WHOLE(field_changed, MSG_STRUCT(field_changed, field, summary, MSG_REQUIRED));
