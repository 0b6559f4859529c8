# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DIN=DIRECTORY -DVERSIONS=N -DOUT=FILE.c -P embed.cmake: version_1.sql ... version_N.sql as schema_steps (schema.h),
# one string per statement.
#
# SQLite stores the text of a table, an index or a trigger as it was given, and old and new databases must have the same.
# Comments and line breaks are no part of it, blanks are: a line that begins with a blank or ")" continues the one before.
cmake_minimum_required(VERSION 3.25)
set(code "#include \"store/schema.h\"\n\n#include <stddef.h>\n")
set(names)
foreach(version RANGE 1 ${VERSIONS})
  file(READ ${IN}/version_${version}.sql sql)
  string(REGEX REPLACE " *--[^\n]*" "" sql "${sql}")
  string(REGEX REPLACE "\n([ )])" "\\1" sql "${sql}")
  string(REGEX REPLACE "([^\n]+);\n+" "    \"\\1\",\n" sql "${sql}")
  string(STRIP "${sql}" sql)
  string(APPEND code "\nstatic const char *const version_${version}[] = {\n    ${sql}\n    NULL};\n")
  string(APPEND names "version_${version}, ")
endforeach()
string(APPEND code "\nconst schema_step schema_steps[SCHEMA_VERSION] = {${names}};\n")
file(WRITE ${OUT} "${code}")
