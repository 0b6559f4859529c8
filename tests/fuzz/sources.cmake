# SPDX-License-Identifier: GPL-3.0-or-later
# Any bytes as a catalog of sources, like fuzz_field.
if(SHEAR_FUZZ)
  get_target_property(source_sources shear_survey SOURCES)
  list(FILTER source_sources INCLUDE REGEX ^sources/)
  list(TRANSFORM source_sources PREPEND ${PROJECT_SOURCE_DIR}/core/survey/)
  add_executable(fuzz_sources fuzz_sources.c mutator.c cards.c ${source_sources} ${fits_sources})
  target_compile_definitions(fuzz_sources PRIVATE SHEAR_FUZZ)
  target_include_directories(fuzz_sources PRIVATE ${PROJECT_SOURCE_DIR}/core)
  target_link_libraries(fuzz_sources PRIVATE shear_flags shear_static PkgConfig::CFITSIO PkgConfig::XXHASH
    PkgConfig::ZLIB)
  target_compile_options(fuzz_sources PRIVATE -fsanitize=fuzzer)
  target_link_options(fuzz_sources PRIVATE -fsanitize=fuzzer)
endif()

add_executable(fuzz_sources_replay fuzz_sources.c cards.c source_seeds.c standalone.c)
target_link_libraries(fuzz_sources_replay PRIVATE source_fixtures)
set_target_properties(fuzz_sources_replay PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
add_test(NAME fuzz_sources_replay COMMAND fuzz_sources_replay --mutants 2000)
set_tests_properties(fuzz_sources_replay PROPERTIES LABELS "survey;fuzz" TIMEOUT 120)
