# SPDX-License-Identifier: GPL-3.0-or-later
# Cutting stamp pairs out of a chip, which is in memory instead of a file.
add_library(chip_fixtures STATIC chip_fixture.c)
target_link_libraries(chip_fixtures PUBLIC shear_flags shear_static PkgConfig::CMOCKA m)
target_include_directories(chip_fixtures PUBLIC ${CMAKE_CURRENT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/core)
target_link_options(chip_fixtures PUBLIC -Wl,--wrap=chip_pixels_read)

function(cutout_test name)
  shear_add_test(${name} SOURCES test_${name}.c LIBRARIES chip_fixtures ${ARGN} LABELS cutout)
endfunction()

cutout_test(cutter)
target_link_options(test_cutter PRIVATE -Wl,--wrap=aligned_alloc)
cutout_test(cutter_shear core_fixtures)
cutout_test(cutter_noise core_fixtures)
cutout_test(amplifiers core_fixtures)
cutout_test(quiet_blocks core_fixtures)

# The same on files, by the room that reads them.
shear_add_test(cutter_chip SOURCES test_cutter_chip.c exposure_fixture.c LIBRARIES fits_fixtures LABELS cutout)
target_compile_definitions(test_cutter_chip PRIVATE SHEAR_SHARED="${SHEAR_SHARED}")
target_include_directories(test_cutter_chip PRIVATE ${PROJECT_SOURCE_DIR}/core)
