/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/tiles/view.h"

#include "base/cleanup.h"
#include "base/io.h"
#include "base/thread.h"
#include "fits/header/card.h"

#include <assert.h>
#include <fitsio2.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* ---- the header ---- */

void sf_view_init(sf_view *v, const sf_file *file, const sf_hdu *hdu) {
    *v = (sf_view){.file = file, .data_offset = hdu->data_offset, .data_bytes = hdu->data_bytes};
}

static void add(sf_view *v, const char *text) {
    char padded[SF_CARD + 1];
    snprintf(padded, sizeof padded, "%-80.80s", text);
    buffer_add(&v->header, padded, SF_CARD);
}

static void __attribute__((format(printf, 3, 4)))
add_value(sf_view *v, const char *key, const char *format, ...) {
    char value[71];
    char card[SF_CARD + 1];
    va_list args;
    va_start(args, format);
    vsnprintf(value, sizeof value, format, args);
    va_end(args);
    snprintf(card, sizeof card, "%-8.8s= %20s", key, value);
    add(v, card);
}

void sf_view_logical(sf_view *v, const char *key, bool value) {
    add_value(v, key, "%s", value ? "T" : "F");
}

void sf_view_int(sf_view *v, const char *key, int64_t value) {
    add_value(v, key, "%lld", (long long)value);
}

void sf_view_double(sf_view *v, const char *key, double value) {
    add_value(v, key, "%.17G", value);
}

void sf_view_string(sf_view *v, const char *key, const char *value) {
    add_value(v, key, "'%-8.60s'", value);
}

void sf_view_scale(sf_view *v, double scale, double zero) {
    if (scale != 1.0 || zero != 0.0) {
        sf_view_double(v, "BSCALE", scale);
        sf_view_double(v, "BZERO", zero);
    }
}

static void add_primary(sf_view *v) {
    sf_view_logical(v, "SIMPLE", true);
    sf_view_int(v, "BITPIX", 8);
    sf_view_int(v, "NAXIS", 0);
    sf_view_logical(v, "EXTEND", true);
    sf_view_end(v);
}

void sf_view_table(sf_view *v, const sf_hdu *hdu, int64_t heap, int columns) {
    add_primary(v);
    sf_view_string(v, "XTENSION", "BINTABLE");
    sf_view_int(v, "BITPIX", 8);
    sf_view_int(v, "NAXIS", 2);
    sf_view_int(v, "NAXIS1", hdu->axes[0]);
    sf_view_int(v, "NAXIS2", hdu->axes[1]);
    sf_view_int(v, "PCOUNT", heap);
    sf_view_int(v, "GCOUNT", 1);
    sf_view_int(v, "TFIELDS", columns);
}

void sf_view_end(sf_view *v) {
    add(v, "END");
    while (!v->header.failed && v->header.n % SF_BLOCK_BYTES != 0)
        add(v, "");
}

/* ---- an I/O driver of CFITSIO that reads views ----
 *
 * A driver identifies an open file by a small number; a view's is its slot in a table. The name
 * that is passed to CFITSIO ("sheard://12") is made here and holds no user input.
 *
 * Lock: `lock` guards the table and is held for a look-up only. A view is read only by the thread
 * that has its fitsfile, so the position in its slot needs no lock. */

enum { MAX_VIEWS = 1024 };

static const char prefix[] = "sheard://";

static struct {
    const sf_view *view; /* NULL = free */
    int64_t position;
} slots[MAX_VIEWS];
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static pthread_once_t once = PTHREAD_ONCE_INIT;
static int registered = -1; /* CFITSIO's status of the registration */

/* Return a free slot, which is the view's then, or -1. */
static int claim(const sf_view *v) {
    LOCKED(&lock);
    for (int i = 0; i < MAX_VIEWS; i++) {
        if (slots[i].view == NULL) {
            slots[i].view = v;
            slots[i].position = 0;
            return i;
        }
    }
    return -1;
}

static void release_slot(sf_view *v) {
    if (v->slot > 0) {
        LOCKED(&lock);
        slots[v->slot - 1].view = NULL;
        v->slot = 0;
    }
}

static int64_t padded_bytes(const sf_view *v) {
    return (int64_t)v->header.n + sf_padded(v->data_bytes);
}

