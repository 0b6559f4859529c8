# SPDX-License-Identifier: GPL-3.0-or-later
# Catalogs of exposures. Real files of surveys are read, too, where there are any: they are no part of this tree.
add_library(source_fixtures STATIC source_fixture.c)
target_link_libraries(source_fixtures PUBLIC fits_fixtures)
target_include_directories(source_fixtures PUBLIC ${PROJECT_SOURCE_DIR}/core)
target_compile_definitions(source_fixtures PRIVATE SHEAR_SHARED="${SHEAR_SHARED}")

function(survey_sources_test name)
  shear_add_test(${name} SOURCES test_${name}.c LIBRARIES source_fixtures LABELS survey TIMEOUT 120)
endfunction()

survey_sources_test(sources_formats)
survey_sources_test(sources_select)
survey_sources_test(sources_hostile)
survey_sources_test(sources_many)
shear_add_test(sources_nomem SOURCES test_sources_nomem.c scarce.c LIBRARIES source_fixtures LABELS survey)
target_link_options(test_sources_nomem PRIVATE -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc)

# The real source-extractor, in the formats that it writes.
add_executable(source_dump source_dump.c)
target_link_libraries(source_dump PRIVATE source_fixtures)
set_target_properties(source_dump PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
add_test(NAME system_sextractor
  COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/tests/system/test_sextractor.py)
set_tests_properties(system_sextractor PROPERTIES LABELS "survey;system" TIMEOUT 120
  ENVIRONMENT "SOURCE_DUMP=$<TARGET_FILE:source_dump>")
