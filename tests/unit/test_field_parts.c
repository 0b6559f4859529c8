/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields whose parts lie in separate files and HDUs: for every split they read as the field file
 * that they were cut from, to the last bit; parts that do not belong together are refused.
 */
#include "fits_fixture.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The parts of a field file. The others are an exposure's. */
enum { N_PARTS = SHEAR_PART_CATALOG + 1 };

static const char *const extnames[N_PARTS] = {"GALAXY", "NOISE", "PSF", "CATALOG"};
static const char *const others[N_PARTS] = {"SCI", "SKY", "KERNEL", "STARS"};

/* ---- cutting ---- */

static void ok(int status) {
    if (status != 0) {
        fits_report_error(stderr, status);
        fail_msg("the test's own CFITSIO call failed with status %d", status);
    }
}

/* Append one HDU of `from` to `to` under another name ("" for none); false where there is none. An
 * image that comes first becomes the primary HDU. */
static bool cut(const char *from, const char *name, fitsfile *to, const char *rename) {
    fitsfile *in = NULL;
    int status = 0;
    fits_open_diskfile(&in, from, READONLY, &status);
    ok(status);
    fits_movnam_hdu(in, ANY_HDU, (char *)(uintptr_t)name, 0, &status);
    const bool found = status == 0;
    if (found) {
        fits_copy_hdu(in, to, 0, &status);
        if (rename[0] != '\0') {
            fits_update_key_str(to, "EXTNAME", rename, NULL, &status);
        } else {
            fits_delete_key(to, "EXTNAME", &status);
        }
        ok(status);
    }
    status = 0;
    fits_clear_errmsg();
    fits_close_file(in, &status);
    ok(status);
    return found;
}

/* An empty file, without even a primary HDU. */
static fitsfile *create_bare(const char *path) {
    fitsfile *f = NULL;
    int status = 0;
    unlink(path);
    fits_create_diskfile(&f, path, &status);
    ok(status);
    return f;
}

enum how { EACH_FIRST, EACH_PRIMARY, EACH_NAMED, ONE_BY_NAME, ONE_BY_NUMBER, IN_PLACE, N_HOW };

/* A name for the field, in the primary header of its galaxies. */
static void name_field(fitsfile *to) {
    int status = 0;
    fits_movabs_hdu(to, 1, NULL, &status);
    fits_write_key_str(to, "FIELD", "cut apart", NULL, &status);
    ok(status);
}

/* The parts of the field file `whole`, each in a file of its own. */
static void cut_each(const char *whole, int how, shear_input *input, char paths[][256]) {
    for (int i = 0; i < N_PARTS; i++) {
        char name[32];
        snprintf(name, sizeof name, "part%d.fits", i);
        snprintf(paths[i], sizeof paths[i], "%s", fixture_path(name));
        const bool primary = how == EACH_PRIMARY && i != SHEAR_PART_CATALOG;
        fitsfile *f = primary ? create_bare(paths[i]) : fixture_create(paths[i]);
        const bool there = cut(whole, extnames[i], f, how == EACH_NAMED ? others[i] : "");
        if (i == SHEAR_PART_GALAXY && there)
            name_field(f);
        fixture_close(f);
        input->parts[i].path = there ? paths[i] : NULL;
        input->parts[i].extname = there && how == EACH_NAMED ? others[i] : NULL;
    }
}

/* All parts in one other file, under other names, among other HDUs. */
static void cut_one(const char *whole, int how, shear_input *input, char paths[][256]) {
    static const double pixels[9] = {1.0};
    int number = 1;
    snprintf(paths[0], sizeof paths[0], "%s", fixture_path("all.fits"));
    fitsfile *f = fixture_create(paths[0]);
    name_field(f);
    fixture_append(f, &(fixture_image){.name = "X", .bitpix = -32, .naxis = 2, .axes = {3, 3}},
                   pixels);
    for (int i = N_PARTS - 1; i >= 0; i--) {
        const bool there = cut(whole, extnames[i], f, others[i]);
        number += there;
        input->parts[i].path = there ? paths[0] : NULL;
        input->parts[i].extname = there && how == ONE_BY_NAME ? others[i] : NULL;
        input->parts[i].hdu = there && how == ONE_BY_NUMBER ? number : -1;
    }
    fixture_close(f);
}

