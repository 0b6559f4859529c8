/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "remote/service_query.h"

static const struct option options[] = {SERVICE_OPTIONS, {NULL, 0, NULL, 0}};

int service_query(const command *self, int method, void (*print)(const sheard_reply *reply),
                  int argc, char **argv) {
    service s;
    sheard_reply reply = {0};
    int code = service_parse_operands(self, argc, argv, options, NULL, NULL, &s, "", 0, 0);
    code = code != SHEAR_OK ? code : service_open(&s);
    if (code != SHEAR_OK) {
        return code;
    }
    code = service_answer(&s, method, NULL, &reply);
    if (code == SHEAR_OK && !s.json) {
        print(&reply);
    }
    sheard_reply_deinit(&reply, method);
    service_close(&s);
    return code;
}
