/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/fields.h: fields, their contributions, and forgetting a field. store.h describes what holds
 * for all calls. */
#pragma once

#include "shear/symmetry.h"
#include "store/codes.h"

/* ---- Fields ---- */

/* One field with one set of settings. */
typedef struct store_field {
    char *name, *settings_digest, *settings; /* never NULL */
    char *sums;   /* exact join of its contributions (shear/sums.h); never NULL */
    int64_t jobs; /* number of counted jobs */
    int64_t n_stamps, n_used;
    /* Number of unfinished jobs known to belong to this field with these settings. If above 0, the
     * result is partial. */
    int64_t unfinished;
    int64_t updated_ms; /* time of the last contribution */
    int64_t elapsed_us; /* sum over its contributions */
} store_field;
typedef struct store_field_page {
    store_field *fields; /* sorted by name (bytes), then settings digest */
    size_t n;
    bool more;
    /* Set by store_field_get: unfinished jobs known to belong to this name, with any settings. */
    int64_t unfinished;
} store_field_page;
void store_field_page_deinit(store_field_page *page);
/* Return the first row with these settings, or NULL if there is none. */
store_field *store_field_page_find(const store_field_page *page, const char *settings_digest);

/* Get all records of one name (at most STORE_PAGE_MAX). STORE_NOT_FOUND if nothing was counted and
 * nothing is unfinished. */
int store_field_get(store *s, const char *name, store_field_page *page, shear_error *err);

typedef struct store_field_filter {
    const char *prefix;     /* of the name; NULL: all */
    const char *after_name; /* both of the last record of the previous page; NULL: first page */
    const char *after_digest;
} store_field_filter;
/* Get a page of fields. Fields that are added meanwhile do not shift later pages. */
int store_fields(store *s, const store_field_filter *filter, size_t limit, store_field_page *page,
                 shear_error *err);

typedef struct store_contribution {
    int64_t id;    /* ascending in the order of counting */
    int64_t job;   /* may have been retired since */
    char *content; /* never NULL */
    int64_t n_stamps, n_used;
    int64_t counted_ms;
    char *account; /* as given to store_finish; NULL: not known */
} store_contribution;
typedef struct store_contribution_page {
    store_contribution *items; /* sorted by id */
    size_t n;
    bool more;
} store_contribution_page;
void store_contribution_page_deinit(store_contribution_page *page);

/* Get a page of a field's contributions with these settings, in the order of counting. `after` is
 * the last id of the previous page, or 0. STORE_NOT_FOUND if there is no such field. */
int store_contributions(store *s, const char *name, const char *settings_digest, int64_t after,
                        size_t limit, store_contribution_page *page, shear_error *err);

typedef struct store_truth {
    bool known; /* all contributions have the same true shear */
    double g1, g2;
} store_truth;
/* Get the true shear that all contributions share, in a time that does not depend on their number.
 * STORE_NOT_FOUND as above. */
int store_field_truth(store *s, const char *name, const char *settings_digest, store_truth *truth,
                      shear_error *err);

/* Get the stamp that counts most in a field (its size is NaN if not known), and the account of its
 * file: the caller's, or NULL if there is none. STORE_NOT_FOUND as above. */
int store_field_top(store *s, const char *name, const char *settings_digest, shear_influence *top,
                    char **account, shear_error *err);

/* Get the exact sums of one contribution, malloc'd, the caller's. STORE_NOT_FOUND if there is no
 * such contribution. */
int store_contribution_sums(store *s, int64_t id, char **sums, shear_error *err);

/* Add the terms of all contributions of a field with these settings, in the order of counting.
 * STORE_NOT_FOUND as above. A field without terms is not an error. */
int store_field_terms(store *s, const char *name, const char *settings_digest,
                      shear_symmetry *terms, shear_error *err);

/* ---- Forgetting a field ---- */

typedef struct store_forgotten {
    int64_t rows, contributions;
    int64_t last; /* number of the last row (store_removal); the rows have consecutive numbers */
} store_forgotten;
/* Remove the records of a field with these settings (NULL: any). Their contributions no longer
 * count and are no longer recognised; they are removed one by one (below). STORE_NOT_FOUND if
 * nothing was counted; STORE_WRONG_STATE if unfinished jobs are known to belong to the field. */
int store_forget(store *s, const char *name, const char *settings_digest, store_forgotten *out,
                 shear_error *err);

/* What is to be removed next, in the order of forgetting. After store_forget, and after a restart,
 * call store_next_removal and store_remove alternately until nothing is left. */
typedef struct store_removal {
    int64_t forgotten; /* number of the field's row, in order of forgetting; 0: nothing is left */
    int64_t contribution; /* 0: none is left, and the row's number is to be removed */
    int64_t job;          /* the contribution's */
    bool kept;            /* the job is not retired: it becomes RETRACTED */
    char *field;          /* the field's name */
    char *catalog;        /* of a job that is kept; may be NULL */
} store_removal;
void store_removal_deinit(store_removal *removal);
int store_next_removal(store *s, store_removal *next, shear_error *err);
/* Remove what store_next_removal returned. `catalog_gone`: the job's catalog has been removed;
 * otherwise store_next_leftover returns it. */
int store_remove(store *s, const store_removal *removal, bool catalog_gone, shear_error *err);
