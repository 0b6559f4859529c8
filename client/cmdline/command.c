/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/command.h"

#include "base/spelling.h"
#include "terminal/message.h"

#include <assert.h>
#include <string.h>

static const command *const *all;

void command_set_table(const command *const *table) {
    all = table;
}

const command *const *command_table(void) {
    assert(all != NULL);
    return all;
}

const command *command_find(const char *name) {
    spelling meant = {.given = name};
    for (const command *const *c = command_table(); *c != NULL; c++) {
        if (strcmp((*c)->name, name) == 0)
            return *c;
        spelling_consider(&meant, (*c)->name);
    }
    char hint[96] = "\"shearctl help\" lists the subcommands";
    if (meant.best != NULL)
        snprintf(hint, sizeof hint, "did you mean \"shearctl %s\"?", meant.best);
    message_fail(EXIT_CODE_USAGE, hint, "unknown subcommand \"%s\"", name);
    return NULL;
}

void command_print_usage(const command *self, void (*settings)(FILE *out), FILE *out) {
    static const char mark[] = COMMAND_SETTINGS_MARK "\n";
    const char *text = self->usage;
    for (const char *at; (at = strstr(text, mark)) != NULL; text = at + strlen(mark)) {
        fwrite(text, 1, (size_t)(at - text), out);
        settings(out);
    }
    fputs(text, out);
    assert(text[0] == '\0' || text[strlen(text) - 1] == '\n');
}

void command_print_list(FILE *out) {
    fputs("usage: shearctl SUBCOMMAND [OPTION...] [FILE...]\n\n"
          "Weak-lensing shear from galaxy stamps (Zhang 2010).\n\n",
          out);
    for (const command *const *c = command_table(); *c != NULL; c++)
        fprintf(out, "  %-10s %s\n", (*c)->name, (*c)->summary);
    fputs("\n\"shearctl help SUBCOMMAND\" explains one; shearctl(1) is the manual.\n", out);
}
