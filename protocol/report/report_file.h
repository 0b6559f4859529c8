/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report/report_file.h: a file's entry in a report. */
#ifndef PROTOCOL_REPORT_FILE_H
#define PROTOCOL_REPORT_FILE_H

#include "sheard/report.h"

#include <jansson.h>

/* A new reference; NULL: no memory. */
json_t *report_file_json(const sheard_report_file *file);

#endif
