# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DSHEARCTL=... -DIN=... -DOUT=... -DPROJECT_VERSION=... -DDATE=... -P paste.cmake
# The manual page with what the tool says of itself pasted in: the settings' table and the help of most subcommands are
# written once, in the tool.
cmake_minimum_required(VERSION 3.25)

function(ask out)
  execute_process(COMMAND ${SHEARCTL} help ${ARGN}
    OUTPUT_VARIABLE text RESULT_VARIABLE result OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "shearctl help ${ARGN} failed: ${result}")
  endif()
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

# Plain text as roff: backslashes and hyphens as such, and no control line by accident.
function(escape out text)
  string(REPLACE "\\" "\\e" text "${text}")
  string(REPLACE "-" "\\-" text "${text}")
  string(REGEX REPLACE "(^|\n)([.'])" "\\1\\\\&\\2" text "${text}")
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

ask(SETTINGS --settings-man)
foreach(name mock plot
    submit jobs show wait cancel retry field fields watch status metrics doctor drain reload shutdown)
  string(TOUPPER ${name} key)
  ask(text --man ${name})
  escape(HELP_${key} "${text}")
endforeach()
configure_file(${IN} ${OUT} @ONLY)
