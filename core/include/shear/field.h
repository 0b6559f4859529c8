/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shear/field.h: field files (docs/field-files.md): a streaming reader and a streaming writer.
 *
 * The reader opens the file itself (regular files only), never through CFITSIO's extended file-name
 * syntax, and checks every dimension against the file's size before anything is allocated for it.
 * Memory is bounded by the stamps asked for, not by the file: .gz files are unpacked to an unlinked
 * temporary file (TMPDIR), .fz files are read tile by tile. A handle is used by one thread at a
 * time; several handles may be used at once.
 */
#ifndef SHEAR_FIELD_H
#define SHEAR_FIELD_H

#include "shear/error.h"
#include "shear/input.h"
#include "shear/plan.h"
#include "shear/stamp.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shear_field shear_field;

enum shear_layout { SHEAR_LAYOUT_CUBE = 0, SHEAR_LAYOUT_MOSAIC };
enum shear_psf_layout { SHEAR_PSF_ONE = 0, SHEAR_PSF_PER_STAMP, SHEAR_PSF_BY_ID };

/* Columns of the CATALOG table that the file has. */
enum shear_column {
    SHEAR_COL_ID = 1u << 0,
    SHEAR_COL_X = 1u << 1,
    SHEAR_COL_Y = 1u << 2,
    SHEAR_COL_RA = 1u << 3,
    SHEAR_COL_DEC = 1u << 4,
    SHEAR_COL_WEIGHT = 1u << 5,
    SHEAR_COL_PSF_ID = 1u << 6,
    SHEAR_COL_R_GAL = 1u << 7,
    SHEAR_COL_FLAGS = 1u << 8
};

typedef struct shear_field_info {
    char name[72];   /* FIELD, or the file's base name without .fits, .gz, .fz; "" where there is no
                        FIELD and a field may not be called like the file */
    double pixscale; /* arcsec per pixel; NaN = not given */
    bool has_truth;  /* SIM_G1 and SIM_G2 are both there */
    double sim_g1, sim_g2;
    shear_geometry geometry; /* stamps and PSF */
    int64_t n_stamps;
    int64_t n_psf;
    int noise_planes;         /* noise stamps a galaxy */
    enum shear_layout layout; /* of GALAXY */
    enum shear_psf_layout psf_layout;
    unsigned columns;   /* or of enum shear_column */
    bool id_unsigned;   /* column ID is unsigned, of 64 bits: ids are its bits */
    int bitpix;         /* of GALAXY as stored: 8, 16, 32, 64, -32, -64 */
    bool compressed;    /* GALAXY is tile-compressed */
    bool gzipped;       /* the whole file is (any of them, where the parts are in several) */
    int64_t file_bytes; /* as on disk, of all files */
    bool separate;      /* the parts are not those of one field file */
    int64_t hdu[SHEAR_N_PARTS]; /* of each part (enum shear_part), from 0; -1: there is none */
} shear_field_info;

/* Open and check a field file. SHEAR_E_IO (cannot open, not a regular file, no room for a temporary
 * file), SHEAR_E_FORMAT (everything else: message names file, HDU, and what was expected). *field
 * is NULL on error. */
int shear_field_open(shear_field **field, const char *path, shear_error *err);
/* The same on a descriptor (open for reading; duplicated, the caller keeps his). `name` is for
 * messages and FIELD. */
int shear_field_open_fd(shear_field **field, int fd, const char *name, shear_error *err);
/* A field from one file or from parts in several. FIELD, PIXSCALE and the truth are those of the
 * galaxies' file. `fds`: NULL, where the paths are to be opened; or, open for reading and the
 * caller's, fds[0] of a field file, fds[SHEAR_N_PARTS] of parts (of those that are not given: -1):
 * then paths are only names. A file that holds several parts may be given as several descriptors:
 * it is read as one. */
int shear_field_open_input(shear_field **field, const shear_input *input, const int *fds,
                           shear_error *err);
void shear_field_close(shear_field *field);
const shear_field_info *shear_field_get_info(const shear_field *field);

/* The name is needed: SHEAR_E_FORMAT where the field at `path` has none, and says why. */
int shear_field_need_name(const shear_field_info *info, const char *path, shear_error *err);

/* A reusable block of stamps, with room for `capacity` pairs of this field. */
typedef struct shear_block {
    shear_stamps stamps; /* views into the arrays below */
    int capacity;
    double *galaxy;     /* [capacity][ny][nx] */
    double *noise;      /* [capacity][noise_planes][ny][nx] */
    double *psf;        /* [capacity][psf_ny][psf_nx], or NULL with SHEAR_PSF_ONE */
    int32_t *psf_index; /* [capacity], or NULL with SHEAR_PSF_ONE */
    int64_t *psf_id;    /* [capacity] scratch: which PSF of the file each image is */
    int64_t *id;        /* [capacity] each, or NULL where the file has no such column */
    double *x, *y, *ra, *dec, *weight, *r_gal;
    int32_t *mask;
    void *memory; /* what shear_block_free frees; NULL where the memory is the caller's */
} shear_block;
int shear_block_new(shear_block **block, const shear_field_info *info, int capacity,
                    shear_error *err);
void shear_block_free(shear_block *block);

/* The same in memory of the caller's (shared between processes, say): `memory` is 64-byte aligned,
 * holds shear_block_bytes(info, capacity) bytes, and outlives the block; nothing is allocated,
 * nothing needs to be freed. */
