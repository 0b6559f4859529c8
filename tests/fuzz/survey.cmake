# SPDX-License-Identifier: GPL-3.0-or-later
# Any bytes as all files of an exposure, like fuzz_field.
if(SHEAR_FUZZ)
  set(survey_sources)
  foreach(room survey survey_pixels survey_wcs survey_cutout)
    get_target_property(of_room shear_${room} SOURCES)
    list(TRANSFORM of_room PREPEND ${PROJECT_SOURCE_DIR}/core/survey/)
    list(APPEND survey_sources ${of_room})
  endforeach()
  add_executable(fuzz_survey fuzz_survey.c mutator.c cards.c ${survey_sources} ${fits_sources})
  target_compile_definitions(fuzz_survey PRIVATE SHEAR_FUZZ)
  target_include_directories(fuzz_survey PRIVATE ${PROJECT_SOURCE_DIR}/core)
  target_include_directories(fuzz_survey SYSTEM PRIVATE ${RANDOM123_INCLUDE_DIR})
  target_link_libraries(fuzz_survey PRIVATE shear_flags shear_static PkgConfig::CFITSIO PkgConfig::WCSLIB
    PkgConfig::XXHASH PkgConfig::ZLIB OpenMP::OpenMP_C)
  target_compile_options(fuzz_survey PRIVATE -fsanitize=fuzzer)
  target_link_options(fuzz_survey PRIVATE -fsanitize=fuzzer)
endif()

add_executable(fuzz_survey_replay fuzz_survey.c cards.c survey_seeds.c standalone.c)
target_link_libraries(fuzz_survey_replay PRIVATE psf_fixtures)
set_target_properties(fuzz_survey_replay PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
add_test(NAME fuzz_survey_replay COMMAND fuzz_survey_replay --mutants 400)
set_tests_properties(fuzz_survey_replay PROPERTIES LABELS "survey;fuzz" TIMEOUT 120)
