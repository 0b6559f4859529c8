/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl plot: draw a field file, an exposure or a result catalog. */
#include "plot/plot.h"
#include "base/cleanup.h"
#include "cmdline/part_options.h"
#include "commands/commands.h"
#include "local/measure_input.h"
#include "shear/chip.h"
#include "terminal/message.h"

#include <getopt.h>
#include <string.h>
#include <sys/stat.h>

typedef struct plot_command {
    const char *path; /* of the file that gives the picture its name */
    shear_input input;
    part_options parts;
    const char *stamp_size;
    const char *out; /* NULL: derived from the input's name */
    bool force;
    bool stamps_given; /* valid only for a field file, like settings */
    option_settings settings;
    plot_options options;
} plot_command;

CLEANUP_DEFINE(shear_catalog_table, shear_catalog_table_free)

/* Set --stamp-size, which is also the side of an exposure's stamps: --stamp chooses one here. */
static enum exit_code set_stamp_size(plot_command *c) {
    const bool exposure = c->parts.given[SHEAR_PART_IMAGE] != NULL;
    const option_entry size = {.name = exposure ? "stamp" : "stamp-size", .context = &c->parts};
    if (c->stamp_size == NULL)
        return EXIT_CODE_DONE;
    return exposure ? part_options_set(&size, c->stamp_size)
                    : part_options_set_size(&size, c->stamp_size);
}

static enum exit_code parse(const command *self, int argc, char **argv, plot_command *c) {
    /* Of options with one name the first counts. */
    const option_entry options[] = {{.name = "output", .letter = 'o', .text = &c->out},
                                    {.name = "stamp",
                                     .integer = &c->options.stamp,
                                     .max = INT64_MAX,
                                     .given = &c->stamps_given},
                                    {.name = "stamps",
                                     .integer = &c->options.n_stamps,
                                     .min = 1,
                                     .max = PLOT_MAX_STAMPS,
                                     .given = &c->stamps_given},
                                    {.name = "stamp-size", .text = &c->stamp_size},
                                    {.name = "chip", .text = &c->options.chip},
                                    {.name = "force", .flag = &c->force},
                                    PART_OPTIONS(&c->parts),
                                    EXPOSURE_OPTIONS(&c->parts),
                                    {0}};
    TRY(options_parse(self, argc, argv, options, &c->settings));
    TRY(options_check_settings(&c->settings));
    c->options.settings = &c->settings.values;
    if (argc - optind > 1 || (argc == optind && !part_options_any(&c->parts)))
        return options_fail(self, "expected one file, got %d", argc - optind);
    TRY(part_options_settle(&c->parts, self, argv + optind, argc - optind));
    TRY(set_stamp_size(c));
    const bool exposure = c->parts.given[SHEAR_PART_IMAGE] != NULL;
    return c->options.chip != NULL && (!exposure || c->stamps_given)
               ? options_fail(self, "--chip shows a chip of an exposure: give --image, no stamps")
               : EXIT_CODE_DONE;
}

static bool are_settings_given(const option_settings *s) {
    return memchr(s->given, true, sizeof s->given) != NULL;
}

/* Return the input's base name without .gz, .fz, .fits, with ".png" appended: a path in the current
 * directory, to be freed by the caller. NULL if out of memory. */
static char *default_output(const char *path) {
    static const char *const endings[] = {".gz", ".fz", ".fits", ".fit"};
    const char *slash = strrchr(path, '/');
    const char *base = slash != NULL ? slash + 1 : path;
    size_t length = strlen(base);
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        const size_t ending = strlen(endings[i]);
        if (length > ending && strncmp(base + length - ending, endings[i], ending) == 0)
            length -= ending;
    }
    char *out = NULL;
    return asprintf(&out, "%.*s.png", (int)length, base) < 0 ? NULL : out;
}

/* Reject options that do not apply to a catalog. */
static enum exit_code refuse_field_options(const plot_command *c) {
    if (c->stamps_given || are_settings_given(&c->settings)) {
        return message_fail(
            EXIT_CODE_USAGE, "plot the field file to see its stamps, or leave these options out",
            "%s is a catalog: it has no stamps, and was measured with settings of its own",
            c->path);
    }
    return EXIT_CODE_DONE;
}

