# SPDX-License-Identifier: GPL-3.0-or-later
# PSF models of exposures. Real files of surveys are compared with where there are any: they are no part of this tree.
# Objects, not an archive, so that the linker takes malloc of scarce.c.
add_library(psf_fixtures OBJECT psf_fixture.c scarce.c)
target_link_libraries(psf_fixtures PUBLIC fits_fixtures)
target_include_directories(psf_fixtures PUBLIC ${PROJECT_SOURCE_DIR}/core)
target_link_options(psf_fixtures PUBLIC -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc)
target_compile_definitions(psf_fixtures PRIVATE SHEAR_SHARED="${SHEAR_SHARED}")

function(survey_psf_test name)
  shear_add_test(${name} SOURCES test_${name}.c LIBRARIES psf_fixtures LABELS survey TIMEOUT 60)
endfunction()

survey_psf_test(psf_psfex)
survey_psf_test(psf_piff)
survey_psf_test(psf_cube)
survey_psf_test(psf_stars)
survey_psf_test(psf_star_size)
