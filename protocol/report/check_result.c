/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/check_result.h"

#include "json/text.h"

const char *sheard_check_level_name(enum sheard_check_level level) {
    return level == SHEARD_CHECK_OK ? "ok" : level == SHEARD_CHECK_WARN ? "warn" : "fail";
}

int sheard_check_result_json(char **text, const sheard_check_result *r, shear_error *err) {
    return json_text_finish(text,
                            JSON_OBJECT({"subject", json_text_string(r->subject)},
                                        {"level", json_string(sheard_check_level_name(r->level))},
                                        {"message", json_text_string(r->message)},
                                        {"remedy", json_text_string(r->remedy)}),
                            err);
}
