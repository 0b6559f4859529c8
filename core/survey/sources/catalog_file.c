/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "survey/sources/catalog_file.h"

#include "base/cleanup.h"
#include "base/io.h"
#include "fits/io/gunzip.h"
#include "survey/sources/object_tables.h"
#include "survey/sources/text_table.h"

#include <errno.h>

/* A file that is being opened; each step replaces its descriptor. */
typedef struct opening {
    char name[sizeof((sf_file *)0)->source.name];
    sf_place at;
    int fd;
    int64_t size;
    unsigned char head[16]; /* its first bytes: [n] */
    ssize_t n;
} opening;

static void opening_deinit(opening *o) {
    release_fd(&o->fd);
}

static void replace(opening *o, int fd) {
    release_fd(&o->fd);
    o->fd = fd;
}

static int look(opening *o, shear_error *err) {
    o->n = io_read_at(o->fd, o->head, sizeof o->head, 0);
    return o->n >= 0 ? SHEAR_OK : sf_fail_errno(err, o->at, errno, "cannot be read");
}

static int unpack(opening *o, shear_error *err) {
    int unpacked = -1;
    TRY(sf_gunzip(o->fd, o->at, true, &unpacked, &o->size, err));
    replace(o, unpacked);
    return look(o, err);
}

static int convert(opening *o, shear_error *err) {
    int converted = -1;
    if (o->head[0] != '#') {
        return sf_fail(
            err, SHEAR_E_FORMAT, o->at,
            "write the catalog with CATALOG_TYPE FITS_LDAC, or ASCII_HEAD; a text without "
            "a head does not name its columns",
            "is neither FITS nor SExtractor's ASCII_HEAD: it begins with neither 'SIMPLE  "
            "=' nor '#'");
    }
    TRY(text_table_convert(o->fd, o->at, OBJECT_TEXT_ROWS, &converted, err));
    replace(o, converted);
    return SHEAR_OK;
}

int catalog_file_open(sf_file *file, const char *path, int fd, shear_error *err) {
    CLEANUP(opening_deinit) opening o = {.fd = -1};
    o.at.file = o.name;
    *file = (sf_file){.source.fd = -1};
    sf_printable_name(o.name, sizeof o.name, path);
    TRY(sf_open_regular(path, fd, o.at, &o.fd, &o.size, err));
    TRY(look(&o, err));
    if (sf_is_gzip(o.head, o.n))
        TRY(unpack(&o, err));
    if (o.n > 0 && !sf_is_fits(o.head, o.n))
        TRY(convert(&o, err));
    return sf_file_open(file, path, o.fd, err);
}
