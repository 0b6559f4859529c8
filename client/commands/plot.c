/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl plot: a picture of a field file or of a result catalog. */
#include "plot/plot.h"
#include "cmdline/command.h"
#include "cmdline/options.h"
#include "cmdline/settings_options.h"
#include "cmdline/settings_parse.h"
#include "local/measure_input.h"
#include "terminal/message.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { OPT_OUT = 256, OPT_STAMP, OPT_STAMPS, OPT_FORCE };

static const struct option own_options[] = {
    {"output", required_argument, NULL, OPT_OUT},
    {"stamp", required_argument, NULL, OPT_STAMP},
    {"stamps", required_argument, NULL, OPT_STAMPS},
    {"force", no_argument, NULL, OPT_FORCE},
};
enum { N_OWN = sizeof own_options / sizeof own_options[0] };

typedef struct plot_command {
    const char *path;
    const char *out; /* or NULL: by the input's name */
    bool force;
    bool stamps_given, settings_given; /* only good for a field file */
    plot_options options;
} plot_command;

static int handle(int value, const char *argument, void *context) {
    plot_command *c = context;
    int64_t number = 0;
    int code = EXIT_CODE_DONE;
    switch (value) {
    case OPT_STAMP:
        code = options_int("stamp", argument, 0, INT64_MAX, &number);
        c->options.stamp = number;
        c->stamps_given = true;
        break;
    case OPT_STAMPS:
        code = options_int("stamps", argument, 1, PLOT_MAX_STAMPS, &number);
        c->options.n_stamps = (int)number;
        c->stamps_given = true;
        break;
    case OPT_FORCE:
        c->force = true;
        break;
    default:
        c->out = argument;
        break;
    }
    return code;
}

static int check_options(plot_command *c, int argc, char **argv) {
    if (argc - optind != 1) {
        message_fail("\"shearctl help plot\"", "plot: expected one file, got %d", argc - optind);
        return EXIT_CODE_USAGE;
    }
    c->path = argv[optind];
    return EXIT_CODE_DONE;
}

static int parse(int argc, char **argv, plot_command *c) {
    settings_parser p = {.self = &cmd_plot,
                         .own = own_options,
                         .n_own = N_OWN,
                         .letters = "o:",
                         .handle = handle,
                         .context = c,
                         .settings = &c->options.settings};
    const int code = settings_parse(&p, argc, argv);
    c->settings_given = p.given;
    return code != SHEAR_OK ? code : check_options(c, argc, argv);
}

/* The input's base name without .gz, .fz, .fits, in the current directory, ".png" added. The
 * caller frees it. */
static char *default_output(const char *path) {
    static const char *const endings[] = {".gz", ".fz", ".fits", ".fit"};
    const char *slash = strrchr(path, '/');
    const char *base = slash != NULL ? slash + 1 : path;
    size_t length = strlen(base);
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        const size_t ending = strlen(endings[i]);
        if (length > ending && strncmp(base + length - ending, endings[i], ending) == 0) {
            length -= ending;
        }
    }
    char *out = NULL;
    return asprintf(&out, "%.*s.png", (int)length, base) < 0 ? NULL : out;
}

/* Options that a catalog has no use for are a misunderstanding, to be told of. */
static int refuse_field_options(const plot_command *c) {
    if (c->stamps_given || c->settings_given) {
        message_fail("plot the field file to see its stamps, or leave these options out",
                     "%s is a catalog: it has no stamps, and was measured with settings of its "
                     "own",
                     c->path);
        return EXIT_CODE_USAGE;
    }
    return EXIT_CODE_DONE;
}

