# SPDX-License-Identifier: GPL-3.0-or-later
# Who may read what. The tests see the private headers of the room, too.
foreach(name access beneath)
  shear_add_test(${name} SOURCES ${CMAKE_CURRENT_LIST_DIR}/test_${name}.c LIBRARIES sheard_access LABELS access)
endforeach()
