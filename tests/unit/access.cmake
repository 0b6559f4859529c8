# SPDX-License-Identifier: GPL-3.0-or-later
# Who may read what. The tests see the room's inner headers too.
foreach(name access beneath)
  shear_add_test(${name} SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${name}.c LIBRARIES sheard_access LABELS access)
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/daemon/access)
endforeach()
