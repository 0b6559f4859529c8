/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl extract: write a field file of what would be measured. */
#include "base/cleanup.h"
#include "cmdline/part_options.h"
#include "commands/commands.h"
#include "local/extraction.h"
#include "terminal/message.h"

#include <getopt.h>

typedef struct extract_options {
    part_options parts;
    const char *output, *field;
    bool force, quiet;
} extract_options;

CLEANUP_DEFINE(shear_field, shear_field_close)

static enum exit_code parse(const command *self, int argc, char **argv, extract_options *o) {
    const option_entry options[] = {{.name = "output", .letter = 'o', .text = &o->output},
                                    {.name = "field", .text = &o->field},
                                    {.name = "force", .flag = &o->force},
                                    {.name = "quiet", .flag = &o->quiet},
                                    PART_OPTIONS(&o->parts),
                                    EXPOSURE_OPTIONS(&o->parts),
                                    {0}};
    TRY(options_parse(self, argc, argv, options, NULL));
    if (o->output == NULL)
        return options_fail(self, "give the file to write: --output FILE");
    if (argc - optind > 1)
        return options_fail(self, "expected one field file, got %d", argc - optind);
    return part_options_settle(&o->parts, self, argv + optind, argc - optind);
}

static int extract(const shear_input *input, const extract_options *o, shear_error *err) {
    CLEANUP(shear_field_release) shear_field *field = NULL;
    TRY(shear_field_open_input(&field, input, NULL, err));
    progress *bar = progress_begin(o->output, o->quiet);
    const int code = extraction_write(field, o->output, o->field, o->force, bar, err);
    progress_end(bar);
    return code;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    extract_options o = {.parts = PART_OPTIONS_INIT};
    CLEANUP(part_input_deinit) part_input parts = {0};
    shear_error err = {0};
    TRY(parse(self, argc, argv, &o));
    shear_input input = shear_input_of_file(argv[optind]);
    input.mosaic = o.parts.mosaic;
    if (part_options_any(&o.parts)) {
        if (part_input_init(&parts, &o.parts, false, &err) != SHEAR_OK)
            return message_error(&err);
        input = parts.input;
    }
    return extract(&input, &o, &err) != SHEAR_OK ? message_error(&err) : EXIT_CODE_DONE;
}

COMMAND(extract, "write a field file of what would be measured", run, NULL);
