/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How files are opened, checksummed and put in place: names, kinds of files, descriptors,
 * permissions. */
#include "fits_fixture.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
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
        assert_int_equal(rc, SHEAR_OK);
        const shear_field_info *info = shear_field_get_info(field);
        if (names[i][0] == ' ') { /* fine for a file, not for a field */
            assert_string_equal(info->name, "");
            assert_int_equal(shear_field_need_name(info, path, &err), SHEAR_E_FORMAT);
        } else {
            assert_int_equal(shear_field_need_name(info, path, &err), SHEAR_OK);
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
    for (int fd = 0; fd < 256; fd++)
        n += fcntl(fd, F_GETFD) >= 0;
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

/* One thread's work: good files are read right, bad ones fail, each handle for itself. */
static void *use_files(void *argument) {
    const char *const *paths = argument; /* plain, gzipped, compressed, bad */
    for (int round = 0; round < 10; round++) {
        for (int i = 0; i < 4; i++) {
            shear_field *field = NULL;
            shear_error err = {0};
            const int rc = shear_field_open(&field, paths[i], &err);
            bool right = i == 3 ? rc == SHEAR_E_FORMAT && strstr(err.message, "OVERSAMP") != NULL
                                : rc == SHEAR_OK;
            if (rc == SHEAR_OK) {
                double psf[9 * 7];
                right = right && shear_field_read_psf(field, 0, psf, &err) == SHEAR_OK &&
                        psf[10] == floor(fabs(fixture_pixel(FIXTURE_PSF, 0, 1, 1)));
            }
            shear_field_close(field);
            if (!right)
                return argument;
        }
    }
    return NULL;
}

static void many_threads(void **state) {
    (void)state;
    enum { THREADS = 4 };
    char paths[4][600];
    const char *list[4];
    static const char *const names[] = {"t.fits", "t.fits.gz", "t.fits.fz", "t-bad.fits"};
    const fixture_image plain = {.bitpix = 16, .axes = {12, 10}};
    const fixture_image packed = {.bitpix = 16, .axes = {12, 10}, .compression = HCOMPRESS_1};
    for (int i = 0; i < 4; i++) {
        snprintf(paths[i], sizeof paths[i], "%s", fixture_path(names[i]));
        list[i] = paths[i];
    }
    fixture_write_like(paths[0], &plain, 4);
    fixture_gzip(paths[0], paths[1]);
    fixture_write_like(paths[2], &packed, 4);
    fixture_write_like(paths[3], &plain, 4);
    fixture_patch(paths[3], "PSF", "OVERSAMP", "0");
    pthread_t threads[THREADS];
    for (int i = 0; i < THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, use_files, list), 0);
    for (int i = 0; i < THREADS; i++) {
        void *wrong = NULL;
        assert_int_equal(pthread_join(threads[i], &wrong), 0);
        assert_null(wrong);
    }
}

/* In a child without rights: what root may do proves nothing. */
static void as_nobody(void (*act)(const char *path), const char *path) {
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (geteuid() == 0 && (setegid(65534) != 0 || seteuid(65534) != 0))
            _exit(77);
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
    if (open(path, O_RDONLY) >= 0)
        _exit(2);
    if (shear_field_open_fd(&field, passed_fd, "passed", &err) != SHEAR_OK) {
        fprintf(stderr, "%s\n", err.message);
        _exit(3);
    }
    if (first_pixel(field) != fixture_pixel(FIXTURE_GALAXY, 0, 0, 0))
        _exit(4);
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

/* In steps of any size the sum is that of the whole, and each step reads about as much as it may.
 */
static void checksums_in_steps(void **state) {
    (void)state;
    enum { SIZE = (1 << 20) + 1 };
    static const int64_t steps[] = {1, 1 << 17, (1 << 17) + 1, 1 << 20, SIZE, INT64_MAX};
    char whole[SHEAR_CHECKSUM_SIZE];
    char sum[SHEAR_CHECKSUM_SIZE];
    const char *path = fixture_path("steps");
    char *bytes = malloc(SIZE);
    memset(bytes, 'a', SIZE);
    shear_bytes_checksum(bytes, SIZE, whole);
    fixture_save(path, bytes, SIZE);
    const shear_input input = shear_input_of_file(path);
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        shear_hashing *h = NULL;
        int n = 0;
        assert_int_equal(shear_hashing_new(&h, &input, NULL, NULL, NULL), SHEAR_OK);
        for (bool done = false; !done; n++) {
            const int64_t before = shear_hashing_bytes(h);
            assert_int_equal(shear_hashing_step(h, steps[i], &done, NULL), SHEAR_OK);
            assert_true(shear_hashing_bytes(h) > before || done);
            assert_true(steps[i] >= SIZE ||
                        shear_hashing_bytes(h) - before <= steps[i] + (1 << 17));
        }
        assert_true(n >= 2 || steps[i] >= SIZE);
        assert_int_equal(shear_hashing_bytes(h), SIZE);
        shear_hashing_text(h, sum);
        assert_string_equal(sum, whole);
        shear_hashing_free(h);
    }
    free(bytes);
}

/* A file that is written as fast as it is read would be read for ever. */
static void checksum_of_what_grows(void **state) {
    (void)state;
    shear_hashing *h = NULL;
    shear_error err = {0};
    bool done = false;
    const char *path = fixture_path("grows");
    fixture_save(path, "some", 4);
    const shear_input input = shear_input_of_file(path);
    const int fd = open(path, O_WRONLY | O_APPEND);
    assert_int_equal(shear_hashing_new(&h, &input, NULL, NULL, &err), SHEAR_OK);
    assert_int_equal(shear_hashing_step(h, 1, &done, &err), SHEAR_OK);
    assert_false(done);
    assert_int_equal(write(fd, "more", 4), 4);
    assert_int_equal(shear_hashing_step(h, 1, &done, &err), SHEAR_E_IO);
    assert_non_null(strstr(err.message, "grows"));
    shear_hashing_free(h);
    close(fd);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_no_file),
        cmocka_unit_test(names_are_only_names),
        cmocka_unit_test(messages_stay_readable),
        cmocka_unit_test(descriptors),
        cmocka_unit_test(memory_files),
        cmocka_unit_test(no_descriptor_is_left_open),
        cmocka_unit_test(many_threads),
        cmocka_unit_test(permissions),
        cmocka_unit_test(checksums),
        cmocka_unit_test(checksums_in_steps),
        cmocka_unit_test(checksum_of_what_grows),
    };
    return cmocka_run_group_tests(tests, fixture_setup, fixture_teardown);
}
