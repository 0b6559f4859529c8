/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure_input.h: the input files of one `shearctl measure`: the field of each, and whether it
 * could be measured. */
#pragma once

#include "local/chip_counts.h"
#include "local/warnings.h"
#include "shear/field.h"
#include "shear/run.h"
#include "terminal/exit_code.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct measure_input {
    shear_input source; /* its texts are owned by the caller */
    const char *path;   /* for messages and reports: shear_input_text */
    enum exit_code
        failure; /* EXIT_CODE_DONE, or the reason for the failure, which has been printed */
    warning_list warnings; /* about its chips */
    chip_counts counts;
    bool duplicate;        /* same content and field as an earlier file: not measured */
    const char *field;     /* the field that it belongs to: --field, or info.name */
    shear_field_info info; /* as opened */
    char checksum[SHEAR_CHECKSUM_SIZE];
    char *catalog; /* path of its catalog (catalog_path.h), to be freed; or NULL */
    bool measured; /* its sums are in the field's result, and the report is complete */
    shear_run_report report;
} measure_input;

/* Open and check every file, find its field and checksum, and mark duplicates. Errors are printed.
 * `field`, unless NULL, overrides the files' own names. */
void measure_inputs_open(measure_input *inputs, size_t n, const char *field);

/* Return whether the file is to be measured: it has neither failed nor is it a duplicate. */
bool measure_input_is_wanted(const measure_input *input);

/* Return the exit code of the whole command. */
enum exit_code measure_inputs_exit_code(const measure_input *inputs, size_t n);
