/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measure_input.h: the files of one `shearctl measure`: which field each counts to, and how each
 * fared. */
#ifndef CLIENT_LOCAL_MEASURE_INPUT_H
#define CLIENT_LOCAL_MEASURE_INPUT_H

#include "shear/field.h"
#include "shear/run.h"
#include "terminal/exit_code.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct measure_input {
    const shear_input *source; /* kept by the caller */
    const char *path;          /* in messages and reports: shear_input_text */
    enum exit_code
        failure; /* EXIT_CODE_DONE so far, or why the file failed; then an error has been printed */
    bool duplicate;        /* content and field of an earlier file: not measured */
    const char *field;     /* what it counts to: --field, or info.name */
    shear_field_info info; /* as opened */
    char checksum[SHEAR_CHECKSUM_SIZE];
    char *catalog; /* where its catalog goes (catalog_path.h), owned, or NULL */
    bool measured; /* its sums are in the field's result, and the report is filled in */
    shear_run_report report;
} measure_input;

/* Look into every file: check it, find its field and checksum, mark duplicates. Faults are printed.
 * `field` overrides the files' own names; or NULL. */
void measure_inputs_open(measure_input *inputs, size_t n, const char *field);
void measure_inputs_free(measure_input *inputs, size_t n);

/* The file that field and catalog are called after. */
const char *measure_input_path(const measure_input *input);

/* To be measured: neither failed nor a duplicate. */
bool measure_input_is_wanted(const measure_input *input);

/* The exit code that an error of libshear about this file deserves. `writing`: the file was good
 * before, and we wrote. */
enum exit_code measure_failure_of(int shear_code, bool writing);
/* The exit code of the whole. */
enum exit_code measure_inputs_exit_code(const measure_input *inputs, size_t n);

#endif
