# SPDX-License-Identifier: GPL-3.0-or-later
# Exposures as a whole: chips, and where light is. After survey_psf.cmake, whose fixtures write tables.
shear_add_test(chip SOURCES test_chip.c LIBRARIES psf_fixtures LABELS survey TIMEOUT 120)
shear_add_test(second_moments SOURCES test_second_moments.c LIBRARIES fits_fixtures LABELS survey)
target_include_directories(test_second_moments PRIVATE ${PROJECT_SOURCE_DIR}/core)
shear_add_test(half_light SOURCES test_half_light.c LIBRARIES fits_fixtures LABELS survey)
target_include_directories(test_half_light PRIVATE ${PROJECT_SOURCE_DIR}/core)
shear_add_test(centring SOURCES test_centring.c LIBRARIES shear_protocol fits_fixtures LABELS survey)
