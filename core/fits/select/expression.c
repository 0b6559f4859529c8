/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/select/expression.h"

#include "base/cleanup.h"
#include "base/text.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

enum { LONGEST_WORD = 60 }; /* a word of hexadecimal bits grows fourfold in CFITSIO's 256 bytes */

/* ---- words ---- */

enum kind { END, WORD, KEYWORD, TEXT, NAME, SIGN, BROKEN };

/* A word or number, #keyword, "text" or 'text', $column name$, or a single character. */
typedef struct token {
    enum kind kind;
    const char *at; /* without quotes or # */
    size_t n;
    const char *next; /* where the next one begins */
} token;

static size_t word_length(const char *text) {
    size_t n = 0;
    while (isalnum((unsigned char)text[n]) || text[n] == '_') {
        n++;
    }
    return n;
}

/* CFITSIO's versions differ in whether "..' is a string, so that no quote may hold another kind. */
static token quoted(const char *text) {
    const size_t n = strcspn(text + 1, "'\"$");
    const enum kind kind = text[1 + n] != text[0] ? BROKEN : text[0] == '$' ? NAME : TEXT;
    return (token){kind, text + 1, n, text + n + (kind == BROKEN ? 1 : 2)};
}

static token token_at(const char *text) {
    text += strspn(text, " \t");
    if (*text == '\0')
        return (token){END, text, 0, text};
    if (strchr("'\"$", *text) != NULL)
        return quoted(text);
    const bool hash = *text == '#';
    const size_t n = word_length(text + hash);
    if (n > 0)
        return (token){hash ? KEYWORD : WORD, text + hash, n, text + hash + n};
    return (token){hash ? BROKEN : SIGN, text, 1, text + 1};
}

static bool is_call(const token *t) {
    return t->kind == WORD && *token_at(t->next).at == '(';
}

static bool equals(const token *t, const char *word) {
    return strlen(word) == t->n && strncasecmp(t->at, word, t->n) == 0;
}

static bool is_one_of(const token *t, const char *const *words) {
    while (*words != NULL && !equals(t, *words)) {
        words++;
    }
    return *words != NULL;
}

/* Return whether it is a number, such as 12 or 1E3, or bits: b01x, o17, hF0. */
static bool is_number(const token *t) {
    static const char *const digits[] = {"bB01xX", "oO01234567xX", "hH0123456789abcdefABCDEFxX"};
    if (isdigit((unsigned char)t->at[0]))
        return true;
    for (int k = 0; k < 3; k++) {
        if (strchr("boh", tolower((unsigned char)t->at[0])) != NULL && t->n > 1 &&
            tolower((unsigned char)t->at[0]) == digits[k][0] &&
            strspn(t->at + 1, digits[k] + 2) >= t->n - 1) {
            return true;
        }
    }
    return false;
}

/* ---- checks ---- */

static const char *const operators[] = {"and", "or", "not", "eq",  "ne",    "gt",     "lt", "ge",
                                        "le",  "t",  "f",   "int", "float", "double", NULL};
static const char *const functions[] = {
    "abs",     "acos",  "angsep", "arccos", "arcsin", "arctan", "arctan2", "asin",
    "atan",    "atan2", "box",    "ceil",   "circle", "cos",    "cosh",    "defnull",
    "ellipse", "exp",   "floor",  "isnull", "log",    "log10",  "max",     "min",
    "near",    "round", "sin",    "sinh",   "sqrt",   "tan",    "tanh",    NULL};

static int refuse(const sf_table *t, const char *given, const char *advice, const char *what,
                  const token *at, shear_error *err) {
    char shown[LONGEST_WORD + 4];
    snprintf(shown, sizeof shown, "%.*s%s", at->n > LONGEST_WORD ? LONGEST_WORD : (int)at->n,
             at->at, at->n > LONGEST_WORD ? "..." : "");
    return sf_fail(err, SHEAR_E_SETTING, t->cards->at, advice, "row expression '%.200s': %s '%s'",
                   given, what, shown);
}

