/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheard/finding.h"

#include "json_text.h"

const char *shear_finding_level_name(int level) {
    return level == SHEAR_FINDING_OK ? "ok" : level == SHEAR_FINDING_WARN ? "warn" : "fail";
}

int shear_finding_json(char **text, const shear_finding *f, shear_error *err) {
    json_t *o = json_object();
    bool failed = !o;
    json_text_set(o, "subject", json_text_string(f->subject), &failed);
    json_text_set(o, "level", json_text_string(shear_finding_level_name(f->level)), &failed);
    json_text_set(o, "message", json_text_string(f->message), &failed);
    json_text_set(o, "remedy", json_text_string(f->remedy), &failed);
    return json_text_finish(text, o, failed, err);
}
