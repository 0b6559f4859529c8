# SPDX-License-Identifier: GPL-3.0-or-later
# Exposures: images, masks, and their pixels. What needs real files is skipped where they are not.

function(survey_pixels_test name)
  shear_add_test(${name} SOURCES test_${name}.c exposure_fixture.c scarce.c LIBRARIES fits_fixtures Threads::Threads LABELS survey TIMEOUT 120)
  target_compile_definitions(test_${name} PRIVATE SHEAR_SHARED="${SHEAR_SHARED}")
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/core)
  target_link_options(test_${name} PRIVATE -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc)
endfunction()

survey_pixels_test(exposure_images)
survey_pixels_test(chip_pixels)
survey_pixels_test(chip_bands)