static shear_input cut_apart(const char *whole, int how, char paths[][256]) {
    shear_input input = shear_input_of_file(NULL);
    if (how == IN_PLACE) {
        for (int i = 0; i < SHEAR_PART_CATALOG; i++)
            input.parts[i].path = whole;
    } else if (how == ONE_BY_NAME || how == ONE_BY_NUMBER) {
        cut_one(whole, how, &input, paths);
    } else {
        cut_each(whole, how, &input, paths);
    }
    return input;
}

/* ---- comparing ---- */

static void same_array(const void *a, const void *b, size_t bytes, const char *what) {
    assert_int_equal(a != NULL, b != NULL);
    if (a != NULL && memcmp(a, b, bytes) != 0)
        fail_msg("%s differ", what);
}

static void same_blocks(const shear_block *a, const shear_block *b, const shear_field_info *info) {
    const shear_geometry *g = &info->geometry;
    const size_t n = (size_t)a->stamps.count;
    const size_t pixels = (size_t)g->nx * (size_t)g->ny * sizeof(double);
    const size_t samples = (size_t)g->psf_nx * (size_t)g->psf_ny * sizeof(double);
    assert_int_equal(a->stamps.count, b->stamps.count);
    assert_int_equal(a->stamps.n_psf, b->stamps.n_psf);
    same_array(a->galaxy, b->galaxy, n * pixels, "galaxies");
    same_array(a->noise, b->noise, n * pixels, "noises");
    same_array(a->psf, b->psf, (size_t)a->stamps.n_psf * samples, "PSFs");
    same_array(a->psf_index, b->psf_index, n * sizeof *a->psf_index, "PSF indices");
    same_array(a->id, b->id, n * sizeof *a->id, "ids");
    same_array(a->mask, b->mask, n * sizeof *a->mask, "masks");
    const double *const x[] = {a->x, a->y, a->ra, a->dec, a->weight, a->r_gal};
    const double *const y[] = {b->x, b->y, b->ra, b->dec, b->weight, b->r_gal};
    for (int i = 0; i < 6; i++)
        same_array(x[i], y[i], n * sizeof(double), "columns");
}

static void same_info(const shear_field_info *a, const shear_field_info *b) {
    assert_memory_equal(&a->geometry, &b->geometry, sizeof a->geometry);
    assert_int_equal(a->n_stamps, b->n_stamps);
    assert_int_equal(a->n_psf, b->n_psf);
    assert_int_equal(a->layout, b->layout);
    assert_int_equal(a->psf_layout, b->psf_layout);
    assert_int_equal(a->columns, b->columns);
    assert_int_equal(a->bitpix, b->bitpix);
}

static void same_fields(shear_field *a, shear_field *b) {
    enum { CHUNK = 4 };
    shear_error err = {0};
    shear_block *x = NULL;
    shear_block *y = NULL;
    const shear_field_info *info = shear_field_get_info(a);
    same_info(info, shear_field_get_info(b));
    assert_int_equal(shear_block_new(&x, info, CHUNK, &err), SHEAR_OK);
    assert_int_equal(shear_block_new(&y, shear_field_get_info(b), CHUNK, &err), SHEAR_OK);
    for (int64_t at = 0; at < info->n_stamps; at += CHUNK) {
        const int64_t left = info->n_stamps - at;
        const int count = left < CHUNK ? (int)left : CHUNK;
        assert_int_equal(shear_field_read(a, at, count, x, &err), SHEAR_OK);
        assert_int_equal(shear_field_read(b, at, count, y, &err), SHEAR_OK);
        same_blocks(x, y, info);
    }
    double p[9 * 7];
    double q[9 * 7];
    for (int64_t i = 0; i < info->n_psf; i++) {
        assert_int_equal(shear_field_read_psf(a, i, p, &err), SHEAR_OK);
        assert_int_equal(shear_field_read_psf(b, i, q, &err), SHEAR_OK);
        same_array(p, q, sizeof p, "PSFs");
    }
    shear_block_free(x);
    shear_block_free(y);
}

