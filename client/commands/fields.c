/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl fields: all fields, a line each. */
#include "cmdline/options.h"
#include "remote/field_table.h"
#include "remote/service.h"
#include "terminal/human.h"
#include "terminal/message.h"
#include "terminal/style.h"

#include <stdlib.h>
#include <string.h>

enum { OPT_LIMIT = 256, OPT_CURSOR, OPT_BRIEF };

static const struct option options[] = {
    {"limit", required_argument, NULL, OPT_LIMIT},
    {"cursor", required_argument, NULL, OPT_CURSOR},
    {"brief", no_argument, NULL, OPT_BRIEF},
    SERVICE_OPTIONS,
    {NULL, 0, NULL, 0},
};

typedef struct fields_options {
    service service;
    sheard_params params;
    int64_t limit; /* fields that are still to be listed */
    bool brief;
} fields_options;

static int handle(int value, void *context) {
    fields_options *f = context;
    switch (value) {
    case OPT_LIMIT:
        return options_int("limit", optarg, 1, INT64_MAX, &f->limit);
    case OPT_CURSOR:
        f->params.fields.cursor = optarg;
        return EXIT_CODE_DONE;
    default:
        f->brief = true;
        return EXIT_CODE_DONE;
    }
}

/* A field that has several rows is named once. */
static void print_names(const sheard_msg_field_page *page) {
    char name[256];
    for (size_t i = 0; i < page->n_fields; i++) {
        if (i == 0 || strcmp(page->fields[i].field, page->fields[i - 1].field) != 0) {
            puts(message_clean(page->fields[i].field, name, sizeof name));
        }
    }
}

static void show_page(const fields_options *f, const sheard_msg_field_page *page,
                      text_table *table) {
    if (f->service.json) {
        return;
    }
    if (f->brief) {
        print_names(page);
        return;
    }
    for (size_t i = 0; i < page->n_fields; i++) {
        field_table_add(table, &page->fields[i], human_now_ms());
    }
}

/* All pages, up to the limit. *cursor becomes the one of the next page, or NULL: the caller's. */
static int list(fields_options *f, text_table *table, char **cursor) {
    int code = EXIT_CODE_DONE;
    bool empty = false; /* a page: no progress would be made */
    sheard_msg_fields *p = &f->params.fields;
    do {
        sheard_reply reply = {0};
        p->limit = f->limit < SHEARD_MSG_FIELDS_PAGE ? f->limit : SHEARD_MSG_FIELDS_PAGE;
        code = service_answer(&f->service, SHEARD_METHOD_FIELDS, &f->params, &reply);
        free(*cursor);
        *cursor = NULL;
        if (code == SHEAR_OK) {
            show_page(f, &reply.fields, table);
            f->limit -= (int64_t)reply.fields.n_fields;
            empty = reply.fields.n_fields == 0;
            *cursor = reply.fields.cursor != NULL ? strdup(reply.fields.cursor) : NULL;
            p->cursor = *cursor;
            sheard_reply_deinit(&reply, SHEARD_METHOD_FIELDS);
        }
    } while (code == SHEAR_OK && *cursor != NULL && !empty && f->limit > 0);
    return code;
}

static int run(int argc, char **argv) {
    fields_options f = {.limit = INT64_MAX};
    sheard_params_init(&f.params, SHEARD_METHOD_FIELDS);
    int code =
        service_parse_operands(&cmd_fields, argc, argv, options, handle, &f, &f.service, "", 0, 1);
    code = code != SHEAR_OK ? code : service_open(&f.service);
    if (code != SHEAR_OK) {
        return code;
    }
    char *cursor = NULL;
    text_table *table = field_table_new();
    f.params.fields.prefix = optind < argc && argv[optind][0] ? argv[optind] : NULL;
    code = list(&f, table, &cursor);
    if (code == SHEAR_OK && !f.service.json && !f.brief) {
        code = text_table_print(table, stdout);
    }
    fflush(stdout);
    if (code == SHEAR_OK && cursor != NULL && !f.service.json) {
        message_note("there are more fields: --cursor %s goes on with them", cursor);
    }
    text_table_free(table);
    free(cursor);
    service_close(&f.service);
    return code;
}

const command cmd_fields = {
    .name = "fields",
    .summary = "list the fields and their shear",
    .usage = "usage: shearctl fields [OPTION...] [PREFIX]\n"
             "\n"
             "List the fields whose names begin with PREFIX, or all, by name: the shear with its "
             "errors, the\n"
             "stamps used, the jobs counted and those to come. A field that was measured with "
             "different\n"
             "settings has a line for each of them.\n"
             "\n"
             "  --limit N               at most so many\n"
             "  --cursor TEXT           go on where an earlier list ended\n"
             "  --brief                 only the names\n" SERVICE_OPTIONS_HELP
             "\n" EXIT_CODES_SERVICE ".\n",
    .run = run,
};
