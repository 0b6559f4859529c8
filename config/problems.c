/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collect, print and summarize the problems of a configuration. */
#include "base/text.h"
#include "origin.h"

#include <assert.h>
#include <string.h>

static void keep(sheard_problems *problems, const char *where, bool is_warning,
                 const shear_error *error) {
    if (problems->n_kept == SHEARD_PROBLEMS_KEPT)
        return;
    sheard_problem *p = &problems->kept[problems->n_kept++];
    snprintf(p->where, sizeof p->where, "%s", where);
    p->is_warning = is_warning;
    p->error = *error;
}

int problems_add(sheard_problems *problems, const char *where, const shear_error *error) {
    problems->n_errors++;
    keep(problems, where, false, error);
    return error->code;
}

void problems_warn(sheard_problems *problems, const sheard_config *config, size_t index,
                   const char *advice, const char *format, ...) {
    char where[sizeof problems->kept[0].where];
    shear_error warning = {0};
    va_list args;
    va_start(args, format);
    vsnprintf(warning.message, sizeof warning.message, format, args);
    va_end(args);
    snprintf(warning.advice, sizeof warning.advice, "%s", advice != NULL ? advice : "");
    problems->n_warnings++;
    keep(problems, config_where(config, index, where, sizeof where), true, &warning);
}

char *place_in_file(const char *path, int line, char *buf, size_t size) {
    char number[16] = "";
    if (line > 0)
        snprintf(number, sizeof number, ":%d", line);
    const size_t capacity = size - strlen(number) - 1;
    size_t length = strlen(path);
    bool cut = length > capacity;
    snprintf(buf, size, "%s%s%s", cut ? "..." : "", cut ? path + (length - capacity + 3) : path,
             number);
    return buf;
}

char *config_where(const sheard_config *config, size_t index, char *buf, size_t size) {
    int line = config->lines[index];
    if (line > 0)
        return place_in_file(config->path, line, buf, size);
    static const char *const others[] = {"default", "command line", "earlier configuration"};
    assert(line >= ORIGIN_EARLIER);
    snprintf(buf, size, "%s", others[-line]);
    return buf;
}

void sheard_problems_print(const sheard_problems *problems, FILE *out) {
    for (size_t i = 0; i < problems->n_kept; i++) {
        const sheard_problem *p = &problems->kept[i];
        fprintf(out, "%s: %s: %s\n", p->where, p->is_warning ? "warning" : "error",
                p->error.message);
        if (p->error.advice[0] != '\0')
            fprintf(out, "    %s\n", p->error.advice);
    }
    size_t left_out = problems->n_errors + problems->n_warnings - problems->n_kept;
    if (left_out > 0)
        fprintf(out, "... and %zu more\n", left_out);
}

static const sheard_problem *first_error(const sheard_problems *problems) {
    for (size_t i = 0; i < problems->n_kept; i++) {
        if (!problems->kept[i].is_warning)
            return &problems->kept[i];
    }
    return NULL;
}

int sheard_problems_error(const sheard_problems *problems, shear_error *err) {
    if (problems->n_errors == 0)
        return SHEAR_OK;
    const sheard_problem *p = first_error(problems);
    if (p == NULL) { /* the errors came after as many warnings as are kept */
        return shear_fail(err, SHEAR_E_SETTING, "sheard --check-config lists them",
                          "the configuration has %zu errors", problems->n_errors);
    }
    char more[40] = "";
    if (problems->n_errors > 1)
        snprintf(more, sizeof more, " (and %zu more)", problems->n_errors - 1);
    return shear_fail(err, p->error.code, p->error.advice, "%s: %.240s%s", p->where,
                      p->error.message, more);
}
