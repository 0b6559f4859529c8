/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/check_result.h"

#include "json/text.h"

const char *sheard_check_level_name(int level) {
    return level == SHEARD_CHECK_OK ? "ok" : level == SHEARD_CHECK_WARN ? "warn" : "fail";
}

int sheard_check_result_json(char **text, const sheard_check_result *r, shear_error *err) {
    json_t *o = json_object();
    bool failed = o == NULL;
    json_text_set(o, "subject", json_text_string(r->subject), &failed);
    json_text_set(o, "level", json_text_string(sheard_check_level_name(r->level)), &failed);
    json_text_set(o, "message", json_text_string(r->message), &failed);
    json_text_set(o, "remedy", json_text_string(r->remedy), &failed);
    return json_text_finish(text, o, failed, err);
}