static enum exit_code draw_catalog(shear_figure **figure, const plot_command *c,
                                   const shear_error *as_field) {
    shear_error err = {0};
    CLEANUP(shear_catalog_table_release) shear_catalog_table *table = NULL;
    if (shear_catalog_read(&table, c->path, &err) != 0) {
        if (err.code != SHEAR_E_FORMAT)
            return message_error(&err);
        return message_fail(EXIT_CODE_INPUT, "\"shearctl validate\" lists what is in a field file",
                            "%s is neither a field file (%s) nor a result catalog (%s)", c->path,
                            as_field->message, err.message);
    }
    TRY(refuse_field_options(c));
    return plot_catalog(figure, table, &err) != 0 ? message_error(&err) : EXIT_CODE_DONE;
}

static int draw_field(shear_figure **figure, shear_field *field, const plot_command *c,
                      shear_error *err) {
    return shear_field_chips(field) > 0 && !c->stamps_given
               ? plot_chip(figure, field, &c->options, err)
               : plot_sheet(figure, field, &c->options, err);
}

/* Draw the input as a field or as a catalog, whichever it can be opened as. */
static enum exit_code draw(shear_figure **figure, const plot_command *c) {
    shear_error err = {0};
    shear_field *field = NULL;
    const int code = shear_field_open_input(&field, &c->input, NULL, &err);
    if (code == SHEAR_E_FORMAT && c->input.path != NULL)
        return draw_catalog(figure, c, &err);
    if (field != NULL && draw_field(figure, field, c, &err) != 0)
        shear_prefix(&err, err.code, "%s", c->path);
    shear_field_close(field);
    return err.code != 0 ? message_error(&err) : EXIT_CODE_DONE;
}

static bool are_same_file(const char *one, const char *other) {
    struct stat a;
    struct stat b;
    return stat(one, &a) == 0 && stat(other, &b) == 0 && a.st_dev == b.st_dev &&
           a.st_ino == b.st_ino;
}

/* Return whether `out` is an input file, which --force must not overwrite. */
static bool is_input(const char *out, const shear_input *input) {
    bool any = input->path != NULL && are_same_file(out, input->path);
    for (int i = 0; i < SHEAR_N_PARTS; i++)
        any = any || (input->parts[i].path != NULL && are_same_file(out, input->parts[i].path));
    return any;
}

/* Save the figure and print its path. Returns an exit code; on failure an error has been printed.
 */
static enum exit_code save(shear_figure *figure, const plot_command *c) {
    shear_error err = {0};
    char shown[4200];
    CLEANUP(release_free) char *out = c->out != NULL ? strdup(c->out) : default_output(c->path);
    if (out == NULL)
        return message_no_memory();
    if (is_input(out, &c->input)) {
        return message_fail(EXIT_CODE_USAGE, "-o names another file", "%s is the input itself",
                            out);
    }
    const int code = shear_figure_save(figure, out, c->force, &err);
    if (code == SHEAR_E_EXISTS) {
        return message_fail(EXIT_CODE_OTHER, "--force replaces it, -o names another", "%s",
                            err.message);
    }
    if (code != SHEAR_OK) {
        message_error(&err);
        return EXIT_CODE_OTHER;
    }
    return puts(message_clean(out, shown, sizeof shown)) < 0 ? EXIT_CODE_OTHER : EXIT_CODE_DONE;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    plot_command c = {.parts = PART_OPTIONS_INIT,
                      .options = {.stamp = -1, .n_stamps = PLOT_DEFAULT_STAMPS}};
    CLEANUP(shear_figure_release) shear_figure *figure = NULL;
    CLEANUP(part_input_deinit) part_input parts = {0};
    shear_error err = {0};
    TRY(parse(self, argc, argv, &c));
    c.input = shear_input_of_file(argv[optind]);
    c.input.mosaic = c.parts.mosaic;
    if (part_options_any(&c.parts)) {
        if (part_input_init(&parts, &c.parts, false, &err) != SHEAR_OK)
            return message_error(&err);
        c.input = parts.input;
    }
    c.path = shear_input_name(&c.input);
    TRY(draw(&figure, &c));
    return save(figure, &c);
}

COMMAND(plot, "draw a picture (PNG) of a field file, an exposure or a result catalog", run, NULL);