size_t shear_block_bytes(const shear_field_info *info, int capacity);
void shear_block_place(shear_block *block, const shear_field_info *info, int capacity,
                       void *memory);
/* Bytes of one PSF image, a multiple of 64. */
size_t shear_psf_bytes(const shear_field_info *info);

/* Read pairs [first, first+count) into `block`; count <= capacity. Non-finite pixels (NaN,
 * infinities, BLANK) arrive as they are, BLANK as NaN. SHEAR_E_FORMAT where the data end early. */
int shear_field_read(shear_field *field, int64_t first, int count, shear_block *block,
                     shear_error *err);

/* Read PSF image number `index` (0-based) into out[psf_ny][psf_nx]. */
int shear_field_read_psf(shear_field *field, int64_t index, double *out, shear_error *err);

/* The largest size that a gzipped file may unpack to, unless the environment variable
 * SHEAR_UNPACK_LIMIT (bytes) says otherwise. It is unpacked into a file without a name in $TMPDIR
 * or /tmp; or, for a process that may open none, into one of these, open for writing, empty, one
 * for each file: call this once, before any is opened; they are this library's then. At most 8. */
#define SHEAR_UNPACK_LIMIT (INT64_C(64) << 30)
void shear_field_use_scratch(const int *fds, int n);

/* Content hash of a file (XXH3, 128 bits, lower-case hex). */
enum { SHEAR_CHECKSUM_SIZE = 33 }; /* with the NUL */
int shear_file_checksum(const char *path, char out[SHEAR_CHECKSUM_SIZE], shear_error *err);
int shear_fd_checksum(int fd, const char *name, char out[SHEAR_CHECKSUM_SIZE], shear_error *err);
/* What the store recognises an input by: of a field file, its content hash; of parts, a hash of
 * those of their files and of the HDUs chosen (`info`: of the open field), so that how they were
 * named does not matter. Parts that are those of one field file have that file's hash. `fds` as
 * above. */
int shear_input_checksum(const shear_input *input, const int *fds, const shear_field_info *info,
                         char out[SHEAR_CHECKSUM_SIZE], shear_error *err);
/* The same in steps, for a caller who wants to look up between them: at most about `bytes` more in
 * each, until *done; then the text. `input` and `fds` are borrowed and must live as long. A file
 * that grows while it is read is SHEAR_E_IO. */
typedef struct shear_hashing shear_hashing;
int shear_hashing_new(shear_hashing **h, const shear_input *input, const int *fds,
                      const shear_field_info *info, shear_error *err);
void shear_hashing_free(shear_hashing *h); /* NULL is accepted */
int shear_hashing_step(shear_hashing *h, int64_t bytes, bool *done, shear_error *err);
int64_t shear_hashing_bytes(const shear_hashing *h); /* read so far */
void shear_hashing_text(const shear_hashing *h, char out[SHEAR_CHECKSUM_SIZE]);
/* Content hash of bytes in memory. */
void shear_bytes_checksum(const void *bytes, size_t n, char out[SHEAR_CHECKSUM_SIZE]);

/* ---- writing ---- */
typedef struct shear_field_writer shear_field_writer;

typedef struct shear_field_spec {
    const char *name; /* FIELD, or NULL */
    double pixscale;  /* NaN = leave out */
    bool has_truth;
    double sim_g1, sim_g2;
    shear_geometry geometry;
    int64_t n_stamps;
    int64_t n_psf;              /* 1, n_stamps, or fewer with SHEAR_COL_PSF_ID */
    int noise_planes;           /* noise stamps a galaxy; 0 = 1 */
    enum shear_layout layout;   /* of GALAXY and NOISE */
    int mosaic_columns;         /* stamps in a mosaic's row; 0 = about square */
    unsigned columns;           /* of CATALOG; 0 = no table */
    int bitpix;                 /* of the stamps and the PSF: -32 or -64 */
    bool overwrite;             /* replace an existing file */
    const char *const *history; /* NULL-terminated lines, or NULL */
} shear_field_spec;

/* Rows of the CATALOG table; arrays [count], NULL where the column is not in the spec. */
typedef struct shear_catalog_columns {
    const int64_t *id;
    const double *x, *y, *ra, *dec, *weight, *r_gal;
    const int32_t *psf_id, *flags;
} shear_catalog_columns;

/* Begin `path`. The file appears under its name only by _finish (temporary file, fsync, rename);
 * _abort, or NULL-safe after a failed call, removes it. Any stamp order and any chunking; not
 * thread-safe. SHEAR_E_EXISTS where the file exists and overwrite is false. */
int shear_field_create(shear_field_writer **w, const char *path, const shear_field_spec *spec,
                       shear_error *err);
/* galaxy [count][ny][nx], noise [count][noise_planes][ny][nx] */
int shear_field_write(shear_field_writer *w, int64_t first, int count, const double *galaxy,
                      const double *noise, const shear_catalog_columns *columns, shear_error *err);
int shear_field_write_psf(shear_field_writer *w, int64_t index, const double *psf,
                          shear_error *err);
int shear_field_finish(shear_field_writer *w, shear_error *err); /* frees w, whatever it returns */
void shear_field_abort(shear_field_writer *w);

#ifdef __cplusplus
}
#endif

#endif