static shear_field *open_input(const shear_input *input, const int *fds) {
    shear_error err = {0};
    shear_field *field = NULL;
    if (shear_field_open_input(&field, input, fds, &err) != SHEAR_OK) {
        char text[SHEAR_INPUT_TEXT_SIZE];
        fail_msg("%s: %s", shear_input_text(input, text, sizeof text), err.message);
    }
    return field;
}

static void open_fds(const shear_input *input, int fds[SHEAR_N_PARTS]) {
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        const char *path = input->parts[i].path;
        fds[i] = path != NULL ? open(path, O_RDONLY | O_CLOEXEC) : -1;
        assert_true(path == NULL || fds[i] >= 0);
    }
}

static void close_fds(const int fds[SHEAR_N_PARTS]) {
    for (int i = 0; i < SHEAR_N_PARTS; i++) {
        if (fds[i] >= 0)
            close(fds[i]);
    }
}

static void checksum(const shear_input *input, const int *fds, char sum[SHEAR_CHECKSUM_SIZE]) {
    shear_error err = {0};
    shear_field *field = open_input(input, fds);
    assert_int_equal(shear_input_checksum(input, fds, shear_field_get_info(field), sum, &err),
                     SHEAR_OK);
    shear_field_close(field);
}

/* ---- round trips ---- */

/* By paths, and by descriptors that know nothing of them. */
static void check_cut(const char *whole, int how) {
    char paths[N_PARTS][256];
    char by_path[SHEAR_CHECKSUM_SIZE];
    char by_fd[SHEAR_CHECKSUM_SIZE];
    int fds[SHEAR_N_PARTS];
    const shear_input input = cut_apart(whole, how, paths);
    const shear_input one = shear_input_of_file(whole);
    shear_field *a = open_input(&one, NULL);
    shear_field *b = open_input(&input, NULL);
    same_fields(a, b);
    assert_int_equal(shear_field_get_info(b)->separate, how != IN_PLACE);
    assert_int_equal(shear_field_get_info(a)->separate, false);
    assert_string_equal(shear_field_get_info(b)->name, how == IN_PLACE ? "round" : "cut apart");
    shear_field_close(b);
    checksum(&input, NULL, by_path);
    open_fds(&input, fds);
    shear_input nameless = input;
    for (int i = 0; i < N_PARTS; i++)
        nameless.parts[i].path = input.parts[i].path != NULL ? "round.fits" : NULL;
    b = open_input(&nameless, fds);
    same_fields(a, b);
    checksum(&nameless, fds, by_fd);
    assert_string_equal(by_path, by_fd);
    shear_field_close(b);
    shear_field_close(a);
    close_fds(fds);
}

static void every_layout_every_cut(void **state) {
    (void)state;
    static const struct {
        int64_t n_psf;
        unsigned columns;
    } kinds[] = {{1, 0},
                 {10, 0},
                 {4, SHEAR_COL_PSF_ID},
                 {1, SHEAR_COL_WEIGHT | SHEAR_COL_FLAGS | SHEAR_COL_ID | SHEAR_COL_RA},
                 {10, SHEAR_COL_PSF_ID | SHEAR_COL_R_GAL | SHEAR_COL_X}};
    const char *whole = strdup(fixture_path("round.fits"));
    for (int i = 0; i < 5 * 2 * 2; i++) {
        shear_field_spec s = fixture_spec();
        s.layout = i % 2 == 0 ? SHEAR_LAYOUT_CUBE : SHEAR_LAYOUT_MOSAIC;
        s.bitpix = i / 2 % 2 == 0 ? -32 : -64;
        s.n_psf = kinds[i / 4].n_psf;
        s.columns = kinds[i / 4].columns;
        fixture_write(whole, &s);
        for (int how = 0; how < N_HOW; how++)
            check_cut(whole, how);
    }
    free((char *)(uintptr_t)whole);
}

