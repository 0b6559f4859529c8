/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl fields: list all fields, one per line. */
#include "base/cleanup.h"
#include "base/clock.h"
#include "commands/commands.h"
#include "remote/field_table.h"
#include "remote/page_list.h"
#include "terminal/message.h"

#include <getopt.h>
#include <string.h>

/* Print the names; a field with several rows only once. */
static void print_names(const sheard_msg_field_page *page) {
    char name[256];
    for (size_t i = 0; i < page->n_fields; i++) {
        if (i == 0 || strcmp(page->fields[i].field, page->fields[i - 1].field) != 0)
            puts(message_clean(page->fields[i].field, name, sizeof name));
    }
}

static size_t show(const page_list *l, const sheard_reply *reply, const char **next) {
    const sheard_msg_field_page *page = &reply->fields;
    const bool rows = !l->service.json && !l->brief;
    if (l->brief && !l->service.json)
        print_names(page);
    for (size_t i = 0; i < page->n_fields && rows; i++)
        field_table_add(l->table, &page->fields[i], clock_ms(CLOCK_REALTIME));
    *next = page->cursor;
    return page->n_fields;
}

static enum exit_code run(const command *self, int argc, char **argv) {
    CLEANUP(page_list_deinit)
    page_list l = {.what = "fields",
                   .hint = "",
                   .method = SHEARD_METHOD_FIELDS,
                   .page_max = SHEARD_MSG_FIELDS_PAGE,
                   .limit = INT64_MAX,
                   .show = show};
    sheard_msg_fields *p = &l.params.fields;
    sheard_params_init(&l.params, l.method);
    l.page_limit = &p->limit;
    l.cursor = &p->cursor;
    const option_entry options[] = {
        {.name = "limit", .integer = &l.limit, .min = 1, .max = INT64_MAX},
        {.name = "cursor", .text = &p->cursor},
        {.name = "brief", .flag = &l.brief},
        SERVICE_OPTIONS(&l.service),
        {0}};
    TRY(service_start(self, argc, argv, options, &l.service, "", 0, 1));
    l.table = field_table_new();
    p->prefix = optind < argc && argv[optind][0] != '\0' ? argv[optind] : NULL;
    return page_list_print(&l);
}

COMMAND(fields, "list the fields and their shear", run, NULL);
