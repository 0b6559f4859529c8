/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/select/row_filter.h"

#include "base/thread.h"
#include "fits/select/expression.h"
#include "fits/tiles/view.h"

#include <stdio.h>
#include <string.h>

static pthread_mutex_t parser = PTHREAD_MUTEX_INITIALIZER; /* held while CFITSIO parses */

/* ---- the view ---- */

static void show_scaling(sf_view *v, const sf_scaling *by, int number) {
    char key[SF_INDEXED];
    if (by->scale != 1.0)
        sf_view_double(v, sf_card_indexed(key, "TSCAL", number), by->scale);
    if (by->zero != 0.0)
        sf_view_double(v, sf_card_indexed(key, "TZERO", number), by->zero);
    if (by->has_null)
        sf_view_int(v, sf_card_indexed(key, "TNULL", number), by->null);
}

/* A column that expressions cannot use is shown as bytes without a name. */
static void show_column(sf_view *v, const sf_column *c, int number) {
    char key[SF_INDEXED];
    char form[32];
    const bool known = sf_expression_knows(c);
    snprintf(form, sizeof form, "%lld%c", (long long)(known ? c->repeat : c->width),
             known ? c->type : 'B');
    if (known)
        sf_view_string(v, sf_card_indexed(key, "TTYPE", number), c->name);
    sf_view_string(v, sf_card_indexed(key, "TFORM", number), form);
    if (known)
        show_scaling(v, &c->by, number);
}

static void show_table(sf_view *v, const sf_table *t) {
    const sf_hdu *hdu = t->cards->hdu;
    sf_view_init(v, t->cards->file, hdu);
    v->data_bytes = hdu->axes[0] * hdu->axes[1]; /* without a heap */
    sf_view_table(v, hdu, 0, t->n);
    for (int i = 0; i < t->n; i++)
        show_column(v, &t->columns[i], i + 1);
    sf_view_end(v);
}

/* ---- evaluation ---- */

static bool means_syntax(int status) {
    return (status >= PARSE_SYNTAX_ERR && status <= PARSE_BAD_COL) || status == KEY_NO_EXIST;
}

static int fail(const sf_table *t, const char *expression, int status, shear_error *err) {
    if (!means_syntax(status))
        return sf_check_status(err, t->cards->at, status, "the row expression cannot be evaluated");
    char text[FLEN_STATUS] = "";
    char detail[FLEN_ERRMSG] = "";
    char advice[sizeof((shear_error *)0)->advice];
    fits_get_errstatus(status, text);
    if (fits_read_errmsg(detail) == 0)
        detail[0] = '\0';
    fits_clear_errmsg();
    sf_make_printable(detail);
    sf_table_advise(t, "", advice, sizeof advice);
    return sf_fail(err, SHEAR_E_SETTING, t->cards->at, advice,
                   "row expression '%.200s': CFITSIO says: %s%s%s", expression, text,
                   detail[0] != '\0' ? ": " : "", detail);
}

/* What CFITSIO opens for an evaluation. */
typedef struct evaluation {
    sf_view view;
    fitsfile *fits;
} evaluation;

static void evaluation_deinit(evaluation *e) {
    sf_view_close(e->fits);
    sf_view_deinit(&e->view);
}

int sf_row_filter(const sf_table *t, const char *expression, uint8_t *selected, shear_error *err) {
    char safe[SF_EXPRESSION_SIZE];
    const int64_t rows = t->cards->hdu->axes[1];
    TRY(sf_expression_make(expression, t, safe, err));
    if (rows == 0)
        return SHEAR_OK;
    CLEANUP(evaluation_deinit) evaluation e = {0};
    show_table(&e.view, t);
    TRY(sf_view_open(&e.view, 1, t->cards->at, &e.fits, err));
    long found = 0;
    int status = 0;
    {
        LOCKED(&parser);
        fits_find_rows(e.fits, safe, 1, (long)rows, &found, (char *)selected, &status);
    }
    return status == 0 ? SHEAR_OK : fail(t, expression, status, err);
}