/* A part may be packed in another way than the others. */
static void packed_parts(void **state) {
    (void)state;
    char paths[N_PARTS][256];
    char packed[256];
    const char *whole = strdup(fixture_path("round.fits"));
    fixture_write_good(whole);
    snprintf(packed, sizeof packed, "%s", fixture_path("noise.fits.gz"));
    shear_input input = cut_apart(whole, EACH_FIRST, paths);
    fixture_gzip(input.parts[SHEAR_PART_NOISE].path, packed);
    input.parts[SHEAR_PART_NOISE].path = packed;
    const shear_input one = shear_input_of_file(whole);
    shear_field *a = open_input(&one, NULL);
    shear_field *b = open_input(&input, NULL);
    same_fields(a, b);
    assert_true(shear_field_get_info(b)->gzipped);
    shear_field_close(a);
    shear_field_close(b);
    free((char *)(uintptr_t)whole);
}

/* A field file's own catalog holds for its galaxies unless another is given: flags are not
 * dropped because the noise is elsewhere. */
static void catalog_of_the_galaxies(void **state) {
    (void)state;
    char paths[N_PARTS][256];
    const char *whole = strdup(fixture_path("round.fits"));
    shear_field_spec s = fixture_spec();
    s.columns = SHEAR_COL_FLAGS;
    fixture_write(whole, &s);
    shear_input input = cut_apart(whole, EACH_FIRST, paths);
    input.parts[SHEAR_PART_GALAXY].path = whole;
    input.parts[SHEAR_PART_CATALOG].path = NULL;
    shear_field *field = open_input(&input, NULL);
    assert_int_equal(shear_field_get_info(field)->columns, SHEAR_COL_FLAGS);
    assert_int_equal(shear_field_get_info(field)->hdu[SHEAR_PART_CATALOG], 4);
    shear_field_close(field);
    free((char *)(uintptr_t)whole);
}

/* ---- identity ---- */

static void identity(void **state) {
    (void)state;
    char paths[N_PARTS][256];
    char plain[SHEAR_CHECKSUM_SIZE];
    char sums[4][SHEAR_CHECKSUM_SIZE];
    const char *whole = strdup(fixture_path("round.fits"));
    fixture_write_good(whole);
    assert_int_equal(shear_file_checksum(whole, plain, NULL), SHEAR_OK);
    /* Parts of one field file are that file. */
    shear_input input = cut_apart(whole, IN_PLACE, paths);
    checksum(&input, NULL, sums[0]);
    assert_string_equal(sums[0], plain);
    /* Not how HDUs are named, but which they are. */
    input = cut_apart(whole, ONE_BY_NAME, paths);
    checksum(&input, NULL, sums[0]);
    input = cut_apart(whole, ONE_BY_NUMBER, paths);
    checksum(&input, NULL, sums[1]);
    assert_string_equal(sums[0], sums[1]);
    const shear_input_part galaxy = input.parts[SHEAR_PART_GALAXY];
    input.parts[SHEAR_PART_GALAXY] = input.parts[SHEAR_PART_NOISE];
    input.parts[SHEAR_PART_NOISE] = galaxy;
    checksum(&input, NULL, sums[2]);
    assert_string_not_equal(sums[0], sums[2]);
    /* The content of every file counts, their names do not. */
    input = cut_apart(whole, EACH_FIRST, paths);
    checksum(&input, NULL, sums[0]);
    for (int i = 0; i < SHEAR_PART_CATALOG; i++) {
        size_t size = 0;
        unsigned char *bytes = fixture_load(paths[i], &size);
        char moved[256];
        snprintf(moved, sizeof moved, "%s", fixture_path("moved.fits"));
        fixture_save(moved, bytes, size);
        shear_input other = input;
        other.parts[i].path = moved;
        if (i != SHEAR_PART_GALAXY) { /* the field is named after it, but that is another matter */
            checksum(&other, NULL, sums[1]);
            assert_string_equal(sums[0], sums[1]);
        }
        bytes[size - 2880] ^= 1;
        fixture_save(moved, bytes, size);
        checksum(&other, NULL, sums[1]);
        assert_string_not_equal(sums[0], sums[1]);
        free(bytes);
    }
    free((char *)(uintptr_t)whole);
}

