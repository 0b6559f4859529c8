/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "json/settings.h"

#include "json/text.h"

#include <math.h>

static json_t *value_of(const shear_settings *s, const shear_setting_def *def) {
    const void *at = (const char *)s + def->offset;
    switch (def->type) {
    case SHEAR_T_CHOICE:
        return json_text_string(def->choices[*(const int *)at]);
    case SHEAR_T_INT:
        return def->has_auto && *(const int *)at == 0 ? json_string(shear_setting_auto(def))
                                                      : json_integer(*(const int *)at);
    case SHEAR_T_DOUBLE:
        return def->has_auto && isnan(*(const double *)at) ? json_string(shear_setting_auto(def))
                                                           : json_text_number(*(const double *)at);
    default:
        return json_boolean(*(const bool *)at);
    }
}

json_t *json_settings(const shear_settings *s) {
    size_t n = 0;
    const shear_setting_def *table = shear_settings_table(&n);
    json_t *object = json_object();
    for (size_t i = 0; i < n; i++)
        json_text_set(&object, table[i].name, value_of(s, &table[i]));
    return object;
}
