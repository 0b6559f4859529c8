/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear-paper: the experiments of Zhang (2010), and others that go beyond it. */
#include "engine/must.h"
#include "experiments/list.h"
#include "report/run.h"

#include <locale.h>
#include <stdio.h>
#include <string.h>

/* in the order of the paper */
static const experiment *const experiments[] = {
    &experiment_noise,      &experiment_images,
    &experiment_single,     &experiment_pixels,
    &experiment_overall,    &experiment_shot,
    &experiment_bias,       &experiment_errors,
    &experiment_efficiency, &experiment_survey,
    &experiment_precision,  &experiment_narrow,
    &experiment_selection,  NULL,
};

static void print_list(FILE *out) {
    fputs("usage: shear-paper EXPERIMENT [OPTION...]\n       shear-paper help EXPERIMENT\n\n", out);
    for (const experiment *const *e = experiments; *e != NULL; e++)
        fprintf(out, "  %-12s %s\n", (*e)->name, (*e)->summary);
    fputs("\nEach leaves NAME.ecsv and NAME.png in the folder --out, and a state from which a run "
          "that\n"
          "was stopped goes on.\n",
          out);
}

static const experiment *find(const char *name) {
    for (const experiment *const *e = experiments; *e != NULL; e++) {
        if (strcmp((*e)->name, name) == 0)
            return *e;
    }
    must_fail(SHEAR_E_SETTING, NULL, "no experiment is called '%s'", name);
}

static bool is_help(const char *argument) {
    return strcmp(argument, "--help") == 0 || strcmp(argument, "-h") == 0;
}

static void run_experiment(const experiment *e, int argc, char **argv) {
    options o;
    run r;
    options_parse(&o, e, argc, argv);
    run_begin(&r, &o);
    e->run(&r);
    run_end(&r);
}

int main(int argc, char **argv) {
    setlocale(LC_CTYPE, "");
    bool help = argc > 1 && strcmp(argv[1], "help") == 0;
    const char *name = help ? argv[2] : argv[1];
    if (argc < 2 || name == NULL || is_help(name) || strcmp(name, "help") == 0) {
        print_list(stdout);
        return EXIT_CODE_DONE;
    }
    const experiment *e = find(name);
    for (int i = 2; i < argc; i++)
        help = help || is_help(argv[i]);
    if (help) {
        options_help(e, stdout);
    } else {
        run_experiment(e, argc - 1, argv + 1);
    }
    return EXIT_CODE_DONE;
}
