/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spool/undo_log.h: a file is under way between active/ and done/ or failed/.
 *
 * Two names are to appear, the report's and the file's, and no rename does both. So there is a
 * symbolic link active/.ACTIVE_NAME.end -> done/NAME meanwhile. Where a link is found at the start
 * and its file is in active/, the report goes; where the file has moved, only the link. The link
 * itself needs no fsync: if the power fails and it is lost but the report is not, there is a report
 * too many, and no file is lost or overwritten. */
#ifndef SHEARD_SPOOL_UNDO_LOG_H
#define SHEARD_SPOOL_UNDO_LOG_H

#include "spool/folders.h"
#include "spool/names.h"

/* Undo what a crash left half done in active/. */
int undo_log_recover(const folders *f, shear_error *err);
/* The file is under way between active/ and FOLDER/NAME. Returns 0 or errno. */
int undo_log_write(const folders *f, const char *active_name, enum folder folder, const char *name);
void undo_log_remove(const folders *f, const char *active_name);

/* The report's name until it is complete: active/.ACTIVE_NAME.tmp. */
void undo_log_temporary(char out[NAME_SIZE], const char *active_name);

#endif
