/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shearctl reload: let the service read its configuration again. */
#include "remote/service_query.h"
#include "terminal/message.h"

static void print_list(const char *title, const char *const *names, size_t n) {
    for (size_t i = 0; i < n; i++) {
        char name[512];
        printf("%s %s\n", title, message_clean(names[i], name, sizeof name));
    }
}

static void print(const sheard_reply *reply, const service *s) {
    (void)s;
    const sheard_msg_reloaded *r = &reply->reload;
    print_list("changed:", r->changed, r->n_changed);
    print_list("needs a restart:", r->restart, r->n_restart);
    print_list("warning:", r->warnings, r->n_warnings);
    if (r->n_changed + r->n_restart == 0)
        puts("nothing has changed");
}

static enum exit_code run(const command *self, int argc, char **argv) {
    return service_query(self, argc, argv, SHEARD_METHOD_RELOAD, print);
}

const command cmd_reload = {
    .name = "reload",
    .summary = "make the service read its configuration again",
    .run = run,
    /* clang-format off */
    .usage =
    "usage: shearctl reload [OPTION...]\n"
    "\n"
    "Have the service read its configuration again. If it has errors, they are printed and the old one\n"
    "stays in force. Administrators only.\n"
    "\n"
    SERVICE_OPTIONS_HELP "\n"
    SERVICE_EXIT_CODES_HELP ".\n",
    /* clang-format on */
};
