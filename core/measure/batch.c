/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measure stamps in memory with a team of OpenMP threads. */
#include "base/cleanup.h"
#include "measure/internal.h"

#include <omp.h>
#include <stdlib.h>

/* Distribute the blocks of the batch over the team. Every row depends on its stamp alone. */
static int measure_blocks(const shear_plan *plan, const shear_stamps *stamps, int threads,
                          shear_workspace *const *ws, shear_row *rows, shear_error *err) {
    const int blocks = (stamps->count + SHEAR_BLOCK - 1) / SHEAR_BLOCK;
    int first_bad = blocks;
    int code = SHEAR_OK;
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (int b = 0; b < blocks; b++) {
        const int from = b * SHEAR_BLOCK;
        const int to = from + SHEAR_BLOCK < stamps->count ? from + SHEAR_BLOCK : stamps->count;
        shear_error local;
        const int block_code = shear_measure_range(plan, ws[omp_get_thread_num()], stamps, from, to,
                                                   rows + from, &local);
        if (block_code != SHEAR_OK) {
#pragma omp critical(shear_batch_error)
            if (b < first_bad) {
                first_bad = b;
                code = block_code;
                if (err != NULL)
                    *err = local;
            }
        }
    }
    return code;
}

/* One workspace per thread. */
typedef struct workspaces {
    shear_workspace **each; /* [n] */
    int n;
} workspaces;

static void workspaces_deinit(workspaces *w) {
    for (int i = 0; w->each != NULL && i < w->n; i++)
        shear_workspace_free(w->each[i]);
    free(w->each);
}

int shear_measure_batch(const shear_plan *plan, const shear_stamps *stamps, int threads,
                        shear_workspace *const *ws, shear_row *rows, shear_error *err) {
    const int team = threads > 0 ? threads : omp_get_max_threads();
    if (ws != NULL)
        return measure_blocks(plan, stamps, team, ws, rows, err);
    CLEANUP(workspaces_deinit) workspaces own = {.n = team};
    own.each = calloc((size_t)team, sizeof(shear_workspace *));
    if (own.each == NULL)
        return shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for %d workspaces", team);
    for (int i = 0; i < team; i++)
        TRY(shear_workspace_new(&own.each[i], plan, err));
    return measure_blocks(plan, stamps, team, own.each, rows, err);
}
