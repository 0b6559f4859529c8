/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How files are opened, checksummed and put in place: names, kinds of files, descriptors,
 * permissions. */
#include "fits_fixture.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define END ((const char *)NULL)

static void what_is_no_file(void **state) {
    (void)state;
    fixture_expect_open(fixture_path("absent.fits"), SHEAR_E_IO, "No such file", END);
    assert_int_equal(mkdir(fixture_path("dir.fits"), 0700), 0);
    fixture_expect_open(fixture_path("dir.fits"), SHEAR_E_IO, "a directory", END);
    assert_int_equal(mkfifo(fixture_path("fifo.fits"), 0600), 0);
    fixture_expect_open(fixture_path("fifo.fits"), SHEAR_E_IO, "FIFO", END); /* and does not wait */
    fixture_expect_open("/dev/null", SHEAR_E_IO, "a device", END);
    fixture_expect_open("", SHEAR_E_IO, "No such file", END);
    char sum[SHEAR_CHECKSUM_SIZE];
    shear_error err = {0};
    assert_int_equal(shear_file_checksum(fixture_path("fifo.fits"), sum, &err), SHEAR_E_IO);
    assert_int_equal(shear_file_checksum(fixture_path("dir.fits"), sum, &err), SHEAR_E_IO);
    assert_int_equal(shear_file_checksum(fixture_path("absent.fits"), sum, &err), SHEAR_E_IO);
    assert_non_null(strstr(err.message, "absent.fits"));
}

/* Names that CFITSIO's file-name syntax would obey are names. */
static void names_are_only_names(void **state) {
    (void)state;
    static const char *const names[] = {
        "a.fits(out.fits)", "x.fits[1]",  "!y.fits",       "z.fits[GALAXY]", "w.fits+1",
        "v.fits.gz[col X]", "mem:",       " leading.fits", "~home.fits",     "u.fits?x=1",
        "s.fits[pix 1:2]",  "http:t.fits"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char path[600];
        snprintf(path, sizeof path, "%s", fixture_path(names[i]));
        const int before = fixture_count_files();
        fixture_write_good(path); /* the writer, too */
        assert_int_equal(fixture_count_files(), before + 1);
        shear_field *field = NULL;
        shear_error err = {0};
        const int rc = shear_field_open(&field, path, &err);
        if (names[i][0] == ' ') { /* fine for a file, not for a field */
            assert_int_equal(rc, SHEAR_E_FORMAT);
        } else {
            assert_int_equal(rc, SHEAR_OK);
        }
        shear_field_close(field);
        assert_int_equal(fixture_count_files(), before + 1);
    }
    fixture_expect_open(fixture_path("w.fits[1]"), SHEAR_E_IO, "No such file", END);
}

static void messages_stay_readable(void **state) {
    (void)state;
    shear_field *field = NULL;
    shear_error err = {0};
    assert_int_equal(shear_field_open(&field, "no\nsuch\x1b[31mfile", &err), SHEAR_E_IO);
    assert_non_null(strstr(err.message, "'no?such?[31mfile'"));
    char path[4000];
    memset(path, 'x', sizeof path);
    path[sizeof path - 1] = '\0';
    assert_int_equal(shear_field_open(&field, path, &err), SHEAR_E_IO);
    assert_non_null(strstr(err.message, "'...xxx"));
    assert_non_null(strstr(err.message, "too long"));
}

static double first_pixel(shear_field *field) {
    shear_block *b = NULL;
    assert_int_equal(shear_block_new(&b, shear_field_get_info(field), 1, NULL), SHEAR_OK);
    assert_int_equal(shear_field_read(field, 0, 1, b, NULL), SHEAR_OK);
    const double v = b->stamps.galaxy[0];
    shear_block_free(b);
    return v;
}

static void descriptors(void **state) {
    (void)state;
    const char *path = fixture_path("fd.fits");
    fixture_write_good(path);
    shear_field *field = NULL;
    shear_error err = {0};
    const int fd = open(path, O_RDONLY);
    assert_int_equal(lseek(fd, 1234, SEEK_SET), 1234);
    assert_int_equal(shear_field_open_fd(&field, fd, "some/given name.fits", &err), SHEAR_OK);
    assert_string_equal(shear_field_get_info(field)->name, "given name");
    assert_int_equal(lseek(fd, 0, SEEK_CUR), 1234); /* the caller's offset is his */
    assert_int_equal(unlink(path), 0);
    assert_int_equal(close(fd), 0); /* so is his descriptor */
    assert_true(first_pixel(field) == fixture_pixel(FIXTURE_GALAXY, 0, 0, 0));
    shear_field_close(field);

    assert_int_equal(shear_field_open_fd(&field, -1, "closed", &err), SHEAR_E_IO);
    assert_non_null(strstr(err.message, "'closed'"));
    const int out = open(fixture_path("out"), O_WRONLY | O_CREAT, 0600);
    assert_int_equal(shear_field_open_fd(&field, out, "out", &err), SHEAR_E_IO);
    assert_non_null(strstr(err.message, "not open for reading"));
    close(out);
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(shear_field_open_fd(&field, ends[0], "pipe", &err), SHEAR_E_IO);
    assert_non_null(strstr(err.message, "FIFO"));
    close(ends[0]);
    close(ends[1]);
}

