# SPDX-License-Identifier: GPL-3.0-or-later
# Catalogs of exposures. Real files of surveys are read, too, where there are any: they are no part of this tree.
set(SHEAR_SHARED ${PROJECT_SOURCE_DIR}/../shared CACHE PATH "folder with survey/, real files for the tests")
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
