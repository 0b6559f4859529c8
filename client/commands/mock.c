/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl mock: write a field file of mock galaxies with a known shear. */
#include "shear_mocks/mock.h"
#include "base/cleanup.h"
#include "cmdline/options.h"
#include "commands/commands.h"
#include "terminal/message.h"
#include "terminal/progress.h"

#include <assert.h>
#include <inttypes.h>
#include <sys/stat.h>

enum { MAX_THREADS = 1024, MAX_OPTIONS = 64, N_OWN = 3 };

typedef struct mock_options {
    shear_mock_spec spec;
    int64_t threads;
    bool force, quiet;
    const char *path;
} mock_options;

CLEANUP_DEFINE(shear_mock, shear_mock_free)

static enum exit_code set_mock(const option_entry *e, const char *value) {
    shear_error err = {0};
    return shear_mock_set(e->context, e->name, value, &err) != SHEAR_OK ? message_error(&err)
                                                                        : EXIT_CODE_DONE;
}

static enum exit_code parse(const command *self, int argc, char **argv, mock_options *o) {
    size_t n = 0;
    const shear_mock_option *table = shear_mock_options(&n);
    option_entry options[MAX_OPTIONS] = {
        {.name = "threads", .integer = &o->threads, .min = 1, .max = MAX_THREADS},
        {.name = "force", .flag = &o->force},
        {.name = "quiet", .flag = &o->quiet}};
    assert(N_OWN + n < MAX_OPTIONS);
    for (size_t i = 0; i < n; i++) {
        options[N_OWN + i] = (option_entry){.name = table[i].name,
                                            .set = set_mock,
                                            .context = &o->spec,
                                            .bare = table[i].metavar == NULL};
    }
    TRY(options_parse(self, argc, argv, options, NULL));
    if (argc - optind != 1)
        return options_fail(self, "expected one output file, got %d", argc - optind);
    o->path = argv[optind];
    return EXIT_CODE_DONE;
}

static const char *rotations(int rotate) {
    return rotate == 2   ? ", each at 0 and 90 degrees"
           : rotate == 4 ? ", each at 0, 45, 90 and 135 degrees"
                         : "";
}

static void print_report(const mock_options *o, const shear_mock_info *info) {
    const shear_mock_spec *s = &o->spec;
    struct stat st = {0};
    char path[512];
    double megabytes = stat(o->path, &st) == 0 ? (double)st.st_size * 1e-6 : 0.0;
    printf("wrote %s: %" PRId64 " stamp pairs of %dx%d px, %.1f MB\n",
           message_clean(o->path, path, sizeof path), info->n_stamps, s->nx, s->ny, megabytes);
    printf("true shear g1 = %g, g2 = %g; %" PRId64 " %s galaxies%s\n", s->g1, s->g2,
           info->n_galaxies, s->galaxy == SHEAR_MOCK_IRREGULAR ? "irregular" : "regular",
           rotations(s->rotate));
}

static int write_field(const mock_options *o, shear_error *err) {
    CLEANUP(shear_mock_release) shear_mock *m = NULL;
    TRY(shear_mock_new(&m, &o->spec, err));
    progress *bar = progress_begin("mock", o->quiet);
    const shear_mock_write_options how = {.threads = (int)o->threads,
                                          .overwrite = o->force,
                                          .progress = progress_callback,
                                          .context = bar};
    int code = shear_mock_write(m, o->path, &how, err);
    progress_end(bar);
    if (code != SHEAR_OK)
        return code;
    print_report(o, shear_mock_get_info(m));
    return SHEAR_OK;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    mock_options o = {.quiet = false};
    shear_error err = {0};
    shear_mock_spec_init(&o.spec);
    TRY(parse(self, argc, argv, &o));
    const int code = write_field(&o, &err);
    if (code != SHEAR_OK) {
        message_error(&err);
        return code == SHEAR_E_SETTING ? EXIT_CODE_USAGE : EXIT_CODE_OTHER;
    }
    return EXIT_CODE_DONE;
}

/* A test compares this text with the table: every option must be listed with its default. */
COMMAND(mock, "make a field file of mock galaxies with a known shear", run, NULL);
