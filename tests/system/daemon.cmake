# SPDX-License-Identifier: GPL-3.0-or-later
# The service as a real process: killed, starved, lied to. tests/soak/run does the same at full length.
add_library(faultshim MODULE ${CMAKE_CURRENT_LIST_DIR}/faultshim.c)
target_compile_definitions(faultshim PRIVATE _GNU_SOURCE)
if(SHEAR_SANITIZE) # preloaded into a sanitized program, it must not bring a sanitizer of its own
  target_link_libraries(faultshim PRIVATE ${CMAKE_DL_LIBS})
else()
  target_link_libraries(faultshim PRIVATE shear_flags ${CMAKE_DL_LIBS})
endif()
set_target_properties(faultshim PROPERTIES C_VISIBILITY_PRESET default)
add_dependencies(faultshim sheard sheard-reader shearctl)

# Sanitizers make all of it slow: fewer kills, faults and malformed files there; the seeds are the same.
set(counts "")
set(hangs 600) # seconds after which a test hangs
if(SHEAR_SANITIZE)
  set(hangs 1200)
  set(counts ";SHEARD_CRASHES=4;SHEARD_FAULTS=1;SHEARD_MUTANTS=80;SHEARD_CLIENTS=100;SHEARD_MALFORMED=200;SHEARD_JOBS=200;SHEARD_DROPPED=30;SHEARD_DROPPED_KILLS=4")
endif()
set(names # one a line: whoever adds one does not get into another's way
  access
  basic
  budget
  catalogs
  clock
  crash
  disk
  dropped
  exposures
  faults
  floods
  hostile
  log
  memory
  probe
  names
  problems
  reader
  results
  retract
  roots
  sources
  symmetry
  under_unit)
foreach(name ${names})
  add_test(NAME system_daemon_${name}
    COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_LIST_DIR}/test_daemon_${name}.py)
  set_tests_properties(system_daemon_${name} PROPERTIES
    LABELS "system;daemon" TIMEOUT ${hangs}
    ENVIRONMENT "SHEARD=$<TARGET_FILE:sheard>;SHEARCTL=$<TARGET_FILE:shearctl>;FAULTSHIM=$<TARGET_FILE:faultshim>;SHEAR_SANITIZED=${sanitized};SHEARD_SERVICE=${PROJECT_BINARY_DIR}/systemd/sheard.service${counts}")
endforeach()

add_test(NAME system_library COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_LIST_DIR}/test_library.py)
set_tests_properties(system_library PROPERTIES
  LABELS system TIMEOUT 600
  ENVIRONMENT "BUILD=${PROJECT_BINARY_DIR};CMAKE=${CMAKE_COMMAND};SHEARCTL=$<TARGET_FILE:shearctl>;SHEAR_SANITIZED=${sanitized}")
add_test(NAME system_install COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_LIST_DIR}/test_install.py)
set_tests_properties(system_install PROPERTIES
  LABELS "system;daemon" TIMEOUT 600
  ENVIRONMENT "BUILD=${PROJECT_BINARY_DIR};CMAKE=${CMAKE_COMMAND};SHEARD=$<TARGET_FILE:sheard>;SHEARCTL=$<TARGET_FILE:shearctl>;SHEAR_SANITIZED=${sanitized}")
