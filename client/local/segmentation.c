/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "local/segmentation.h"

#include <inttypes.h>
#include <stdio.h>

/* One in ten may be: of source-extractor none is. */
enum { FEWEST = 5, SHARE = 10 };

const char *segmentation_warning(int64_t looked_at, int64_t unowned, char *line, size_t size) {
    if (unowned < FEWEST || SHARE * unowned <= looked_at)
        return NULL;
    snprintf(line, size,
             "by the segmentation there is sky where %" PRId64 " of %" PRId64
             " galaxies are, so that neighbours stay in the stamps: is it of this chip, of the run "
             "that made the catalog, with the same DETECT_THRESH?",
             unowned, looked_at);
    return line;
}
