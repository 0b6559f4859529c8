# SPDX-License-Identifier: GPL-3.0-or-later
# The tests of daemon/store. They include its private headers, and SQLite.
add_library(store_fixtures STATIC store_fixture.c store_audit.c store_vfs.c store_model.c)
target_link_libraries(store_fixtures PUBLIC
  sheard_store shear_flags PkgConfig::CMOCKA PkgConfig::SQLITE)
target_include_directories(store_fixtures PUBLIC
  ${CMAKE_CURRENT_SOURCE_DIR})

function(store_test name)
  shear_add_test(store_${name}
    SOURCES test_store_${name}.c ${ARGN} LIBRARIES store_fixtures LABELS store TIMEOUT 400)
endfunction()

store_test(open)
store_test(old)
store_test(submit)
store_test(life)
store_test(finish)
store_test(accounts)
store_test(terms)
store_test(retract)
store_test(pages)
store_test(retire)
store_test(groups)
store_test(sums_text)
store_test(plans)
store_test(audit)
store_test(model)
store_test(faults store_actions.c store_faults.c)
store_test(fault_groups store_actions.c store_faults.c)
store_test(fault_open store_actions.c store_faults.c)
store_test(crash)
