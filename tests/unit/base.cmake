# SPDX-License-Identifier: GPL-3.0-or-later
# The lowest room.
foreach(name accounts array io spelling text utf8)
  shear_add_test(base_${name} SOURCES test_base_${name}.c LIBRARIES sheard_base LABELS base)
  target_include_directories(test_base_${name} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
endforeach()
