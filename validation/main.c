/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear-paper: the experiments of Zhang (2010), and some that go beyond it. */
#include "engine/experiment.h"

#include <locale.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const experiment *const table[] = {
    &exp_noise,     &exp_images, &exp_single,     &exp_pixels, &exp_overall,   &exp_shot,
    &exp_bias,      &exp_errors, &exp_efficiency, &exp_survey, &exp_precision, &exp_narrow,
    &exp_selection, NULL,
};

const experiment *const *experiment_table(void) {
    return table;
}

static void print_list(FILE *out) {
    fputs("usage: shear-paper EXPERIMENT [OPTION...]\n       shear-paper help EXPERIMENT\n\n", out);
    for (const experiment *const *e = table; *e; e++) {
        fprintf(out, "  %-12s %s\n", (*e)->name, (*e)->summary);
    }
    fputs("\nEach leaves NAME.ecsv and NAME.png in the folder --out, and a state from which a run "
          "that\n"
          "was stopped goes on.\n",
          out);
}

static void print_error(const shear_error *err) {
    fprintf(stderr, "shear-paper: error: %s\n", err->message);
    if (err->advice[0]) {
        fprintf(stderr, "  %s\n", err->advice);
    }
}

static const experiment *find(const char *name) {
    for (const experiment *const *e = table; *e; e++) {
        if (strcmp((*e)->name, name) == 0) {
            return *e;
        }
    }
    fprintf(stderr, "shear-paper: error: no experiment is called '%s'\n", name);
    return NULL;
}

static bool asks_for_help(int argc, char **argv) {
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            return true;
        }
    }
    return false;
}

static int run(const experiment *e, int argc, char **argv) {
    struct request request;
    shear_error err = {0};
    int code = request_parse(&request, e, argc, argv, &err);
    if (code == SHEAR_OK) {
        code = e->exec(&request, &err);
    }
    if (code != SHEAR_OK) {
        print_error(&err);
    }
    return code == SHEAR_OK          ? EXIT_CODE_DONE
           : code == SHEAR_E_SETTING ? EXIT_CODE_USAGE
                                     : EXIT_CODE_OTHER;
}

int main(int argc, char **argv) {
    setlocale(LC_CTYPE, "");
    bool help = argc > 1 && strcmp(argv[1], "help") == 0;
    const char *name = help && argc > 2 ? argv[2] : argc > 1 ? argv[1] : "help";
    if (strcmp(name, "help") == 0 || strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        print_list(stdout);
        return EXIT_CODE_DONE;
    }
    const experiment *e = find(name);
    if (e == NULL) {
        return EXIT_CODE_USAGE;
    }
    if (help || asks_for_help(argc - 1, argv + 1)) {
        request_help(e, stdout);
        return EXIT_CODE_DONE;
    }
    return run(e, argc - 1, argv + 1);
}
