/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fits/header/rows.h"

#include "base/io.h"

#include <assert.h>
#include <errno.h>

int sf_rows_bytes(const sf_rows *r, int64_t row, int64_t offset, int64_t bytes, void *out,
                  shear_error *err) {
    assert(row >= 0 && offset >= 0 && bytes >= 0);
    const int64_t at = r->start + row * r->width + offset;
    const ssize_t n = io_read_at(r->fd, out, (size_t)bytes, (off_t)at);
    if (n < 0)
        return sf_fail_errno(err, r->at, errno, "cannot be read");
    if (n < bytes) {
        return sf_fail(err, SHEAR_E_FORMAT, r->at, "leave a file alone while it is read",
                       "its data end at row %lld: the file has become shorter", (long long)row + 1);
    }
    return SHEAR_OK;
}
