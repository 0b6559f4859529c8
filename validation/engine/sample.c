/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/sample.h"

#include "engine/must.h"

#include <stdlib.h>

/* A running measurement: the chunks of the cache are the groups of the sample. */
typedef struct grouped {
    const sample *of;
    sampler *sampler;     /* created when the first group must be measured */
    int64_t stamps, unit; /* total; number of rotated copies, which stay in one group */
    int threads, groups;
    shear_row *rows;
} grouped;

static int64_t copies(const sample *of) {
    int64_t most = 1;
    for (int i = 0; i < of->n_scenes; i++) {
        const int rotate = of->scenes[i].spec.rotate;
        most = rotate > most ? rotate : most;
    }
    return most;
}

/* Return the first stamp of a group, which is the end of the group before. */
static int64_t begin_of(const grouped *g, int group) {
    const int64_t units = (g->stamps + g->unit - 1) / g->unit;
    const int64_t at = units * group / g->groups * g->unit;
    return at < g->stamps ? at : g->stamps;
}

static void prepare(grouped *g) {
    const int64_t most = g->unit * (g->stamps / g->unit / g->groups + 2);
    const size_t n = (size_t)most * (size_t)g->of->n_series;
    g->rows = must_allocate(n, sizeof *g->rows, "the rows of a group");
    g->sampler = sampler_new(g->of, g->stamps, g->threads);
}

static void measure_group(void *context, int group, double *values) {
    grouped *g = context;
    const int64_t first = begin_of(g, group);
    const int count = (int)(begin_of(g, group + 1) - first);
    if (g->sampler == NULL)
        prepare(g);
    sampler_rows(g->sampler, first, count, g->rows);
    for (int i = 0; i < g->of->n_series; i++) {
        shear_block_sums sums;
        shear_block_sums_init(&sums);
        for (int k = 0; k < count; k++)
            shear_block_sums_add(&sums, &g->rows[(size_t)i * (size_t)count + (size_t)k]);
        jackknife_pack(&sums, values + i * JACKKNIFE_PACKED);
    }
}

void sample_measure(const options *o, cache *c, const sample *what, jackknife_sums *sums) {
    grouped g = {.of = what,
                 .stamps = what->stamps > 0 ? what->stamps : o->galaxies,
                 .unit = copies(what),
                 .threads = o->threads};
    const int64_t units = (g.stamps + g.unit - 1) / g.unit;
    g.groups = units < o->groups ? (int)units : o->groups;
    const cache_task task = {.name = what->name,
                             .chunks = g.groups,
                             .values = what->n_series * JACKKNIFE_PACKED,
                             .stamps_of_chunk = g.stamps / g.groups * what->n_scenes,
                             .work = measure_group,
                             .context = &g};
    CLEANUP(release_free) double *packed = cache_run(c, &task);
    const int first = sums->n_series;
    jackknife_sums_extend(sums, what->n_series, g.groups);
    for (int i = 0; i < g.groups * what->n_series; i++) {
        jackknife_unpack(packed + i * JACKKNIFE_PACKED,
                         jackknife_sums_at(sums, first + i % what->n_series, i / what->n_series));
    }
    free(g.rows);
    sampler_free(g.sampler);
}