static int on_open(char *name, int mode, int *handle) {
    const long slot = strtol(name, NULL, 10);
    if (mode != READONLY || slot < 0 || slot >= MAX_VIEWS)
        return FILE_NOT_OPENED;
    *handle = (int)slot;
    return 0;
}

/* Close and flush do nothing: the slot belongs to the view until sf_view_deinit. */
static int on_nothing(int handle) {
    (void)handle;
    return 0;
}

static int on_size(int handle, LONGLONG *size) {
    assert(handle >= 0 && handle < MAX_VIEWS && slots[handle].view != NULL);
    *size = padded_bytes(slots[handle].view);
    return 0;
}

static int on_seek(int handle, LONGLONG offset) {
    slots[handle].position = offset;
    return 0;
}

/* Read from the data; zeros fill the last block. */
static int read_data(const sf_view *v, int64_t from, char *out, int64_t bytes) {
    const int64_t left = v->data_bytes > from ? v->data_bytes - from : 0;
    const int64_t wanted = left < bytes ? left : bytes;
    const ssize_t n =
        io_read_at(v->file->source.fd, out, (size_t)wanted, (off_t)(v->data_offset + from));
    if (n < wanted)
        return n < 0 ? READ_ERROR : END_OF_FILE;
    memset(out + wanted, 0, (size_t)(bytes - wanted));
    return 0;
}

static int on_read(int handle, void *into, long bytes) {
    const sf_view *v = slots[handle].view;
    int64_t *position = &slots[handle].position;
    char *out = into;
    if (bytes < 0 || *position < 0 || *position > padded_bytes(v) - bytes)
        return END_OF_FILE;
    const int64_t header_bytes = (int64_t)v->header.n;
    int64_t of_header = header_bytes - *position;
    of_header = of_header < 0 ? 0 : of_header > bytes ? bytes : of_header;
    if (of_header > 0)
        memcpy(out, v->header.bytes + *position, (size_t)of_header);
    const int64_t from = *position + of_header - header_bytes;
    *position += bytes;
    return bytes > of_header ? read_data(v, from, out + of_header, bytes - of_header) : 0;
}

static void register_driver(void) {
    char name[sizeof prefix];
    memcpy(name, prefix, sizeof prefix);
    registered = fits_init_cfitsio(); /* first, or the driver would replace one of CFITSIO's own */
    if (registered == 0) {
        registered =
            fits_register_driver(name, NULL, NULL, NULL, NULL, NULL, NULL, on_open, NULL, NULL,
                                 on_nothing, NULL, on_size, on_nothing, on_seek, on_read, NULL);
    }
}

/* Have CFITSIO open the view, whose header is complete. */
static int open_slot(sf_view *v, fitsfile **fits, int *status, shear_error *err) {
    pthread_once(&once, register_driver);
    if (registered != 0 || fits_is_reentrant() == 0) {
        return shear_fail(err, SHEAR_E_INTERNAL, "install a CFITSIO built with --enable-reentrant",
                          "this CFITSIO is not reentrant, or takes no driver");
    }
    const int slot = claim(v);
    if (slot < 0)
        return shear_fail(err, SHEAR_E_IO, NULL, "more than %d images are open", MAX_VIEWS);
    v->slot = slot + 1;
    char name[32];
    snprintf(name, sizeof name, "%s%d", prefix, slot);
    fits_open_file(fits, name, READONLY, status);
    return SHEAR_OK;
}

/* ---- opening ---- */

int sf_view_open(sf_view *v, int number, sf_place at, fitsfile **fits, shear_error *err) {
    *fits = NULL;
    if (v->header.failed)
        return sf_fail_memory(err, at);
    int status = 0;
    TRY(open_slot(v, fits, &status, err));
    fits_movabs_hdu(*fits, number + 1, NULL, &status);
    return sf_check_status(err, at, status, "cannot be opened");
}

void sf_view_close(fitsfile *fits) {
    if (fits != NULL) {
        int status = 0;
        fits_close_file(fits, &status);
        if (status != 0)
            fits_clear_errmsg();
    }
}

void sf_view_deinit(sf_view *v) {
    release_slot(v);
    buffer_deinit(&v->header);
}
