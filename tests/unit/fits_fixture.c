/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits_fixture.h"

#include "remove_tree.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

enum { BLOCK = 2880, CARD = 80 };

static char directory[256];

int fixture_setup(void **state) {
    (void)state;
    const char *tmp = getenv("TMPDIR");
    snprintf(directory, sizeof directory, "%s/shear-test-XXXXXX", tmp != NULL ? tmp : "/tmp");
    return mkdtemp(directory) != NULL ? 0 : -1;
}

int fixture_teardown(void **state) {
    (void)state;
    return remove_tree(directory);
}

const char *fixture_path(const char *name) {
    static char paths[8][600];
    static int next;
    char *path = paths[next];
    next = (next + 1) % 8;
    snprintf(path, sizeof paths[0], "%s/%s", directory, name);
    return path;
}

int fixture_count_files(void) {
    DIR *d = opendir(directory);
    assert_non_null(d);
    int n = 0;
    while (readdir(d) != NULL)
        n++;
    closedir(d);
    return n - 2; /* . and .. */
}

double fixture_pixel(int kind, int64_t i, int y, int x) {
    const int64_t mixed = i * 131 + y * 1009 + x * 17 + (int64_t)kind * 2003;
    return (double)(mixed % 4093) * 0.25 - 100.0;
}

double fixture_column(unsigned bit, int64_t i) {
    return bit * 100.0 + (double)i * 0.125;
}

int32_t fixture_psf_id(int64_t i, int64_t n_psf) {
    return (int32_t)((i * 5 + 1) % n_psf);
}

shear_field_spec fixture_spec(void) {
    return (shear_field_spec){
        .pixscale = NAN,
        .geometry = {.nx = 12, .ny = 10, .psf_nx = 9, .psf_ny = 7, .psf_oversample = 2},
        .n_stamps = 10,
        .n_psf = 1,
        .bitpix = -32,
        .overwrite = true};
}

static void fill(double *out, int kind, int64_t first, int64_t count, int nx, int ny) {
    for (int64_t i = first; i < first + count; i++) {
        for (int y = 0; y < ny; y++) {
            for (int x = 0; x < nx; x++)
                *out++ = fixture_pixel(kind, i, y, x);
        }
    }
}

static void write_rows(shear_field_writer *w, const shear_field_spec *s, int64_t first, int count) {
    enum { MOST = 16 };
    const size_t pixels = (size_t)s->geometry.nx * (size_t)s->geometry.ny;
    double *galaxy = calloc((size_t)count * pixels, sizeof *galaxy);
    const int planes = s->noise_planes > 1 ? s->noise_planes : 1;
    double *noise = calloc((size_t)planes * (size_t)count * pixels, sizeof *noise);
    fill(galaxy, FIXTURE_GALAXY, first, count, s->geometry.nx, s->geometry.ny);
    fill(noise, FIXTURE_NOISE, planes * first, (int64_t)planes * count, s->geometry.nx,
         s->geometry.ny);
    double values[6][MOST];
    int64_t id[MOST];
    int32_t psf_id[MOST];
    int32_t flags[MOST];
    static const unsigned bits[6] = {SHEAR_COL_X,   SHEAR_COL_Y,      SHEAR_COL_RA,
                                     SHEAR_COL_DEC, SHEAR_COL_WEIGHT, SHEAR_COL_R_GAL};
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 6; k++)
            values[k][i] = fixture_column(bits[k], first + i);
        id[i] = (first + i) * 3000000000;
        psf_id[i] = fixture_psf_id(first + i, s->n_psf);
        flags[i] = (int32_t)(first + i) % 3;
    }
    const shear_catalog_columns columns = {.id = id,
                                           .x = values[0],
                                           .y = values[1],
                                           .ra = values[2],
                                           .dec = values[3],
                                           .weight = values[4],
                                           .r_gal = values[5],
                                           .psf_id = psf_id,
                                           .flags = flags};
    shear_error err = {0};
    assert_int_equal(shear_field_write(w, first, count, galaxy, noise, &columns, &err), SHEAR_OK);
    free(galaxy);
    free(noise);
}

