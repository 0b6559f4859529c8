/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Generate texts from the table of settings, on standard output; run by the build only.
 * "sheard-config-text sample" prints the commented sample file, "sheard-config-text manual PAGE.in"
 * the manual page with the settings in place of its comment line SETTINGS. */
#include "sheard/config.h"

#include "base/cleanup.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const char marker[] = ".\\\" SETTINGS\n";

static int paste(FILE *page, shear_error *err) {
    CLEANUP(release_free) char *line = NULL;
    size_t capacity = 0;
    bool found = false;
    while (getline(&line, &capacity, page) >= 0) {
        if (strcmp(line, marker) == 0) {
            found = true;
            TRY(sheard_config_print_manual(stdout, err));
        } else {
            fputs(line, stdout);
        }
    }
    return found ? SHEAR_OK : shear_fail(err, SHEAR_E_FORMAT, NULL, "has no line for the settings");
}

static int manual(const char *path, shear_error *err) {
    CLEANUP(release_file) FILE *page = fopen(path, "r");
    return page != NULL ? paste(page, err)
                        : shear_fail(err, SHEAR_E_IO, NULL, "%s", strerror(errno));
}

int main(int argc, char **argv) {
    shear_error err;
    int code = SHEAR_OK;
    if (argc == 2 && strcmp(argv[1], "sample") == 0) {
        code = sheard_config_print_sample(stdout, &err);
    } else if (argc == 3 && strcmp(argv[1], "manual") == 0) {
        code = manual(argv[2], &err);
    } else {
        fputs("usage: sheard-config-text sample | manual PAGE.in\n", stderr);
        return EXIT_FAILURE;
    }
    if (code != SHEAR_OK)
        fprintf(stderr, "sheard-config-text: %s: %s\n", argv[argc - 1], err.message);
    return fclose(stdout) == 0 && code == SHEAR_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
