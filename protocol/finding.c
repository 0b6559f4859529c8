/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/finding.h"

#include "json_text.h"

const char *sheard_finding_level_name(int level) {
    return level == SHEARD_FINDING_OK ? "ok" : level == SHEARD_FINDING_WARN ? "warn" : "fail";
}

int sheard_finding_json(char **text, const sheard_finding *f, shear_error *err) {
    json_t *o = json_object();
    bool failed = o == NULL;
    json_text_set(o, "subject", json_text_string(f->subject), &failed);
    json_text_set(o, "level", json_text_string(sheard_finding_level_name(f->level)), &failed);
    json_text_set(o, "message", json_text_string(f->message), &failed);
    json_text_set(o, "remedy", json_text_string(f->remedy), &failed);
    return json_text_finish(text, o, failed, err);
}