static int draw_catalog(shear_figure **figure, const plot_command *c, const shear_error *as_field) {
    shear_error err = {0};
    shear_catalog_table *table = NULL;
    if (shear_catalog_read(&table, c->path, &err) != 0) {
        if (err.code != SHEAR_E_FORMAT) {
            message_error(&err);
            return measure_failure_of(err.code, false);
        }
        message_fail("\"shearctl validate\" tells what is in a field file",
                     "%s is neither a field file (%s) nor a result catalog (%s)", c->path,
                     as_field->message, err.message);
        return EXIT_CODE_INPUT;
    }
    int code = refuse_field_options(c);
    if (code == SHEAR_OK && plot_catalog(figure, table, &err) != 0) {
        message_error(&err);
        code = measure_failure_of(err.code, false);
    }
    shear_catalog_table_free(table);
    return code;
}

/* What opens decides what the file is. */
static int draw(shear_figure **figure, const plot_command *c) {
    shear_error err = {0};
    shear_field *field = NULL;
    if (shear_field_open(&field, c->path, &err) == SHEAR_E_FORMAT) {
        return draw_catalog(figure, c, &err);
    }
    if (field != NULL && plot_sheet(figure, field, &c->options, &err) != 0) {
        shear_prefix(&err, err.code, "%s", c->path);
    }
    shear_field_close(field);
    if (err.code != 0) {
        message_error(&err);
    }
    return measure_failure_of(err.code, false);
}

/* --force must not cost the user his data. */
static bool is_input(const char *out, const char *path) {
    struct stat a;
    struct stat b;
    return stat(out, &a) == 0 && stat(path, &b) == 0 && a.st_dev == b.st_dev &&
           a.st_ino == b.st_ino;
}

static int save(shear_figure *figure, const plot_command *c) {
    shear_error err = {0};
    char *out = c->out != NULL ? strdup(c->out) : default_output(c->path);
    int code = EXIT_CODE_OTHER;
    if (out == NULL) {
        message_fail(NULL, "out of memory");
    } else if (is_input(out, c->path)) {
        message_fail("-o names another file", "%s is the input itself", out);
        code = EXIT_CODE_USAGE;
    } else if (shear_figure_save(figure, out, c->force, &err) != 0) {
        if (err.code == SHEAR_E_EXISTS) {
            message_fail("--force replaces it, -o names another", "%s", err.message);
        } else {
            message_error(&err);
        }
    } else {
        char shown[4200];
        code = puts(message_clean(out, shown, sizeof shown)) < 0 ? EXIT_CODE_OTHER : EXIT_CODE_DONE;
    }
    free(out);
    return code;
}

static int run(int argc, char **argv) {
    plot_command c = {.options = {.stamp = -1, .n_stamps = PLOT_DEFAULT_STAMPS}};
    shear_settings_init(&c.options.settings);
    int code = parse(argc, argv, &c);
    shear_figure *figure = NULL;
    if (code == SHEAR_OK) {
        code = draw(&figure, &c);
    }
    if (code == SHEAR_OK) {
        code = save(figure, &c);
    }
    shear_figure_free(figure);
    return code;
}

const command cmd_plot = {
    .name = "plot",
    .summary = "draw a picture (PNG) of a field file or of a result catalog",
    .usage =
        "usage: shearctl plot [options] FILE\n"
        "\n"
        "Of a field file: a sheet with some of its stamps, a row each, through every step of\n"
        "the measurement (galaxy, noise, interpolated, filtered, noise-corrected power\n"
        "spectrum, the same with the target PSF), and a row with the PSF, its transfer and\n"
        "the plan. Of a result catalog (shearctl measure --catalog): the distributions of\n"
        "the estimator's terms, the shear with its errors, the flags and the stamps' S/N.\n"
        "\n"
        "The path of the picture is printed.\n"
        "\n"
        "  -o, --output PNG   where it goes; default: FILE's base name with .png, here\n"
        "  --force            replace an existing picture\n"
        "  --stamp I          show stamp I only (from 0), usable or not\n"
        "  --stamps N         show N of the usable stamps, evenly spaced (1 to 12, default 4)\n"
        "\n"
        "The sheet shows the measurement with these settings:\n"
        "\n" COMMAND_SETTINGS_MARK "\n",
    .run = run,
};
