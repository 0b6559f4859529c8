// SPDX-License-Identifier: GPL-3.0-or-later
// libshear from C++: every name in the headers is that of a C function.
#include <cstdio>
#include <cstring>
#include <shear.h>

int main() {
    shear_settings settings;
    shear_settings_init(&settings);
    shear_error error = {};
    if (shear_settings_set(&settings, "estimator", "pdf-sym", &error) != SHEAR_OK ||
        settings.estimator != SHEAR_ESTIMATOR_PDF_SYM) {
        return 1;
    }
    shear_result result = {};
    const shear_arrays none = {};
    if (shear_measure_arrays(&result, &none, &settings, nullptr, &error) != SHEAR_E_FORMAT) {
        return 2;
    }
    std::puts(shear_version());
    return std::strcmp(shear_version(), SHEAR_VERSION_STRING) == 0 ? 0 : 3;
}
