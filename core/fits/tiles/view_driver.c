/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An I/O driver of CFITSIO that reads views.
 *
 * A driver identifies an open file by a small number; a view's is its slot in a table. The name
 * that is passed to CFITSIO ("sheard://12") is made here and holds no user input.
 *
 * Lock: `lock` guards the table and is held for a look-up only. A view is read only by the thread
 * that has its fitsfile, so the position in its slot needs no lock. */
#include "fits/tiles/view_driver.h"

#include "base/io.h"

#include <assert.h>
#include <fitsio2.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_VIEWS = 1024 };

static const char prefix[] = "sheard://";

static struct {
    const sf_view *view; /* NULL = free */
    int64_t position;
} slots[MAX_VIEWS];
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static pthread_once_t once = PTHREAD_ONCE_INIT;
static int registered = -1; /* CFITSIO's status of the registration */

static int claim(const sf_view *v) {
    int slot = -1;
    pthread_mutex_lock(&lock);
    for (int i = 0; i < MAX_VIEWS && slot < 0; i++)
        slot = slots[i].view == NULL ? i : -1;
    if (slot >= 0) {
        slots[slot].view = v;
        slots[slot].position = 0;
    }
    pthread_mutex_unlock(&lock);
    return slot;
}

void sf_view_driver_release(sf_view *v) {
    if (v->slot > 0) {
        pthread_mutex_lock(&lock);
        slots[v->slot - 1].view = NULL;
        pthread_mutex_unlock(&lock);
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

static int on_close(int handle) {
    (void)handle; /* the slot belongs to the view until sf_view_deinit */
    return 0;
}

static int on_size(int handle, LONGLONG *size) {
    assert(handle >= 0 && handle < MAX_VIEWS && slots[handle].view != NULL);
    *size = padded_bytes(slots[handle].view);
    return 0;
}

static int on_flush(int handle) {
    (void)handle;
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
                                 on_close, NULL, on_size, on_flush, on_seek, on_read, NULL);
    }
}

int sf_view_driver_open(sf_view *v, fitsfile **fits, int *status, shear_error *err) {
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
