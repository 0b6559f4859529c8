/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "commands/mock_options.h"

#include "base/cleanup.h"
#include "terminal/message.h"

#include <assert.h>
#include <getopt.h>

enum { MAX_THREADS = 1024, MAX_OPTIONS = 64, N_OWN = 3 };

enum exit_code mock_options_parse(const command *self, int argc, char **argv,
                                  const shear_mock_option *table, size_t n,
                                  enum exit_code (*set)(const option_entry *, const char *),
                                  void *spec, mock_options *o) {
    option_entry options[MAX_OPTIONS] = {
        {.name = "threads", .integer = &o->threads, .min = 1, .max = MAX_THREADS},
        {.name = "force", .flag = &o->force},
        {.name = "quiet", .flag = &o->quiet}};
    assert(N_OWN + n < MAX_OPTIONS);
    for (size_t i = 0; i < n; i++) {
        options[N_OWN + i] = (option_entry){
            .name = table[i].name, .set = set, .context = spec, .bare = table[i].metavar == NULL};
    }
    TRY(options_parse(self, argc, argv, options, NULL));
    if (argc - optind != 1)
        return options_fail(self, "expected one output file, got %d", argc - optind);
    o->path = argv[optind];
    return EXIT_CODE_DONE;
}

enum exit_code mock_options_exit_code(int code, const shear_error *err) {
    if (code == SHEAR_OK)
        return EXIT_CODE_DONE;
    message_error(err);
    return code == SHEAR_E_SETTING ? EXIT_CODE_USAGE : EXIT_CODE_OTHER;
}
