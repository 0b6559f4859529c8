# SPDX-License-Identifier: GPL-3.0-or-later
# Sky maps of exposures. Real headers of surveys are compared with where there are any: they are no part of this tree.
add_library(sky_fixtures STATIC sky_fixture.c)
target_link_libraries(sky_fixtures PUBLIC fits_fixtures)
target_include_directories(sky_fixtures PUBLIC ${PROJECT_SOURCE_DIR}/core)

function(survey_wcs_test name)
  shear_add_test(${name} SOURCES test_${name}.c LIBRARIES sky_fixtures ${ARGN} LABELS survey TIMEOUT 60)
endfunction()

survey_wcs_test(sky_map Threads::Threads)
survey_wcs_test(sky_keywords)
survey_wcs_test(sky_surface)
survey_wcs_test(sky_distortion)
survey_wcs_test(sky_hostile)
survey_wcs_test(sky_truth PkgConfig::JANSSON)
target_compile_definitions(test_sky_truth PRIVATE SHEAR_SHARED="${SHEAR_SHARED}")
survey_wcs_test(head_file)
shear_add_test(sky_nomem SOURCES test_sky_nomem.c scarce.c LIBRARIES sky_fixtures LABELS survey)
target_link_options(test_sky_nomem PRIVATE -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc)
