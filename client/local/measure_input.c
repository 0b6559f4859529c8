/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/measure_input.h"

#include "base/cleanup.h"
#include "local/psf_size.h"
#include "local/segmentation.h"
#include "local/sources_away.h"
#include "sheard/advice.h"
#include "terminal/message.h"

#include <string.h>

/* Write what is wrong with a chip as far as a look at it shows, and return it; NULL: nothing. */
static const char *doubt_of(shear_field *field, int i, double median, const shear_chip *chip,
                            char *line, size_t size) {
    int64_t looked_at;
    int64_t unowned;
    if (sources_away_warning(chip, line, size) != NULL ||
        psf_size_warning(chip, line, size) != NULL ||
        psf_size_odd(chip, median, line, size) != NULL) {
        return line;
    }
    return shear_chip_unowned(field, i, &looked_at, &unowned, NULL) == SHEAR_OK
               ? segmentation_warning(looked_at, unowned, line, size)
               : NULL; /* measuring will fail, too */
}

static void warn_of_chips(shear_field *field, warning_list *warnings) {
    const double median = psf_size_median(field);
    for (int i = 0; i < shear_field_chips(field); i++) {
        shear_chip chip;
        char line[SHEARD_ADVICE_SIZE];
        if (shear_field_get_chip(field, i, &chip, NULL) == SHEAR_OK &&
            doubt_of(field, i, median, &chip, line, sizeof line) != NULL) {
            warnings_add(warnings, "chip %d (%s): %s", i + 1,
                         chip.name[0] != '\0' ? chip.name : "no EXTNAME", line);
        }
    }
}

CLEANUP_DEFINE(shear_field, shear_field_close)

/* Open and check the file. `name` is the name of its field; NULL: the file must contain one. */
static int look_into(measure_input *input, const char *name, shear_error *err) {
    CLEANUP(shear_field_release) shear_field *field = NULL;
    TRY(shear_field_open_input(&field, &input->source, NULL, err));
    input->info = *shear_field_get_info(field);
    input->info.carried = NULL; /* which is the field's */
    warn_of_chips(field, &input->warnings);
    TRY(chip_counts_init(&input->counts, field, input->path, err));
    TRY(shear_input_checksum(&input->source, NULL, &input->info, input->checksum, err));
    return name != NULL
               ? SHEAR_OK
               : shear_field_need_name(&input->info, shear_input_name(&input->source), err);
}

/* Return whether an earlier file has the same content and field: counted twice, it would halve the
 * variance. */
static bool is_duplicate(const measure_input *inputs, size_t i) {
    for (size_t j = 0; j < i; j++) {
        if (inputs[j].failure == 0 && strcmp(inputs[j].checksum, inputs[i].checksum) == 0 &&
            strcmp(inputs[j].field, inputs[i].field) == 0) {
            return true;
        }
    }
    return false;
}

void measure_inputs_open(measure_input *inputs, size_t n, const char *field) {
    for (size_t i = 0; i < n; i++) {
        shear_error err = {0};
        const int code = look_into(&inputs[i], field, &err);
        if (code != SHEAR_OK) {
            inputs[i].failure = message_error(&err);
            continue;
        }
        inputs[i].field = field != NULL ? field : inputs[i].info.name;
        inputs[i].duplicate = is_duplicate(inputs, i);
    }
}

bool measure_input_is_wanted(const measure_input *input) {
    return input->failure == 0 && !input->duplicate;
}

enum exit_code measure_inputs_exit_code(const measure_input *inputs, size_t n) {
    size_t done = 0;
    size_t failed[EXIT_CODE_PARTLY] = {0}; /* numbers of files by exit code */
    for (size_t i = 0; i < n; i++) {
        if (inputs[i].failure != 0) {
            failed[inputs[i].failure]++;
        } else {
            done++;
        }
    }
    if (done == n)
        return EXIT_CODE_DONE;
    if (done > 0)
        return EXIT_CODE_PARTLY;
    return failed[EXIT_CODE_INPUT] != 0   ? EXIT_CODE_INPUT
           : failed[EXIT_CODE_USAGE] != 0 ? EXIT_CODE_USAGE
                                          : EXIT_CODE_OTHER;
}
