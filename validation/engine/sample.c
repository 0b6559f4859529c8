/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/sample.h"

#include <stdlib.h>

/* A run under way: the ledger's chunks are the sample's groups. */
struct run {
    const sample_spec *spec;
    struct sampler *sampler; /* made when the first group is to be measured */
    int groups;
    int64_t unit; /* stamps that stay together */
    shear_row *rows;
};

static int64_t copies(const sample_spec *spec) {
    int64_t most = 1;
    for (int i = 0; i < spec->n_scenes; i++) {
        most = spec->scenes[i].spec.rotate > most ? spec->scenes[i].spec.rotate : most;
    }
    return most;
}

/* The first stamp of a group; groups end where the next begins. */
static int64_t begin_of(const struct run *run, int group) {
    int64_t units = (run->spec->stamps + run->unit - 1) / run->unit;
    int64_t at = units * group / run->groups * run->unit;
    return at < run->spec->stamps ? at : run->spec->stamps;
}

static int prepare(struct run *run, shear_error *err) {
    if (run->sampler != NULL) {
        return SHEAR_OK;
    }
    int64_t most = run->unit * (run->spec->stamps / run->unit / run->groups + 2);
    run->rows = calloc((size_t)most * (size_t)run->spec->n_series, sizeof *run->rows);
    if (run->rows == NULL) {
        return shear_fail(err, SHEAR_E_NOMEM, "use more groups",
                          "out of memory for the rows of a group");
    }
    return sampler_new(&run->sampler, run->spec, err);
}

static int measure_group(void *context, int group, double *values, shear_error *err) {
    struct run *run = context;
    int64_t first = begin_of(run, group);
    int count = (int)(begin_of(run, group + 1) - first);
    int code = prepare(run, err);
    code = code != SHEAR_OK ? code : sampler_rows(run->sampler, first, count, run->rows, err);
    for (int i = 0; code == SHEAR_OK && i < run->spec->n_series; i++) {
        shear_block_sums sums;
        shear_block_sums_init(&sums);
        for (int k = 0; k < count; k++) {
            shear_block_sums_add(&sums, &run->rows[(size_t)i * (size_t)count + (size_t)k]);
        }
        tally_pack(&sums, values + i * TALLY_PACKED);
    }
    return code;
}

static int fill_tally(struct tally *t, const double *values) {
    for (int group = 0; group < t->groups; group++) {
        for (int i = 0; i < t->n_series; i++) {
            tally_unpack(values + (group * t->n_series + i) * TALLY_PACKED, tally_at(t, i, group));
        }
    }
    return SHEAR_OK;
}

int sample_measure(const sample_spec *spec, struct ledger *ledger, struct tally **tally,
                   shear_error *err) {
    struct run run = {.spec = spec, .groups = spec->groups, .unit = copies(spec)};
    int64_t units = (spec->stamps + run.unit - 1) / run.unit;
    run.groups = units < run.groups ? (int)units : run.groups;
    int values = spec->n_series * TALLY_PACKED;
    double *packed = calloc((size_t)run.groups * (size_t)values, sizeof *packed);
    struct task task = {.name = spec->name,
                        .chunks = run.groups,
                        .values = values,
                        .stamps_of_chunk = spec->stamps / run.groups * spec->n_scenes,
                        .work = measure_group,
                        .context = &run};
    int code = packed != NULL
                   ? tally_new(tally, spec->n_series, run.groups, err)
                   : shear_fail(err, SHEAR_E_NOMEM, NULL, "out of memory for the sums of a sample");
    code = code != SHEAR_OK ? code : ledger_run(ledger, &task, packed, err);
    code = code != SHEAR_OK ? code : fill_tally(*tally, packed);
    if (code != SHEAR_OK && packed != NULL) {
        tally_free(*tally);
        *tally = NULL;
    }
    free(packed);
    free(run.rows);
    sampler_free(run.sampler);
    return code;
}
