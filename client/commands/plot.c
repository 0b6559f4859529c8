/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl plot: draw a field file or a result catalog. */
#include "plot/plot.h"
#include "base/cleanup.h"
#include "cmdline/options.h"
#include "commands/commands.h"
#include "local/measure_input.h"
#include "terminal/message.h"

#include <getopt.h>
#include <string.h>
#include <sys/stat.h>

typedef struct plot_command {
    const char *path;
    const char *out; /* NULL: derived from the input's name */
    bool force;
    bool stamps_given; /* valid only for a field file, like settings */
    option_settings settings;
    plot_options options;
} plot_command;

CLEANUP_DEFINE(shear_catalog_table, shear_catalog_table_free)

static enum exit_code parse(const command *self, int argc, char **argv, plot_command *c) {
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
                                    {.name = "force", .flag = &c->force},
                                    {0}};
    TRY(options_parse(self, argc, argv, options, &c->settings));
    TRY(options_check_settings(&c->settings));
    if (argc - optind != 1)
        return options_fail(self, "expected one file, got %d", argc - optind);
    c->options.settings = &c->settings.values;
    c->path = argv[optind];
    return EXIT_CODE_DONE;
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

/* Draw the file as a field file or as a catalog, whichever it can be opened as. */
static enum exit_code draw(shear_figure **figure, const plot_command *c) {
    shear_error err = {0};
    shear_field *field = NULL;
    if (shear_field_open(&field, c->path, &err) == SHEAR_E_FORMAT)
        return draw_catalog(figure, c, &err);
    if (field != NULL && plot_sheet(figure, field, &c->options, &err) != 0)
        shear_prefix(&err, err.code, "%s", c->path);
    shear_field_close(field);
    return err.code != 0 ? message_error(&err) : EXIT_CODE_DONE;
}

/* Return whether `out` is the input file, which --force must not overwrite. */
static bool is_input(const char *out, const char *path) {
    struct stat a;
    struct stat b;
    return stat(out, &a) == 0 && stat(path, &b) == 0 && a.st_dev == b.st_dev &&
           a.st_ino == b.st_ino;
}

/* Save the figure and print its path. Returns an exit code; on failure an error has been printed.
 */
static enum exit_code save(shear_figure *figure, const plot_command *c) {
    shear_error err = {0};
    char shown[4200];
    CLEANUP(release_free) char *out = c->out != NULL ? strdup(c->out) : default_output(c->path);
    if (out == NULL)
        return message_no_memory();
    if (is_input(out, c->path)) {
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
    plot_command c = {.options = {.stamp = -1, .n_stamps = PLOT_DEFAULT_STAMPS}};
    CLEANUP(shear_figure_release) shear_figure *figure = NULL;
    TRY(parse(self, argc, argv, &c));
    TRY(draw(&figure, &c));
    return save(figure, &c);
}

COMMAND(plot, "draw a picture (PNG) of a field file or of a result catalog", run, NULL);
