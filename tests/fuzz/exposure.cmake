# SPDX-License-Identifier: GPL-3.0-or-later
# Any bytes as the images of an exposure, like fuzz_field.
if(SHEAR_FUZZ)
  get_target_property(pixel_sources shear_survey_pixels SOURCES)
  list(TRANSFORM pixel_sources PREPEND ${PROJECT_SOURCE_DIR}/core/survey/)
  add_executable(fuzz_exposure fuzz_exposure.c mutator.c cards.c ${pixel_sources} ${fits_sources})
  target_compile_definitions(fuzz_exposure PRIVATE SHEAR_FUZZ)
  target_include_directories(fuzz_exposure PRIVATE ${PROJECT_SOURCE_DIR}/core)
  target_link_libraries(fuzz_exposure PRIVATE shear_flags shear_static PkgConfig::CFITSIO PkgConfig::XXHASH
    PkgConfig::ZLIB)
  target_compile_options(fuzz_exposure PRIVATE -fsanitize=fuzzer)
  target_link_options(fuzz_exposure PRIVATE -fsanitize=fuzzer)
endif()

add_executable(fuzz_exposure_replay fuzz_exposure.c cards.c exposure_seeds.c standalone.c)
target_include_directories(fuzz_exposure_replay PRIVATE ${PROJECT_SOURCE_DIR}/core)
target_link_libraries(fuzz_exposure_replay PRIVATE fits_fixtures)
set_target_properties(fuzz_exposure_replay PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
add_test(NAME fuzz_exposure_replay COMMAND fuzz_exposure_replay --mutants 400)
set_tests_properties(fuzz_exposure_replay PROPERTIES LABELS "survey;fuzz" TIMEOUT 120)