void fixture_write(const char *path, const shear_field_spec *s) {
    shear_error err = {0};
    shear_field_writer *w = NULL;
    if (shear_field_create(&w, path, s, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
    const size_t samples = (size_t)s->geometry.psf_nx * (size_t)s->geometry.psf_ny;
    double *psf = calloc(samples, sizeof *psf);
    for (int64_t i = s->n_psf - 1; i >= 0; i--) {
        fill(psf, FIXTURE_PSF, i, 1, s->geometry.psf_nx, s->geometry.psf_ny);
        assert_int_equal(shear_field_write_psf(w, i, psf, &err), SHEAR_OK);
    }
    free(psf);
    for (int64_t first = (s->n_stamps - 1) / 3 * 3; first >= 0; first -= 3) { /* backwards */
        const int64_t rest = s->n_stamps - first;
        write_rows(w, s, first, rest < 3 ? (int)rest : 3);
    }
    if (shear_field_finish(w, &err) != SHEAR_OK)
        fail_msg("%s", err.message);
}

void fixture_write_good(const char *path) {
    const shear_field_spec spec = fixture_spec();
    fixture_write(path, &spec);
}

static void ok(int status) {
    if (status != 0) {
        fits_report_error(stderr, status);
        fail_msg("the fixture's own CFITSIO call failed with status %d", status);
    }
}

fitsfile *fixture_create(const char *path) {
    fitsfile *f = NULL;
    int status = 0;
    remove(path);
    fits_create_diskfile(&f, path, &status);
    fits_create_img(f, BYTE_IMG, 0, NULL, &status);
    ok(status);
    return f;
}

static void set_compression(fitsfile *f, const fixture_image *image, int *status) {
    fits_set_compression_type(f, image->compression, status);
    if (image->compression != 0) {
        long tile[3];
        memcpy(tile, image->tile, sizeof tile);
        if (tile[0] > 0)
            fits_set_tile_dim(f, image->naxis, tile, status);
        if (image->bitpix < 0)
            fits_set_quantize_level(f, image->lossy ? 64.0f : 0.0f, status);
    }
}

/* CFITSIO does not convert what it compresses. */
static void write_native(fitsfile *f, int bitpix, long n, const double *pixels, int *status) {
    const int type = bitpix == 8     ? TBYTE
                     : bitpix == 16  ? TSHORT
                     : bitpix == 32  ? TINT
                     : bitpix == -32 ? TFLOAT
                                     : TDOUBLE;
    char *native = calloc((size_t)n, sizeof(double));
    for (long i = 0; i < n; i++) {
        switch (type) {
        case TBYTE:
            ((unsigned char *)native)[i] = (unsigned char)pixels[i];
            break;
        case TSHORT:
            ((short *)(void *)native)[i] = (short)pixels[i];
            break;
        case TINT:
            ((int *)(void *)native)[i] = (int)pixels[i];
            break;
        case TFLOAT:
            ((float *)(void *)native)[i] = isnan(pixels[i]) ? -1e30f : (float)pixels[i];
            break;
        default:
            ((double *)(void *)native)[i] = pixels[i];
        }
    }
    float null = -1e30f; /* a NaN that CFITSIO is not told of spoils its whole tile */
    fits_write_imgnull(f, type, 1, n, native, type == TFLOAT ? &null : NULL, status);
    free(native);
}

void fixture_append(fitsfile *f, const fixture_image *image, const double *pixels) {
    int status = 0;
    long axes[3];
    memcpy(axes, image->axes, sizeof axes);
    set_compression(f, image, &status);
    fits_create_img(f, image->bitpix, image->naxis, axes, &status);
    fits_write_key_str(f, "EXTNAME", image->name, NULL, &status);
    if (image->bscale != 0.0) {
        fits_write_key_dbl(f, "BSCALE", image->bscale, -17, NULL, &status);
        fits_write_key_dbl(f, "BZERO", image->bzero, -17, NULL, &status);
    }
    if (image->has_blank)
        fits_write_key_lng(f, "BLANK", image->blank, NULL, &status);
    fits_set_hdustruc(f, &status);
    long n = 1;
    for (int k = 0; k < image->naxis; k++)
        n *= axes[k];
    if (image->compression != 0) {
        write_native(f, image->bitpix, n, pixels, &status);
    } else if (image->has_blank) {
        double null = -1e30; /* CFITSIO compares: NaN would equal nothing */
        double *copy = calloc((size_t)n, sizeof *copy);
        for (long i = 0; i < n; i++)
            copy[i] = isnan(pixels[i]) ? null : pixels[i];
        fits_write_imgnull(f, TDOUBLE, 1, n, copy, &null, &status);
        free(copy);
    } else {
        fits_write_img(f, TDOUBLE, 1, n, (double *)(uintptr_t)pixels, &status);
    }
    fits_set_compression_type(f, 0, &status);
    ok(status);
}

void fixture_close(fitsfile *f) {
    int status = 0;
    fits_close_file(f, &status);
    ok(status);
}

void fixture_write_like(const char *path, const fixture_image *image, int n) {
    fitsfile *f = fixture_create(path);
    const char *const names[] = {"GALAXY", "NOISE", "PSF"};
    for (int kind = 0; kind < 3; kind++) {
        fixture_image one = *image;
        const int nx = kind == FIXTURE_PSF ? 9 : (int)image->axes[0];
        const int ny = kind == FIXTURE_PSF ? 7 : (int)image->axes[1];
        one.name = names[kind];
        one.naxis = kind == FIXTURE_PSF ? 2 : 3;
        one.axes[0] = nx;
        one.axes[1] = ny;
        one.axes[2] = n;
        if (kind == FIXTURE_PSF)
            one.tile[0] = 0;
        double *pixels = calloc((size_t)nx * (size_t)ny * (size_t)n, sizeof *pixels);
        fill(pixels, kind, 0, kind == FIXTURE_PSF ? 1 : n, nx, ny);
        for (long i = 0; image->bitpix > 0 && i < (long)nx * ny * n; i++) {
            pixels[i] = floor(fabs(pixels[i])); /* within the range of all integers but bytes */
            pixels[i] = image->bitpix == 8 ? fmod(pixels[i], 200.0) : pixels[i];
        }
        fixture_append(f, &one, pixels);
        free(pixels);
    }
    fixture_close(f);
}

unsigned char *fixture_load(const char *path, size_t *size) {
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    fseek(f, 0, SEEK_END);
    *size = (size_t)ftell(f);
    rewind(f);
    unsigned char *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, f), *size);
    fclose(f);
    return bytes;
}

