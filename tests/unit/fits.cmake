# SPDX-License-Identifier: GPL-3.0-or-later
# Field files and result catalogs. The fixtures write odd files with CFITSIO itself.
add_library(fits_fixtures STATIC fits_fixture.c catalog_fixture.c)
target_include_directories(fits_fixtures PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(fits_fixtures PUBLIC shear_flags shear_static PkgConfig::CFITSIO PkgConfig::ZLIB
  PkgConfig::CMOCKA m)

function(fits_test name)
  shear_add_test(${name} SOURCES test_${name}.c LIBRARIES fits_fixtures ${ARGN} LABELS fits TIMEOUT 60)
endfunction()

fits_test(field_layouts)
fits_test(field_parts)
fits_test(field_types)
fits_test(field_oracle)
fits_test(field_errors)
fits_test(field_tiles)
fits_test(plain_pixels)
target_include_directories(test_plain_pixels PRIVATE ${PROJECT_SOURCE_DIR}/core)
fits_test(field_gzip)
fits_test(field_open)
fits_test(field_output)
fits_test(catalog)
fits_test(catalog_kept)