static void texts(void **state) {
    (void)state;
    char text[200];
    char small[8];
    shear_input input = shear_input_of_file("/a/b.fits");
    assert_string_equal(shear_input_text(&input, text, sizeof text), "/a/b.fits");
    input =
        (shear_input){.parts = {{"g.fits", "SCI", -1}, {"n.fits", NULL, 0}, {"p.fits", NULL, -1}}};
    assert_string_equal(shear_input_text(&input, text, sizeof text),
                        "g.fits:SCI + n.fits:0 + p.fits");
    assert_string_equal(shear_input_text(&input, small, sizeof small), "g.fits:");
    assert_string_equal(shear_part_name(SHEAR_PART_CATALOG), "catalog");
    assert_string_equal(shear_part_name(-1), "unknown");
}

/* ---- what does not fit ---- */

/* Opening fails with `code`; the message says `word`, and names the file that is at fault. */
static void refused(const shear_input *input, const int *fds, int code, const char *file,
                    const char *word) {
    shear_error err = {0};
    shear_field *field = (shear_field *)1;
    const int rc = shear_field_open_input(&field, input, fds, &err);
    if (rc != code || field != NULL || strstr(err.message, word) == NULL ||
        (file != NULL && strstr(err.message, file) == NULL)) {
        fail_msg("code %d, not %d; '%s' should say '%s' of '%s'", rc, code, err.message, word,
                 file != NULL ? file : "");
    }
}

static shear_input good(char paths[][256]) {
    const char *whole = fixture_path("round.fits");
    char copy[256];
    snprintf(copy, sizeof copy, "%s", whole);
    shear_field_spec s = fixture_spec();
    s.columns = SHEAR_COL_WEIGHT;
    fixture_write(copy, &s);
    return cut_apart(copy, EACH_NAMED, paths);
}

static void wrong_hdus(void **state) {
    (void)state;
    char paths[N_PARTS][256];
    const shear_input fine = good(paths);
    shear_input input = fine;
    input.parts[SHEAR_PART_NOISE].extname = "SCI";
    refused(&input, NULL, SHEAR_E_FORMAT, "part1.fits", "has no HDU SCI (its extensions: SKY)");
    input = fine;
    input.parts[SHEAR_PART_PSF].extname = NULL;
    input.parts[SHEAR_PART_PSF].hdu = 2;
    refused(&input, NULL, SHEAR_E_FORMAT, "part2.fits", "has no HDU number 2 (its last is 1)");
    input.parts[SHEAR_PART_PSF].hdu = INT64_MAX;
    refused(&input, NULL, SHEAR_E_FORMAT, "part2.fits", "has no HDU number");
    input.parts[SHEAR_PART_PSF].hdu = 0; /* an empty primary HDU */
    refused(&input, NULL, SHEAR_E_FORMAT, "part2.fits", "must have 2 or 3 axes");
    input = fine;
    input.parts[SHEAR_PART_GALAXY] = fine.parts[SHEAR_PART_CATALOG];
    refused(&input, NULL, SHEAR_E_FORMAT, "part3.fits", "is given both as galaxy and as catalog");
    input.parts[SHEAR_PART_CATALOG].path = NULL;
    refused(&input, NULL, SHEAR_E_FORMAT, "part3.fits", "must be an image, but is a table");
    input.parts[SHEAR_PART_GALAXY].extname = NULL;
    refused(&input, NULL, SHEAR_E_FORMAT, "part3.fits", "has no HDU that holds an image");
    input = fine;
    input.parts[SHEAR_PART_CATALOG] = (shear_input_part){fine.parts[SHEAR_PART_PSF].path, NULL, -1};
    refused(&input, NULL, SHEAR_E_FORMAT, "part2.fits", "has no HDU that holds a binary table");
    input = fine;
    input.parts[SHEAR_PART_NOISE] = fine.parts[SHEAR_PART_GALAXY];
    refused(&input, NULL, SHEAR_E_FORMAT, "part0.fits", "is given both as galaxy and as noise");
    input.parts[SHEAR_PART_NOISE].path = NULL;
    refused(&input, NULL, SHEAR_E_FORMAT, NULL, "no file for the noise");
}

