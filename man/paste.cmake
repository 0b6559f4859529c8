# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DSHEARCTL=... -DIN=... -DOUT=... -DPROJECT_VERSION=... -DDATE=... -P paste.cmake
# The manual page with what the tool says of itself pasted in: the settings' table and the help of most subcommands are
# written once, in the tool. A new subcommand needs nothing here.
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

# Every subcommand in the order of the help; those that have a section in the template are in the synopsis alone.
file(READ ${IN} template)
ask(data --completion-data)
string(REGEX MATCHALL "command\\|[a-z]+" commands "${data}")
ask(SETTINGS --settings-man)
set(SYNOPSIS)
set(SUBCOMMANDS)
foreach(entry ${commands})
  string(REPLACE "command|" "" name ${entry})
  ask(text --man ${name})
  escape(text "${text}")
  string(REGEX MATCH "^usage: shearctl ${name}([^\n]*)" usage "${text}")
  string(STRIP "${CMAKE_MATCH_1}" operands)
  string(APPEND SYNOPSIS ".Nm shearctl\n.Cm ${name}\n")
  if(operands)
    string(APPEND SYNOPSIS ".Ar ${operands}\n")
  endif()
  string(FIND "${template}" "\n.Ss ${name}\n" section)
  if(section EQUAL -1)
    string(APPEND SUBCOMMANDS ".Ss ${name}\n.Bd -literal\n${text}\n.Ed\n")
  endif()
endforeach()
string(STRIP "${SYNOPSIS}" SYNOPSIS)
string(STRIP "${SUBCOMMANDS}" SUBCOMMANDS)
configure_file(${IN} ${OUT} @ONLY)
