# SPDX-License-Identifier: GPL-3.0-or-later
# Reference pages of libshear from its headers (target `reference`): HTML and section 3 of the manual, in the package
# libshear-dev. Without Doxygen there are none. A public symbol without documentation fails the build.
find_program(DOXYGEN doxygen)
if(NOT DOXYGEN)
  message(STATUS "No reference pages of libshear: doxygen is not installed (scripts/setup test)")
  return()
endif()
set(reference ${PROJECT_BINARY_DIR}/reference)
configure_file(cmake/Doxyfile.in ${reference}/Doxyfile @ONLY)
file(GLOB headers CONFIGURE_DEPENDS core/include/*.h core/include/shear/*.h)
add_custom_command(OUTPUT ${reference}/made
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${reference}/html ${reference}/man
  COMMAND ${DOXYGEN} ${reference}/Doxyfile
  COMMAND ${CMAKE_COMMAND} -DDIR=${reference} -DGZIP=${GZIP} "-DTITLE=libshear ${PROJECT_VERSION}" "-DDATE=November 22, 2026"
    -P ${PROJECT_SOURCE_DIR}/cmake/reference_pages.cmake
  COMMAND ${CMAKE_COMMAND} -E touch ${reference}/made
  DEPENDS ${headers} ${reference}/Doxyfile cmake/reference_pages.cmake core/include/shear/version.h.in
  COMMENT "Making the reference pages of libshear" VERBATIM)
add_custom_target(reference ALL DEPENDS ${reference}/made)
install(DIRECTORY ${reference}/man3 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT libshear_dev)
install(DIRECTORY ${reference}/html DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libshear-dev COMPONENT libshear_dev)