bool sf_expression_knows(const sf_column *c) {
    const size_t n = strlen(c->name);
    for (size_t i = 0; i < n; i++) {
        if (c->name[i] < ' ' || c->name[i] > '~' || strchr("'\"$", c->name[i]) != NULL)
            return false;
    }
    return n > 0 && n <= LONGEST_WORD && c->by.wrong == NULL &&
           ((c->type == 'A' && c->repeat > 0 && c->repeat <= LONGEST_WORD) ||
            (c->repeat == 1 && strchr("LBIJKED", c->type) != NULL));
}

static int check_column(const sf_table *t, const char *given, const token *at, shear_error *err) {
    char name[LONGEST_WORD + 1];
    char advice[sizeof((shear_error *)0)->advice];
    const sf_column *c = NULL;
    snprintf(name, sizeof name, "%.*s", (int)at->n, at->at);
    TRY(sf_table_find(t, name, &c, err));
    if (c != NULL && !sf_expression_knows(c)) {
        return refuse(t, given, "use columns of one number, logical or short text per row",
                      "it cannot use the column", at, err);
    }
    sf_table_advise(t, name, advice, sizeof advice);
    return c != NULL ? SHEAR_OK : refuse(t, given, advice, "there is no column", at, err);
}

static int check_call(const sf_table *t, const char *given, const token *at, shear_error *err) {
    if (is_one_of(at, functions))
        return SHEAR_OK;
    char advice[sizeof((shear_error *)0)->advice];
    text_set(advice, sizeof advice, "functions: ");
    char *list = advice + strlen(advice);
    text_list(list, sizeof advice - strlen(advice), functions);
    return refuse(t, given, advice, "it cannot use the function", at, err);
}

static bool is_column(const token *t) {
    return t->kind == NAME ||
           (t->kind == WORD && !is_call(t) && !is_number(t) && !is_one_of(t, operators));
}

static int check(const sf_table *t, const char *given, const token *at, shear_error *err) {
    if (at->kind == BROKEN) {
        return refuse(t, given, "close quotes by their like, and write #KEYWORD",
                      "it breaks off at", at, err);
    }
    if (at->kind == SIGN && strchr("!%&()*+,-./:<=>?^|", *at->at) == NULL) {
        return refuse(t, given, "use numbers, columns, operators and functions", "it cannot have",
                      at, err);
    }
    if (at->n > LONGEST_WORD)
        return refuse(t, given, "use at most 60 characters", "a word is too long:", at, err);
    if (is_call(at))
        return check_call(t, given, at, err);
    return is_column(at) ? check_column(t, given, at, err) : SHEAR_OK;
}

/* Append a token; the left-hand side of a division becomes a double. */
static void put(char *safe, const token *at, const char *from) {
    const bool divides = at->kind == SIGN && (*at->at == '/' || *at->at == '%');
    text_append(safe, SF_EXPRESSION_SIZE, "%s%.*s", divides ? "/1.0" : "", (int)(at->next - from),
                from);
}

int sf_expression_make(const char *given, const sf_table *t, char safe[SF_EXPRESSION_SIZE],
                       shear_error *err) {
    bool has_column = false;
    safe[0] = '\0';
    if (strlen(given) > SF_EXPRESSION_MOST) {
        return sf_fail(err, SHEAR_E_SETTING, t->cards->at, "select before, or by a column of flags",
                       "the row expression has %zu characters, more than %d", strlen(given),
                       SF_EXPRESSION_MOST);
    }
    const char *from = given;
    token at = token_at(from);
    for (; at.kind != END; from = at.next, at = token_at(from)) {
        TRY(check(t, given, &at, err));
        has_column = has_column || is_column(&at);
        put(safe, &at, from);
    }
    if (has_column)
        return SHEAR_OK;
    char advice[sizeof((shear_error *)0)->advice];
    sf_table_advise(t, "", advice, sizeof advice);
    return sf_fail(err, SHEAR_E_SETTING, t->cards->at, advice,
                   "row expression '%.200s' names no column", given);
}

bool sf_expression_names(const char *given, const char *column) {
    token at = token_at(given);
    while (at.kind != END && !((at.kind == WORD || at.kind == NAME) && equals(&at, column))) {
        at = token_at(at.next);
    }
    return at.kind != END;
}
