# SPDX-License-Identifier: GPL-3.0-or-later
# The tests of daemon/engine.
shear_add_test(engine_plans SOURCES test_engine_plans.c
  LIBRARIES core_fixtures sheard_engine Threads::Threads LABELS engine)
shear_add_test(machine SOURCES test_machine.c LIBRARIES core_fixtures sheard_engine LABELS engine)
shear_add_test(processors SOURCES test_processors.c LIBRARIES core_fixtures sheard_engine LABELS engine)
# The sandbox itself, around a hostile program. (A sanitizer's runtime calls more than it allows.)
if(NOT SHEAR_SANITIZE)
  shear_add_test(sandbox SOURCES test_sandbox.c ${PROJECT_SOURCE_DIR}/daemon/reader/sandbox.c
    ${PROJECT_SOURCE_DIR}/daemon/reader/namespaces.c
    ${PROJECT_SOURCE_DIR}/daemon/reader/fstat.c
    LIBRARIES core_fixtures PkgConfig::SECCOMP LABELS engine)
  target_include_directories(test_sandbox PRIVATE ${PROJECT_SOURCE_DIR}/daemon)
endif()