static void parts_that_do_not_match(void **state) {
    (void)state;
    char paths[N_PARTS][256];
    char other[256];
    const shear_input fine = good(paths);
    snprintf(other, sizeof other, "%s", fixture_path("other.fits"));
    shear_field_spec s = fixture_spec();
    s.n_stamps = 9;
    s.columns = SHEAR_COL_WEIGHT;
    s.n_psf = 9;
    fixture_write(other, &s);
    shear_input input = fine;
    input.parts[SHEAR_PART_NOISE] = (shear_input_part){other, NULL, -1};
    refused(&input, NULL, SHEAR_E_FORMAT, "other.fits",
            "9 stamps of 12 x 10 pixels, but SCI has 10");
    input = fine;
    input.parts[SHEAR_PART_CATALOG] = (shear_input_part){other, NULL, -1};
    refused(&input, NULL, SHEAR_E_FORMAT, "other.fits", "it has 9 rows");
    input = fine;
    input.parts[SHEAR_PART_PSF] = (shear_input_part){other, NULL, -1};
    refused(&input, NULL, SHEAR_E_FORMAT, "other.fits", "it has 9 images for 10 stamps");
}

static void bad_files(void **state) {
    (void)state;
    char paths[N_PARTS][256];
    const shear_input fine = good(paths);
    for (int i = 0; i < N_PARTS; i++) {
        size_t size = 0;
        shear_input input = fine;
        input.parts[i].path = "/nowhere/absent.fits";
        refused(&input, NULL, SHEAR_E_IO, "absent.fits", "cannot be opened");
        input.parts[i].path = fixture_path("..");
        refused(&input, NULL, SHEAR_E_IO, NULL, "a directory");
        char fifo[256];
        snprintf(fifo, sizeof fifo, "%s", fixture_path("pipe"));
        unlink(fifo);
        assert_int_equal(mkfifo(fifo, 0600), 0);
        input.parts[i].path = fifo;
        refused(&input, NULL, SHEAR_E_IO, "pipe", "FIFO");
        unsigned char *bytes = fixture_load(paths[i], &size);
        char broken[256];
        snprintf(broken, sizeof broken, "%s", fixture_path("broken.fits"));
        fixture_save(broken, bytes, size - 2880);
        input.parts[i].path = broken;
        refused(&input, NULL, SHEAR_E_FORMAT, "broken.fits", "would end at byte");
        fixture_save(broken, "", 0);
        refused(&input, NULL, SHEAR_E_FORMAT, "broken.fits", "is empty");
        free(bytes);
    }
}

static void bad_descriptors(void **state) {
    (void)state;
    char paths[N_PARTS][256];
    int fds[SHEAR_N_PARTS];
    const shear_input input = good(paths);
    open_fds(&input, fds);
    for (int i = 0; i < N_PARTS; i++) {
        int wrong[SHEAR_N_PARTS];
        memcpy(wrong, fds, sizeof wrong);
        wrong[i] = open(paths[i], O_WRONLY | O_CLOEXEC);
        assert_true(wrong[i] >= 0);
        refused(&input, wrong, SHEAR_E_IO, paths[i], "not open for reading");
        close(wrong[i]);
        wrong[i] = 1000; /* no descriptor has this number */
        refused(&input, wrong, SHEAR_E_IO, paths[i], "descriptor");
    }
    /* They are the caller's still, and where they were. */
    for (int i = 0; i < N_PARTS; i++)
        assert_int_equal(lseek(fds[i], 0, SEEK_CUR), 0);
    close_fds(fds);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layout_every_cut),
        cmocka_unit_test(packed_parts),
        cmocka_unit_test(catalog_of_the_galaxies),
        cmocka_unit_test(identity),
        cmocka_unit_test(texts),
        cmocka_unit_test(wrong_hdus),
        cmocka_unit_test(parts_that_do_not_match),
        cmocka_unit_test(bad_files),
        cmocka_unit_test(bad_descriptors),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
