/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "json/text.h"

#include "base/buffer.h"
#include "base/utf8.h"
#include "json/tree.h"

#include <assert.h>
#include <math.h>
#include <string.h>

json_t *json_text_string(const char *text) {
    if (text == NULL)
        return json_null();
    buffer clean = {0};
    while (*text != '\0') {
        uint32_t point = 0;
        const size_t n = utf8_decode(text, &point);
        buffer_add(&clean, n > 0 ? text : "\xEF\xBF\xBD", n > 0 ? n : 3); /* U+FFFD */
        text += n > 0 ? n : 1;
    }
    json_t *string = clean.failed ? NULL : json_stringn(clean.n > 0 ? clean.bytes : "", clean.n);
    buffer_deinit(&clean);
    return string;
}

void json_text_set(json_t **object, const char *key, json_t *value) {
    assert(*object == NULL || json_is_object(*object));
    if (json_object_set_new(*object, key, value) != 0) {
        json_decref(*object);
        *object = NULL;
    }
}

void json_text_append(json_t **array, json_t *item) {
    if (json_array_append_new(*array, item) != 0) {
        json_decref(*array);
        *array = NULL;
    }
}

json_t *json_text_strings(const char *const *texts, size_t n) {
    json_t *array = json_array();
    for (size_t i = 0; i < n; i++)
        json_text_append(&array, json_text_string(texts[i]));
    return array;
}

json_t *json_text_number(double x) {
    return isfinite(x) ? json_real(x) : json_null();
}

json_t *json_text_index(int64_t i) {
    return i >= 0 ? json_integer(i) : json_null();
}

json_t *json_text_counts(const int64_t *counts, int n, const char *(*name_of)(int)) {
    json_t *object = json_object();
    for (int i = 0; i < n; i++)
        json_text_set(&object, name_of(i), json_integer(counts[i]));
    return object;
}

json_t *json_text_object(const json_pair *pairs) {
    json_t *object = json_object();
    for (; pairs->key != NULL; pairs++) {
        if (pairs->key[0] != '\0')
            json_text_set(&object, pairs->key, pairs->value);
    }
    return object;
}

int json_text_finish(char **text, json_t *object, shear_error *err) {
    *text = tree_dump(object, 0, "", NULL);
    json_decref(object);
    return *text != NULL ? SHEAR_OK
                         : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory while writing JSON");
}

int json_text_load(json_t **object, const char *text, const char *what, shear_error *err) {
    tree_error why;
    *object = tree_load(text, strlen(text), 0, &why);
    if (*object == NULL && why.fault == TREE_NO_MEMORY)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %s", what);
    if (!json_is_object(*object)) {
        json_decref(*object);
        *object = NULL;
        return shear_fail(err, SHEAR_E_FORMAT, NULL, "%s is no JSON object", what);
    }
    return SHEAR_OK;
}

double json_text_number_at(const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

int64_t json_text_count_at(const json_t *object, const char *key) {
    return json_integer_value(json_object_get(object, key));
}

const char *json_text_string_at(const json_t *object, const char *key) {
    return json_string_value(json_object_get(object, key));
}

const char *json_text_kind(const json_t *value) {
    static const char *const kinds[] = {
        [JSON_OBJECT] = "an object", [JSON_ARRAY] = "an array", [JSON_STRING] = "a string",
        [JSON_INTEGER] = "a number", [JSON_REAL] = "a number",  [JSON_TRUE] = "true",
        [JSON_FALSE] = "false",      [JSON_NULL] = "null",
    };
    return value != NULL ? kinds[json_typeof(value)] : "nothing";
}
