# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DSHEARCTL=... -DIN=... -DOUT=... -P paste.cmake: the template with what shearctl says of itself as @DATA@.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${SHEARCTL} help --completion-data OUTPUT_VARIABLE DATA RESULT_VARIABLE result
  OUTPUT_STRIP_TRAILING_WHITESPACE)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "shearctl help --completion-data failed: ${result}")
endif()
configure_file(${IN} ${OUT} @ONLY)
