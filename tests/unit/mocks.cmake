# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of mocks/. They see its inner headers too (random.h and so on).
add_library(mock_fixture STATIC test_mock_fixture.c)
target_link_libraries(mock_fixture PUBLIC shear_flags shear_mocks shear_static PkgConfig::GSL PkgConfig::CMOCKA m)
target_include_directories(mock_fixture PUBLIC ${CMAKE_CURRENT_LIST_DIR} ${PROJECT_SOURCE_DIR}/mocks)

function(mock_test name)
  shear_add_test(mock_${name} SOURCES ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/test_mock_${name}.c ${ARGN}
    LIBRARIES mock_fixture LABELS mocks)
endfunction()

mock_test(random)
mock_test(psf)
mock_test(galaxy)
mock_test(stamps)
mock_test(noise)
mock_test(options)
mock_test(write)
mock_test(exposure)
mock_test(exposure_files)
target_link_libraries(test_mock_exposure_files PRIVATE PkgConfig::CFITSIO)

mock_test(command)
target_link_libraries(test_mock_command PRIVATE shear_client)
