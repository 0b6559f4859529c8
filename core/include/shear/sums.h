/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear/sums.h: from rows to a field's shear.
 *
 * Rows are summed in fixed blocks of SHEAR_BLOCK consecutive stamps of a file, in stamp order, with
 * compensated (Neumaier) summation. Blocks are joined in an exact accumulator (integers, no
 * rounding), so that the join is associative and commutative: a field's result is the same to the
 * last bit for any number of workers, any chunking, any order of arrival and any sharding along
 * block boundaries.
 *
 * Estimator: g_i = sum w N_i / sum w D (Zhang 2010, eqs. shear12PSF and OSN3).
 */
#ifndef SHEAR_SUMS_H
#define SHEAR_SUMS_H

#include "shear/error.h"
#include "shear/stamp.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    SHEAR_BLOCK = 16
}; /* stamps in a block; a multiple of 4, so that rotated fours stay together */

/* The terms that are summed over the unflagged stamps of a block. */
enum shear_term {
    SHEAR_S_W,    /* w */
    SHEAR_S_N1,   /* w N1 */
    SHEAR_S_N2,   /* w N2 */
    SHEAR_S_D,    /* w D */
    SHEAR_S_N1N1, /* w^2 N1 N1, and so on: the delta method's */
    SHEAR_S_N2N2,
    SHEAR_S_N1N2,
    SHEAR_S_N1D,
    SHEAR_S_N2D,
    SHEAR_S_DD,
    SHEAR_S_FLUX,        /* flux */
    SHEAR_S_REMOVED,     /* flux_removed */
    SHEAR_S_REMOVED2,    /* flux_removed^2 */
    SHEAR_S_BORDER_MEAN, /* border_mean and its square */
    SHEAR_S_BORDER_MEAN2,
    SHEAR_S_BORDER_VAR, /* border_var and its square */
    SHEAR_S_BORDER_VAR2,
    SHEAR_S_BORDER_NOISE, /* border_var_noise */
    SHEAR_N_TERMS
};

/* The sums of one block: plain data, may be copied, stored and sent between processes of one
 * machine. */
typedef struct shear_block_sums {
    int64_t n_stamps;               /* rows added */
    int64_t n_used;                 /* of them unflagged */
    int64_t flagged[SHEAR_N_FLAGS]; /* rows that carry each flag */
    double hi[SHEAR_N_TERMS];       /* the running sums ... */
    double lo[SHEAR_N_TERMS];       /* ... and their compensations: the sum is hi + lo */
} shear_block_sums;

void shear_block_sums_init(shear_block_sums *b);
/* Add one row; call in stamp order. */
void shear_block_sums_add(shear_block_sums *b, const shear_row *row);

/* A field's exact sums. Not thread-safe: one owner at a time. */
typedef struct shear_field_sums shear_field_sums;
int shear_field_sums_new(shear_field_sums **f, shear_error *err);
void shear_field_sums_free(shear_field_sums *f);
void shear_field_sums_add(shear_field_sums *f, const shear_block_sums *b);  /* exact */
void shear_field_sums_join(shear_field_sums *f, const shear_field_sums *g); /* f += g, exact */
/* f -= g, exact, where g is among what was joined to f: f is then as if g had never been. */
void shear_field_sums_leave(shear_field_sums *f, const shear_field_sums *g);
/* Exact text form (ASCII, versioned, 5 to 10 KiB); *text is malloc'd, the caller frees it. Reading
 * it back gives the same sums. Parse errors are SHEAR_E_FORMAT. */
int shear_field_sums_format(const shear_field_sums *f, char **text, shear_error *err);
int shear_field_sums_parse(shear_field_sums **f, const char *text, shear_error *err);

/* A field's result. Where fewer than 2 stamps are usable or sum w D is not positive, `valid` is
 * false and the shear and its errors are NaN. */
typedef struct shear_result {
    bool valid;
    int estimator; /* enum shear_estimator (shear/settings.h) */
    double g1, g2;
    double g1_err, g2_err; /* 1 sigma: delta method, or jackknife where it was asked for, or the
                              symmetry's own */
    double cov12;          /* covariance of g1 and g2, by the same method */
    int jackknife;         /* groups of the jackknife; 0 = delta method */
    int64_t n_stamps, n_used, n_flagged;
    int64_t flagged[SHEAR_N_FLAGS];
    double sum_weight, sum_d;
    double mean_flux;          /* of the used stamps */
    double filter_removed;     /* part of the stacked flux that the filter removes ... */
    double filter_removed_err; /* ... and its 1-sigma error */
    double border_excess;      /* mean border pixel, galaxy minus noise ... */
    double border_excess_err;
    double border_rough; /* mean border variance, galaxy minus noise ... */
    double border_rough_err;
    double border_noise_var; /* mean border variance of the noise stamps */
} shear_result;

/* Where the errors are from: "delta", "jackknife" or "symmetry". */
const char *shear_error_method(const shear_result *r);

/* The field's result with delta-method errors. */
void shear_field_result(const shear_field_sums *f, shear_result *out);

/* The jackknife: N groups of whole consecutive blocks (nearly equal numbers of them), each left out
 * in turn. Call _add for every block of the field in canonical order (file by file, block by
 * block), then _finish, which overwrites errors and covariance of *out. SHEAR_E_SETTING where there
 * are fewer blocks than groups. Thread-compatible. */
typedef struct shear_jackknife shear_jackknife;
int shear_jackknife_new(shear_jackknife **j, int groups, shear_error *err);
void shear_jackknife_free(shear_jackknife *j);
int shear_jackknife_add(shear_jackknife *j, const shear_block_sums *b, shear_error *err);
/* Append all blocks of `other`. All or nothing. */
int shear_jackknife_join(shear_jackknife *j, const shear_jackknife *other, shear_error *err);
int shear_jackknife_finish(const shear_jackknife *j, shear_result *out, shear_error *err);

#endif
