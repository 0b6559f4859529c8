/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measure a field file: file FIELD.fits [SETTING=VALUE]... */
#include <shear.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int fail(const shear_error *err) {
    fprintf(stderr, "%s (%s)\n", err->message, err->advice);
    return EXIT_FAILURE;
}

/* Parse a setting, for example "beta-ratio=2.5"; the settings are those of shearctl(1). */
static int set(shear_settings *settings, const char *assignment, shear_error *err) {
    char name[64];
    const char *equals = strchr(assignment, '=');
    if (equals == NULL || (size_t)(equals - assignment) >= sizeof name) {
        return shear_fail(err, SHEAR_E_SETTING, "write SETTING=VALUE", "no setting: %s",
                          assignment);
    }
    snprintf(name, sizeof name, "%.*s", (int)(equals - assignment), assignment);
    return shear_settings_set(settings, name, equals + 1, err);
}

int main(int argc, char **argv) {
    shear_error err;
    shear_settings settings;
    shear_run_report report;
    shear_field_sums *sums = NULL; /* sums of several files, if they are parts of one field */
    if (argc < 2) {
        fprintf(stderr, "usage: file FIELD.fits [SETTING=VALUE]...\n");
        return EXIT_FAILURE;
    }
    shear_settings_init(&settings);
    for (int i = 2; i < argc; i++) {
        if (set(&settings, argv[i], &err) != SHEAR_OK)
            return fail(&err);
    }
    if (shear_field_sums_new(&sums, &err) != SHEAR_OK)
        return fail(&err);
    const int code = shear_run_file(argv[1], &settings, NULL, sums, NULL, &report, &err);
    shear_field_sums_free(sums);
    if (code != SHEAR_OK)
        return fail(&err);
    const shear_result *r = &report.result;
    printf("g1 = %+.17g +- %.2g\n", r->g1, r->g1_err);
    printf("g2 = %+.17g +- %.2g\n", r->g2, r->g2_err);
    printf("%lld of %lld stamps, beta = %.3f px, %s\n", (long long)r->n_used,
           (long long)r->n_stamps, report.plan.beta_px, shear_estimator_name(r->estimator));
    return EXIT_SUCCESS;
}
