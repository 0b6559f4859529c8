/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Generate texts from the table of settings, on standard output; run by the build only.
 * "sheard-config-text sample" prints the commented sample file, "sheard-config-text manual PAGE.in"
 * the manual page with the settings in place of its comment line SETTINGS. */
#include "sheard/config.h"

#include <stdlib.h>
#include <string.h>

static const char marker[] = ".\\\" SETTINGS\n";

static int complain(const char *what, const shear_error *err) {
    fprintf(stderr, "sheard-config-text: %s: %s\n", what, err->message);
    return EXIT_FAILURE;
}

static int paste(FILE *page, shear_error *err) {
    char *line = NULL;
    size_t capacity = 0;
    int code = SHEAR_OK;
    bool found = false;
    while (code == SHEAR_OK && getline(&line, &capacity, page) >= 0) {
        if (strcmp(line, marker) == 0) {
            found = true;
            code = sheard_config_print_manual(stdout, err);
        } else {
            fputs(line, stdout);
        }
    }
    free(line);
    if (code == SHEAR_OK && !found)
        code = shear_fail(err, SHEAR_E_FORMAT, NULL, "has no line for the settings");
    return code;
}

static int manual(const char *path) {
    shear_error err = {0};
    FILE *page = fopen(path, "r");
    if (page == NULL) {
        perror(path);
        return EXIT_FAILURE;
    }
    int code = paste(page, &err);
    fclose(page);
    return code == SHEAR_OK ? EXIT_SUCCESS : complain(path, &err);
}

static int sample(void) {
    shear_error err = {0};
    return sheard_config_print_sample(stdout, &err) == SHEAR_OK ? EXIT_SUCCESS
                                                                : complain("sample", &err);
}

int main(int argc, char **argv) {
    int status = EXIT_FAILURE;
    if (argc == 2 && strcmp(argv[1], "sample") == 0) {
        status = sample();
    } else if (argc == 3 && strcmp(argv[1], "manual") == 0) {
        status = manual(argv[2]);
    } else {
        fputs("usage: sheard-config-text sample | manual PAGE.in\n", stderr);
    }
    return fclose(stdout) == 0 ? status : EXIT_FAILURE;
}
