/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read a configuration from all its sources, or check it for an administrator. */
#include "origin.h"
#include "sheard/config.h"

static void assign_all(sheard_config *config, const sheard_list *assignments,
                       sheard_problems *problems) {
    for (size_t i = 0; assignments != NULL && i < assignments->n; i++) {
        shear_error error;
        if (sheard_config_assign(config, assignments->items[i], &error) != SHEAR_OK)
            (void)problems_add(problems, "command line", &error);
    }
}

int sheard_config_read(sheard_config *config, const char *path, const sheard_list *assignments,
                       sheard_problems *problems) {
    shear_error error;
    size_t before = problems->n_errors;
    if (sheard_config_init(config, &error) != SHEAR_OK)
        return problems_add(problems, "default", &error);
    (void)sheard_config_load(config, path, problems);
    assign_all(config, assignments, problems);
    if (problems->n_errors == before)
        (void)sheard_config_check(config, problems);
    if (problems->n_errors == before)
        return SHEAR_OK;
    sheard_config_deinit(config);
    return sheard_problems_error(problems, &error);
}

static const char *plural(size_t n) {
    return n == 1 ? "" : "s";
}

size_t sheard_config_check_file(const char *path, const sheard_list *assignments, FILE *out) {
    sheard_config config;
    sheard_problems problems = {0};
    if (sheard_config_read(&config, path, assignments, &problems) == SHEAR_OK) {
        sheard_config_warnings(&config, &problems);
        sheard_config_deinit(&config);
    }
    sheard_problems_print(&problems, out);
    fprintf(out, "%s: ", path != NULL ? path : sheard_config_default_path());
    if (problems.n_errors > 0) {
        fprintf(out, "%zu error%s\n", problems.n_errors, plural(problems.n_errors));
    } else if (problems.n_warnings > 0) {
        fprintf(out, "good, with %zu warning%s\n", problems.n_warnings,
                plural(problems.n_warnings));
    } else {
        fputs("good\n", out);
    }
    return problems.n_errors;
}
