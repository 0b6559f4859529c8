# SPDX-License-Identifier: GPL-3.0-or-later
# The tests of daemon/spool. They include its private headers, too.
add_library(spool_fixture STATIC ${CMAKE_CURRENT_LIST_DIR}/spool_fixture.c)
target_link_libraries(spool_fixture PUBLIC shear_flags sheard_spool PkgConfig::CMOCKA)
target_include_directories(spool_fixture PUBLIC ${CMAKE_CURRENT_LIST_DIR})

function(spool_test name)
  shear_add_test(spool_${name} SOURCES ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/test_spool_${name}.c LIBRARIES spool_fixture LABELS spool TIMEOUT 60)
endfunction()

spool_test(names)
spool_test(take)
spool_test(folders)
spool_test(end)
spool_test(keep)
spool_test(crash)
# The crash test wraps these system calls: it counts them, and makes the n-th one fail or kill the process.
target_link_options(test_spool_crash PRIVATE
  LINKER:--wrap=renameat2 LINKER:--wrap=fsync LINKER:--wrap=unlinkat LINKER:--wrap=symlinkat LINKER:--wrap=write)