static void memory_files(void **state) {
    (void)state;
    const char *path = fixture_path("memory.fits");
    const char *packed = fixture_path("memory.fits.gz");
    fixture_write_good(path);
    fixture_gzip(path, packed);
    for (int i = 0; i < 2; i++) {
        size_t size = 0;
        unsigned char *bytes = fixture_load(i == 0 ? path : packed, &size);
        const int fd = memfd_create("field", MFD_CLOEXEC);
        assert_int_equal(write(fd, bytes, size), size);
        free(bytes);
        shear_field *field = NULL;
        assert_int_equal(shear_field_open_fd(&field, fd, "m", NULL), SHEAR_OK);
        assert_true(first_pixel(field) == fixture_pixel(FIXTURE_GALAXY, 0, 0, 0));
        assert_int_equal(shear_field_get_info(field)->gzipped, i);
        shear_field_close(field);
        close(fd);
    }
}

static int count_descriptors(void) {
    int n = 0;
    for (int fd = 0; fd < 256; fd++) {
        n += fcntl(fd, F_GETFD) >= 0;
    }
    return n;
}

static void no_descriptor_is_left_open(void **state) {
    (void)state;
    const char *path = fixture_path("leak.fits");
    const char *packed = fixture_path("leak.fits.gz");
    fixture_write_good(path);
    fixture_gzip(path, packed);
    const int before = count_descriptors();
    for (int i = 0; i < 3; i++) {
        shear_field *field = NULL;
        assert_int_equal(shear_field_open(&field, i == 0 ? packed : path, NULL), SHEAR_OK);
        shear_field_close(field);
        fixture_patch(path, "PSF", "OVERSAMP", "0");
        assert_int_equal(shear_field_open(&field, path, NULL), SHEAR_E_FORMAT);
        fixture_patch(path, "PSF", "OVERSAMP", "1");
    }
    assert_int_equal(shear_field_open(&(shear_field *){NULL}, fixture_path("none"), NULL),
                     SHEAR_E_IO);
    assert_int_equal(count_descriptors(), before);
}

/* In a child without rights: what root may do proves nothing. */
static void as_nobody(void (*act)(const char *path), const char *path) {
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (geteuid() == 0 && (setegid(65534) != 0 || seteuid(65534) != 0)) {
            _exit(77);
        }
        prctl(PR_SET_DUMPABLE, 1); /* or /proc/self would still be root's */
        act(path);
        _exit(0);
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
}

static void open_forbidden(const char *path) {
    shear_error err = {0};
    shear_field *field = NULL;
    if (shear_field_open(&field, path, &err) != SHEAR_E_IO ||
        strstr(err.message, "Permission denied") == NULL || err.advice[0] == '\0') {
        _exit(1);
    }
}

static int passed_fd = -1;

/* A descriptor from someone who may open the file, as daemons are given them. */
static void open_passed(const char *path) {
    shear_field *field = NULL;
    shear_error err = {0};
    if (open(path, O_RDONLY) >= 0) {
        _exit(2);
    }
    if (shear_field_open_fd(&field, passed_fd, "passed", &err) != SHEAR_OK) {
        fprintf(stderr, "%s\n", err.message);
        _exit(3);
    }
    if (first_pixel(field) != fixture_pixel(FIXTURE_GALAXY, 0, 0, 0)) {
        _exit(4);
    }
    shear_field_close(field);
}

static void write_forbidden(const char *path) {
    const shear_field_spec spec = fixture_spec();
    shear_field_writer *w = NULL;
    shear_error err = {0};
    if (shear_field_create(&w, path, &spec, &err) != SHEAR_E_IO ||
        strstr(err.message, "Permission denied") == NULL) {
        _exit(1);
    }
}

