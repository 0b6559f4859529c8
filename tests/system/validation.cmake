# SPDX-License-Identifier: GPL-3.0-or-later
# The paper's experiments in the small, one test each.
foreach(name Usage Noise Images Single Pixels Overall Shot Bias Errors Efficiency Survey Precision Narrow Selection)
  string(TOLOWER ${name} lower)
  add_test(NAME validation_${lower}
    COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_SOURCE_DIR}/test_validation.py ${name})
  set_tests_properties(validation_${lower} PROPERTIES
    LABELS validation TIMEOUT 300
    ENVIRONMENT "SHEAR_PAPER=$<TARGET_FILE:shear-paper>")
endforeach()
