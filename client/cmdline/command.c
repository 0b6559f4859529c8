/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/command.h"

#include "cmdline/options.h"
#include "terminal/message.h"

#include <string.h>

enum { MAX_COMMANDS = 32 };

const command *command_find(const char *name) {
    const char *names[MAX_COMMANDS + 1] = {NULL};
    size_t n = 0;
    for (const command *const *c = command_table(); *c != NULL && n < MAX_COMMANDS; c++) {
        if (strcmp((*c)->name, name) == 0) {
            return *c;
        }
        names[n++] = (*c)->name;
    }
    const char *nearest = options_nearest(name, names);
    char hint[96] = "\"shearctl help\" lists the subcommands";
    if (nearest != NULL) {
        snprintf(hint, sizeof hint, "did you mean \"shearctl %s\"?", nearest);
    }
    message_fail(hint, "unknown subcommand \"%s\"", name);
    return NULL;
}

void command_print_usage(const command *self, void (*settings)(FILE *out), FILE *out) {
    static const char mark[] = COMMAND_SETTINGS_MARK "\n";
    const char *text = self->usage;
    for (const char *at; (at = strstr(text, mark)); text = at + strlen(mark)) {
        fwrite(text, 1, (size_t)(at - text), out);
        settings(out);
    }
    fputs(text, out);
    size_t length = strlen(text);
    if (length > 0 && text[length - 1] != '\n') {
        fputc('\n', out);
    }
}

void command_print_list(FILE *out) {
    fputs("usage: shearctl SUBCOMMAND [OPTION...] [FILE...]\n\n"
          "Weak-lensing shear from galaxy stamps (Zhang 2010).\n\n",
          out);
    for (const command *const *c = command_table(); *c; c++) {
        fprintf(out, "  %-10s %s\n", (*c)->name, (*c)->summary);
    }
    fputs("\n\"shearctl help SUBCOMMAND\" explains one; shearctl(1) is the manual.\n", out);
}
