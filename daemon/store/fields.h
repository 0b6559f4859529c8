/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/fields.h: fields, what was counted in them, and how that is forgotten. store.h tells what
 * holds for all calls. */
#ifndef SHEARD_STORE_FIELDS_H
#define SHEARD_STORE_FIELDS_H

#include "shear/symmetry.h"
#include "store/codes.h"

/* ---- Fields ---- */

/* One field as measured with one set of settings. */
typedef struct store_field {
    char *name, *settings_digest, *settings; /* never NULL */
    char *sums;   /* exact join of its contributions (shear/sums.h); never NULL */
    int64_t jobs; /* that were counted */
    int64_t n_stamps, n_used;
    int64_t unfinished; /* jobs known to be of this field and these settings: above 0, the result is
                           partial */
    int64_t updated_ms; /* the last contribution */
    int64_t elapsed_us; /* sum over its contributions */
} store_field;
typedef struct store_field_page {
    store_field *fields; /* by name (bytes), then by settings digest */
    size_t n;
    bool more;
    int64_t unfinished; /* store_field_get: unfinished jobs known to be of this name, whatever their
                           settings */
} store_field_page;
void store_field_page_deinit(store_field_page *page);

/* Every record of one name (at most STORE_PAGE_MAX). STORE_NOT_FOUND where nothing was counted and
 * nothing is unfinished. */
int store_field_get(store *s, const char *name, store_field_page *page, shear_error *err);

typedef struct store_field_filter {
    const char *prefix;     /* of the name; NULL: all */
    const char *after_name; /* the last record of the page before, both; NULL: from the first */
    const char *after_digest;
} store_field_filter;
/* A page of fields. Fields that appear meanwhile do not move the others. */
int store_fields(store *s, const store_field_filter *filter, size_t limit, store_field_page *page,
                 shear_error *err);

typedef struct store_contribution {
    int64_t id;    /* grows in the order of counting */
    int64_t job;   /* may have been retired since */
    char *content; /* never NULL */
    int64_t n_stamps, n_used;
    int64_t counted_ms;
    char *account; /* as given to store_finish; NULL: not known */
} store_contribution;
typedef struct store_contribution_page {
    store_contribution *items; /* by id */
    size_t n;
    bool more;
} store_contribution_page;
void store_contribution_page_deinit(store_contribution_page *page);

/* What was counted in a field with these settings, in the order of counting; `after`: the last id
 * of the page before, or 0. STORE_NOT_FOUND where there is no such field. */
int store_contributions(store *s, const char *name, const char *settings_digest, int64_t after,
                        size_t limit, store_contribution_page *page, shear_error *err);

typedef struct store_truth {
    bool known; /* all contributions have the same one */
    double g1, g2;
} store_truth;
/* In a time that does not depend on how many there are. STORE_NOT_FOUND as above. */
int store_field_truth(store *s, const char *name, const char *settings_digest, store_truth *truth,
                      shear_error *err);

/* The stamp that counts most in a field (its size NaN: not known), and the account of the file that
 * it is in: the caller's; NULL where there is none. STORE_NOT_FOUND as above. */
int store_field_top(store *s, const char *name, const char *settings_digest, shear_influence *top,
                    char **account, shear_error *err);

/* The exact sums of one contribution; malloc'd, the caller frees it. STORE_NOT_FOUND. */
int store_contribution_sums(store *s, int64_t id, char **sums, shear_error *err);

/* Add the terms of everything that was counted in a field with these settings, in the order of
 * counting. STORE_NOT_FOUND as above; no terms is no error. */
int store_field_terms(store *s, const char *name, const char *settings_digest,
                      shear_symmetry *terms, shear_error *err);

/* ---- Forgetting a field ---- */

typedef struct store_forgotten {
    int64_t rows, contributions;
    int64_t last; /* the rows' numbers (store_removal) are those up to this one */
} store_forgotten;
/* All that was counted in a field, with these settings (NULL: any): its records are gone, whose
 * contributions are to leave (below): they no longer count and are no longer recognised.
 * STORE_NOT_FOUND where nothing was counted; STORE_WRONG_STATE where unfinished jobs are known to
 * be of it. */
int store_forget(store *s, const char *name, const char *settings_digest, store_forgotten *out,
                 shear_error *err);

/* What is to leave next, first of the field that was forgotten first, until nothing is left, also
 * after a restart: the caller of store_forget calls these two
 * alternately. */
typedef struct store_removal {
    int64_t forgotten; /* number of the field's row, in the order of forgetting; 0: none is left */
    int64_t contribution; /* 0: all of them have left, and the row's number is to go */
    int64_t job;          /* the contribution's */
    bool kept;            /* not retired: it becomes RETRACTED */
    char *field;          /* its name */
    char *catalog;        /* of a job that is kept */
} store_removal;
void store_removal_deinit(store_removal *removal);
int store_next_removal(store *s, store_removal *next, shear_error *err);
/* `catalog_gone`: the job's file is not there any more; else store_next_leftover tells of it. */
int store_remove(store *s, const store_removal *removal, bool catalog_gone, shear_error *err);

#endif