static void permissions(void **state) {
    (void)state;
    const char *path = fixture_path("secret.fits");
    assert_int_equal(chmod(fixture_path(""), 0755), 0);
    fixture_write_good(path);
    assert_int_equal(chmod(path, 0), 0);
    if (geteuid() != 0) {
        fixture_expect_open(path, SHEAR_E_IO, "Permission denied", END);
        return;
    }
    passed_fd = open(path, O_RDONLY);
    assert_true(passed_fd >= 0);
    as_nobody(open_forbidden, path);
    as_nobody(open_passed, path);
    as_nobody(write_forbidden, fixture_path("new.fits"));
    close(passed_fd);
}

static void checksums(void **state) {
    (void)state;
    char sum[SHEAR_CHECKSUM_SIZE];
    const char *path = fixture_path("sum");
    fixture_save(path, "", 0);
    assert_int_equal(shear_file_checksum(path, sum, NULL), SHEAR_OK);
    assert_string_equal(sum, "99aa06d3014798d86001c324468d497f"); /* XXH3-128 of nothing */
    const size_t size = (3u << 20) + 17;                          /* several buffers */
    char *bytes = malloc(size);
    memset(bytes, 'a', size);
    fixture_save(path, bytes, size);
    char whole[SHEAR_CHECKSUM_SIZE];
    assert_int_equal(shear_file_checksum(path, whole, NULL), SHEAR_OK);
    const int fd = open(path, O_RDONLY);
    lseek(fd, 100, SEEK_SET);
    assert_int_equal(shear_fd_checksum(fd, "sum", sum, NULL), SHEAR_OK);
    assert_string_equal(sum, whole);
    assert_int_equal(lseek(fd, 0, SEEK_CUR), 100);
    close(fd);
    bytes[size - 1] = 'b';
    fixture_save(path, bytes, size);
    assert_int_equal(shear_file_checksum(path, sum, NULL), SHEAR_OK);
    assert_string_not_equal(sum, whole);
    assert_int_equal(strspn(sum, "0123456789abcdef"), 32);
    free(bytes);
}

static void expect_create(const char *path, const shear_field_spec *spec, int code,
                          const char *word) {
    shear_field_writer *w = (shear_field_writer *)1;
    shear_error err = {0};
    const int before = fixture_count_files();
    assert_int_equal(shear_field_create(&w, path, spec, &err), code);
    assert_null(w);
    if (strstr(err.message, word) == NULL || strstr(err.message, path) == NULL) {
        fail_msg("no '%s' and '%s' in: %s", word, path, err.message);
    }
    assert_int_equal(fixture_count_files(), before);
}

static void outputs_that_cannot_be(void **state) {
    (void)state;
    shear_field_spec s = fixture_spec();
    expect_create(fixture_path("no/such/file.fits"), &s, SHEAR_E_IO, "No such file");
    expect_create(fixture_path("sum/below-a-file.fits"), &s, SHEAR_E_IO, "Not a directory");
    expect_create(fixture_path("dir.fits"), &s, SHEAR_E_IO, "a directory");
    expect_create(fixture_path("dir.fits/"), &s, SHEAR_E_IO, "a directory");
    expect_create(fixture_path("fifo.fits"), &s, SHEAR_E_IO, "not a regular file");
    expect_create("/dev/null", &s, SHEAR_E_IO, "not a regular file");
    expect_create("", &s, SHEAR_E_IO, "an empty name");
    fixture_write_good(fixture_path("there.fits"));
    s.overwrite = false;
    expect_create(fixture_path("there.fits"), &s, SHEAR_E_EXISTS, "exists");
    assert_int_equal(symlink("nowhere", fixture_path("dangling.fits")), 0);
    expect_create(fixture_path("dangling.fits"), &s, SHEAR_E_EXISTS, "exists");
}

static void specs_that_cannot_be(void **state) {
    (void)state;
    const char *path = fixture_path("spec.fits");
    shear_field_spec s[20];
    for (int i = 0; i < 20; i++) {
        s[i] = fixture_spec();
    }
    s[0].geometry.nx = 7;
    s[1].geometry.ny = 1025;
    s[2].geometry.psf_nx = 2;
    s[3].geometry.psf_ny = 4097;
    s[4].geometry.psf_oversample = 0;
    s[5].geometry.psf_oversample = 65;
    s[6].n_stamps = 0;
    s[7].n_psf = 0;
    s[8].n_psf = 5;
    s[9].layout = 2;
    s[10].mosaic_columns = 11;
    s[11].mosaic_columns = -1;
    s[12].bitpix = 16;
    s[13].name = "";
    s[14].name = "tab\t";
    s[15].pixscale = 0.0;
    s[16].pixscale = INFINITY;
    s[17].has_truth = true;
    s[17].sim_g1 = 1.0;
    s[18].has_truth = true;
    s[18].sim_g2 = NAN;
    s[19].n_stamps = INT64_C(1) << 40;
    for (int i = 0; i < 20; i++) {
        expect_create(path, &s[i], SHEAR_E_SETTING, "");
    }
}

