/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cmdline/completion.h"

#include "base/cleanup.h"
#include "cmdline/settings_options.h"
#include "terminal/message.h"

#include <stdbool.h>
#include <string.h>

enum { TEXT_MAX = 256 };

/* Print `n` bytes of text as a field: without '|', with single spaces. */
static void field(FILE *out, const char *text, size_t n) {
    bool space = false;
    for (size_t i = 0; i < n; i++) {
        if (text[i] == ' ') {
            space = true;
            continue;
        }
        if (space)
            fputc(' ', out);
        space = false;
        fputc(text[i] == '|' ? ',' : text[i], out);
    }
}

/* Print the choices: "none bilinear bicubic" of a setting, "a b" for the metavar "a|b". */
static void choices(FILE *out, const char *option, const char *metavar, size_t length) {
    const shear_setting_def *def = shear_settings_find(option);
    if (def != NULL && def->type == SHEAR_T_CHOICE && strncmp(metavar, def->metavar, length) == 0) {
        for (const char *const *c = def->choices; *c != NULL; c++)
            fprintf(out, "%s%s", c == def->choices ? "" : " ", *c);
    } else if (memchr(metavar, '|', length) != NULL) {
        for (size_t i = 0; i < length; i++)
            fputc(metavar[i] == '|' ? ' ' : metavar[i], out);
    }
}

/* Print one "--NAME METAVAR" of a help line. */
static void print_option(const char *self, const char *flag, size_t length, const char *help,
                         FILE *out) {
    char name[TEXT_MAX];
    const size_t word = strcspn(flag, " ,\n") < length ? strcspn(flag, " ,\n") : length;
    const char *metavar = flag + word + (word < length);
    const size_t rest = length - (size_t)(metavar - flag);
    snprintf(name, sizeof name, "%.*s", (int)word, flag);
    fprintf(out, "option|%s|%s|", self, name);
    field(out, metavar, rest);
    fputc('|', out);
    choices(out, name + 2, metavar, rest);
    fputc('|', out);
    field(out, help, strcspn(help, "\n"));
    fputc('\n', out);
}

/* "  -o, --output PNG   help", "  --a, --no-a", "  --name METAVAR" with its help on the next line.
 */
static void print_line(const char *self, const char *line, FILE *out) {
    const size_t n = strcspn(line, "\n");
    const char *gap = strstr(line + 2, "  ");
    const bool has_help = gap != NULL && gap < line + n;
    const size_t flags = has_help ? (size_t)(gap - line) : n;
    const char *help = has_help ? gap : line[n] != '\0' ? line + n + 1 : "";
    for (const char *at = line; (at = strstr(at, "--")) && at < line + flags; at += 2) {
        size_t length = (size_t)(line + flags - at);
        const char *comma = memchr(at, ',', length);
        if (comma != NULL && strncmp(comma, ", --", 4) == 0)
            length = (size_t)(comma - at);
        print_option(self, at, length, help, out);
    }
}

void completion_options(const char *name, const char *usage, FILE *out) {
    for (const char *line = usage; *line != '\0';) {
        if (strncmp(line, "  -", 3) == 0)
            print_line(name, line, out);
        const char *end = strchr(line, '\n');
        line = end != NULL ? end + 1 : line + strlen(line);
    }
    fprintf(out, "option|%s|--help|||explain this subcommand\n", name);
}

/* Print the text after "usage: shearctl NAME" on the first line, without "[OPTION...] ". */
static void print_command(const command *c, FILE *out) {
    static const char options[] = "[OPTION...]";
    const char *line = c->usage + strlen("usage: shearctl ") + strlen(c->name);
    const char *end = line + strcspn(line, "\n");
    const char *at = strstr(line, options);
    at = at != NULL && at < end ? at + strlen(options) : line;
    fprintf(out, "command|%s|", c->name);
    at += strspn(at, " ");
    field(out, at, at < end ? (size_t)(end - at) : 0);
    fprintf(out, "|%s\n", c->summary);
}

static enum exit_code print_one(const command *self, FILE *out) {
    CLEANUP(release_free) char *text = NULL;
    size_t size = 0;
    FILE *usage = open_memstream(&text, &size);
    if (usage == NULL)
        return message_no_memory();
    command_print_usage(self, settings_options_help, usage);
    if (fclose(usage) != 0 || text == NULL)
        return message_no_memory();
    print_command(self, out);
    completion_options(self->name, text, out);
    return EXIT_CODE_DONE;
}

enum exit_code completion_data_print(FILE *out) {
    for (const command *const *c = command_table(); *c != NULL; c++)
        TRY(print_one(*c, out));
    return EXIT_CODE_DONE;
}
