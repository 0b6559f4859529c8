# SPDX-License-Identifier: GPL-3.0-or-later
include(CTest) # BUILD_TESTING

set(CMAKE_C_STANDARD 17)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)

# Nothing of a program may stand in for a symbol of a shared library: CFITSIO, for one, has a file_read of its own, and a
# program's symbols win. So all is hidden but what libshear exports (core/libshear.map).
set(CMAKE_C_VISIBILITY_PRESET hidden)

set(SHEAR_SANITIZE "" CACHE STRING "Sanitizers, as in -fsanitize= (address,undefined or thread)")
option(SHEAR_WERROR "Warnings are errors" ON)
option(SHEAR_FUZZ "Build the libFuzzer targets (clang)" OFF)

# Flags of every target of this project.
add_library(shear_flags INTERFACE)
target_compile_definitions(shear_flags INTERFACE _GNU_SOURCE)
target_compile_options(shear_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes
  -Wvla -Wformat=2 -Wundef $<$<BOOL:${SHEAR_WERROR}>:-Werror>
  # IEEE arithmetic as written, but sqrt and exp need not set errno: this is what lets them vectorise.
  -fno-math-errno)
if(NOT SHEAR_SANITIZE) # a sanitizer's own runtime is an archive too, and must be seen
  target_link_options(shear_flags INTERFACE -Wl,--exclude-libs,ALL)
endif()
# clang warns where it could not vectorise what `omp simd` allows: a matter of speed, never in sanitizer builds.
target_compile_options(shear_flags INTERFACE $<$<C_COMPILER_ID:Clang>:-Wno-pass-failed>)
if(SHEAR_SANITIZE)
  target_compile_options(shear_flags INTERFACE
    -fsanitize=${SHEAR_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(shear_flags INTERFACE -fsanitize=${SHEAR_SANITIZE})
endif()

# shear_add_test(NAME SOURCES... [LIBRARIES...] [LABELS...] [TIMEOUT s]): one cmocka program, one ctest.
function(shear_add_test name)
  cmake_parse_arguments(T "" "TIMEOUT" "SOURCES;LIBRARIES;LABELS" ${ARGN})
  add_executable(test_${name} ${T_SOURCES})
  target_link_libraries(test_${name} PRIVATE shear_flags ${T_LIBRARIES} PkgConfig::CMOCKA m)
  # What gcc believes of the lengths of names in a test depends on how it inlines: no error in one preset only.
  target_compile_options(test_${name} PRIVATE $<$<C_COMPILER_ID:GNU>:-Wno-format-truncation>)
  set_target_properties(test_${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  add_test(NAME ${name} COMMAND test_${name} WORKING_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  if(NOT T_TIMEOUT)
    set(T_TIMEOUT 120)
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${T_LABELS}" TIMEOUT ${T_TIMEOUT})
endfunction()