void fixture_save(const char *path, const void *bytes, size_t size) {
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, size, f), size);
    fclose(f);
}

void fixture_gzip(const char *from, const char *to) {
    size_t size = 0;
    unsigned char *bytes = fixture_load(from, &size);
    gzFile g = gzopen(to, "wb1");
    assert_non_null(g);
    assert_int_equal(gzwrite(g, bytes, (unsigned)size), size);
    assert_int_equal(gzclose(g), Z_OK);
    free(bytes);
}

static bool has_key(const unsigned char *card, const char *key) {
    char padded[9];
    snprintf(padded, sizeof padded, "%-8s", key);
    return memcmp(card, padded, 8) == 0;
}

/* The first card of the header whose EXTNAME is `hdu`; the offset of its END card in *end. */
static size_t find_header(const unsigned char *bytes, size_t size, const char *hdu, size_t *end) {
    char quoted[80];
    snprintf(quoted, sizeof quoted, "'%s", hdu);
    for (size_t start = 0; start < size; start += BLOCK) {
        if (!has_key(bytes + start, "SIMPLE") && !has_key(bytes + start, "XTENSION"))
            continue;
        bool named = hdu[0] == '\0' && start == 0;
        for (size_t i = start; i < size; i += CARD) {
            if (has_key(bytes + i, "EXTNAME")) {
                named = named || memcmp(bytes + i + 10, quoted, strlen(quoted)) == 0;
            } else if (has_key(bytes + i, "END")) {
                *end = i;
                break;
            }
        }
        if (named)
            return start;
    }
    fail_msg("the fixture has no HDU %s", hdu);
    return 0;
}

void fixture_patch(const char *path, const char *hdu, const char *key, const char *value) {
    size_t size = 0;
    size_t end = 0;
    unsigned char *bytes = fixture_load(path, &size);
    size_t i = find_header(bytes, size, hdu, &end);
    while (i < end && !has_key(bytes + i, key))
        i += CARD;
    if (i == end) { /* a new card; END moves on, within its block */
        assert_true((end / CARD + 1) % (BLOCK / CARD) != 0);
        memcpy(bytes + end + CARD, bytes + end, CARD);
    }
    char card[CARD + 1];
    snprintf(card, sizeof card, "%-8s= %-70s", key, value);
    memcpy(bytes + i, card, CARD);
    fixture_save(path, bytes, size);
    free(bytes);
}

bool fixture_string(const char *path, const char *hdu, const char *key, char value[FLEN_VALUE]) {
    fitsfile *f = NULL;
    char name[FLEN_VALUE];
    int status = 0;
    snprintf(name, sizeof name, "%s", hdu);
    fits_open_diskfile(&f, path, READONLY, &status);
    fits_movnam_hdu(f, ANY_HDU, name, 0, &status);
    fits_read_key(f, TSTRING, key, value, NULL, &status);
    const bool found = status == 0;
    status = 0;
    fits_close_file(f, &status);
    return found;
}

size_t fixture_data_offset(const char *path, const char *hdu) {
    size_t size = 0;
    size_t end = 0;
    unsigned char *bytes = fixture_load(path, &size);
    find_header(bytes, size, hdu, &end);
    free(bytes);
    return (end / BLOCK + 1) * BLOCK;
}

void fixture_expect_open(const char *path, int code, ...) {
    shear_field *field = (shear_field *)1;
    shear_error err = {0};
    const int rc = shear_field_open(&field, path, &err);
    if (rc != code || err.code != code || field != NULL)
        fail_msg("%s: code %d instead of %d (%s)", path, rc, code, err.message);
    if (getenv("SHOW_MESSAGES") != NULL)
        print_message("%s [%s]\n", err.message, err.advice);
    const char *slash = strrchr(path, '/');
    const char *base = slash != NULL ? slash + 1 : path;
    if (strstr(err.message, base) == NULL)
        fail_msg("the message does not name the file: %s", err.message);
    va_list words;
    va_start(words, code);
    for (const char *word = va_arg(words, const char *); word != NULL;
         word = va_arg(words, const char *)) {
        if (strstr(err.message, word) == NULL)
            fail_msg("the message does not say '%s': %s", word, err.message);
    }
    va_end(words);
}
