/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl mock: write a field file of mock galaxies with a known shear. */
#include "shear_mocks/mock.h"
#include "base/cleanup.h"
#include "commands/commands.h"
#include "commands/mock_options.h"
#include "terminal/message.h"
#include "terminal/progress.h"

#include <inttypes.h>
#include <sys/stat.h>

CLEANUP_DEFINE(shear_mock, shear_mock_free)

static enum exit_code set_mock(const option_entry *e, const char *value) {
    shear_error err = {0};
    return shear_mock_set(e->context, e->name, value, &err) != SHEAR_OK ? message_error(&err)
                                                                        : EXIT_CODE_DONE;
}

static const char *rotations(int rotate) {
    return rotate == 2   ? ", each at 0 and 90 degrees"
           : rotate == 4 ? ", each at 0, 45, 90 and 135 degrees"
                         : "";
}

static void print_report(const shear_mock_spec *s, const char *file, const shear_mock_info *info) {
    struct stat st = {0};
    char path[512];
    double megabytes = stat(file, &st) == 0 ? (double)st.st_size * 1e-6 : 0.0;
    printf("wrote %s: %" PRId64 " stamp pairs of %dx%d px, %.1f MB\n",
           message_clean(file, path, sizeof path), info->n_stamps, s->nx, s->ny, megabytes);
    printf("true shear g1 = %g, g2 = %g; %" PRId64 " %s galaxies%s\n", s->g1, s->g2,
           info->n_galaxies, s->galaxy == SHEAR_MOCK_IRREGULAR ? "irregular" : "regular",
           rotations(s->rotate));
}

static int write_field(const shear_mock_spec *s, const mock_options *o, shear_error *err) {
    CLEANUP(shear_mock_release) shear_mock *m = NULL;
    TRY(shear_mock_new(&m, s, err));
    progress *bar = progress_begin("mock", o->quiet);
    const shear_mock_write_options how = {.threads = (int)o->threads,
                                          .overwrite = o->force,
                                          .progress = progress_callback,
                                          .context = bar};
    int code = shear_mock_write(m, o->path, &how, err);
    progress_end(bar);
    if (code != SHEAR_OK)
        return code;
    print_report(s, o->path, shear_mock_get_info(m));
    return SHEAR_OK;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    shear_mock_spec spec;
    mock_options o = {.quiet = false};
    shear_error err = {0};
    size_t n = 0;
    shear_mock_spec_init(&spec);
    const shear_mock_option *table = shear_mock_options(&n);
    TRY(mock_options_parse(self, argc, argv, table, n, set_mock, &spec, &o));
    return mock_options_exit_code(write_field(&spec, &o, &err), &err);
}

/* A test compares this text with the table: every option must be listed with its default. */
COMMAND(mock, "make a field file of mock galaxies with a known shear", run, NULL);