static shear_field_writer *begin(const char *path, bool overwrite) {
    shear_field_spec s = fixture_spec();
    shear_field_writer *w = NULL;
    s.overwrite = overwrite;
    s.n_stamps = 2;
    assert_int_equal(shear_field_create(&w, path, &s, NULL), SHEAR_OK);
    return w;
}

static void complete(shear_field_writer *w) {
    static const double pixels[2 * 12 * 10];
    assert_int_equal(shear_field_write(w, 0, 2, pixels, pixels, NULL, NULL), SHEAR_OK);
    assert_int_equal(shear_field_write_psf(w, 0, pixels, NULL), SHEAR_OK);
}

/* A file appears under its name when it is finished, and not before. */
static void files_appear_at_once(void **state) {
    (void)state;
    const char *path = fixture_path("atomic.fits");
    const int before = fixture_count_files();
    shear_field_writer *w = begin(path, false);
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(fixture_count_files(), before + 1); /* the temporary one */
    shear_field_abort(w);
    assert_int_equal(fixture_count_files(), before);
    shear_field_abort(NULL);

    w = begin(path, false);
    complete(w);
    fixture_save(path, "taken", 5); /* by someone else, meanwhile */
    shear_error err = {0};
    assert_int_equal(shear_field_finish(w, &err), SHEAR_E_EXISTS);
    size_t size = 0;
    free(fixture_load(path, &size));
    assert_int_equal(size, 5);
    assert_int_equal(fixture_count_files(), before + 1);

    w = begin(path, true);
    complete(w);
    free(fixture_load(path, &size));
    assert_int_equal(size, 5);
    assert_int_equal(shear_field_finish(w, &err), SHEAR_OK);
    assert_int_equal(fixture_count_files(), before + 1);
    shear_field *field = NULL;
    assert_int_equal(shear_field_open(&field, path, &err), SHEAR_OK);
    shear_field_close(field);
}

static void incomplete_files_do_not_appear(void **state) {
    (void)state;
    static const double pixels[2 * 12 * 10];
    const char *path = fixture_path("incomplete.fits");
    const int before = fixture_count_files();
    shear_error err = {0};
    shear_field_writer *w = begin(path, true);
    assert_int_equal(shear_field_write_psf(w, 0, pixels, NULL), SHEAR_OK);
    assert_int_equal(shear_field_write(w, 0, 1, pixels, pixels, NULL, NULL), SHEAR_OK);
    assert_int_equal(shear_field_finish(w, &err), SHEAR_E_INTERNAL);
    assert_non_null(strstr(err.message, "stamp 1"));
    w = begin(path, true);
    assert_int_equal(shear_field_write(w, 0, 2, pixels, pixels, NULL, NULL), SHEAR_OK);
    assert_int_equal(shear_field_finish(w, &err), SHEAR_E_INTERNAL);
    assert_non_null(strstr(err.message, "PSF image 0"));
    w = begin(path, true);
    assert_int_equal(shear_field_write(w, 1, 2, pixels, pixels, NULL, &err), SHEAR_E_INTERNAL);
    assert_int_equal(shear_field_write(w, -1, 1, pixels, pixels, NULL, &err), SHEAR_E_INTERNAL);
    assert_int_equal(shear_field_write_psf(w, 1, pixels, &err), SHEAR_E_INTERNAL);
    shear_field_abort(w);
    shear_field_spec s = fixture_spec();
    s.columns = SHEAR_COL_X;
    assert_int_equal(shear_field_create(&w, path, &s, &err), SHEAR_OK);
    assert_int_equal(shear_field_write(w, 0, 1, pixels, pixels, NULL, &err), SHEAR_E_INTERNAL);
    assert_non_null(strstr(err.message, "column X"));
    shear_field_abort(w);
    assert_int_equal(fixture_count_files(), before);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_no_file),
        cmocka_unit_test(names_are_only_names),
        cmocka_unit_test(messages_stay_readable),
        cmocka_unit_test(descriptors),
        cmocka_unit_test(memory_files),
        cmocka_unit_test(no_descriptor_is_left_open),
        cmocka_unit_test(permissions),
        cmocka_unit_test(checksums),
        cmocka_unit_test(outputs_that_cannot_be),
        cmocka_unit_test(specs_that_cannot_be),
        cmocka_unit_test(files_appear_at_once),
        cmocka_unit_test(incomplete_files_do_not_appear),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
