/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store/page.h: pages of records: their largest size. One record more than the limit is read, to
 * see whether more follow. */
#pragma once

#include "store/store.h"

static inline size_t page_limit(size_t limit) {
    return limit < STORE_PAGE_MAX ? limit : STORE_PAGE_MAX;
}

static inline int page_no_memory(shear_error *err) {
    return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for a page of records");
}
