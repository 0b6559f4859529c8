/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl expose: write a mock exposure of a camera with a known shear. */
#include "base/cleanup.h"
#include "commands/commands.h"
#include "commands/mock_options.h"
#include "shear_mocks/exposure.h"
#include "terminal/message.h"
#include "terminal/progress.h"

#include <inttypes.h>

static enum exit_code set_exposure(const option_entry *e, const char *value) {
    shear_error err = {0};
    return shear_mock_exposure_set(e->context, e->name, value, &err) != SHEAR_OK
               ? message_error(&err)
               : EXIT_CODE_DONE;
}

static void print_report(const shear_mock_exposure *e, const char *path,
                         const shear_mock_exposure_counts *n) {
    char clean[512];
    printf("wrote %s: %d chips of %dx%d px, %" PRId64 " galaxies, %" PRId64 " stars\n",
           message_clean(path, clean, sizeof clean), e->chips_x * e->chips_y, e->nx, e->ny,
           n->galaxies, n->stars);
    printf("true shear g1 = %g, g2 = %g on the sky, x to the West; %" PRId64 " bad pixels, %" PRId64
           " of them saturated\n",
           e->g1, e->g2, n->bad_pixels, n->saturated_pixels);
}

static int write_exposure(const shear_mock_exposure *e, const mock_options *o, shear_error *err) {
    shear_mock_exposure_counts counts = {0};
    progress *bar = progress_begin("expose", o->quiet);
    const shear_mock_write_options how = {.threads = (int)o->threads,
                                          .overwrite = o->force,
                                          .progress = progress_callback,
                                          .context = bar};
    const int code = shear_mock_exposure_write(e, o->path, &how, &counts, err);
    progress_end(bar);
    if (code == SHEAR_OK)
        print_report(e, o->path, &counts);
    return code;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    shear_mock_exposure e;
    mock_options o = {.quiet = false};
    shear_error err = {0};
    size_t n = 0;
    shear_mock_exposure_init(&e);
    const shear_mock_option *table = shear_mock_exposure_options(&n);
    TRY(mock_options_parse(self, argc, argv, table, n, set_exposure, &e, &o));
    return mock_options_exit_code(write_exposure(&e, &o, &err), &err);
}

/* A test compares the help with the table: every option must be listed with its default. */
COMMAND(expose, "make a mock exposure of a camera with a known shear", run, NULL);
