# SPDX-License-Identifier: GPL-3.0-or-later
# shear_install_page(PAGE): compress a manual page that something else makes (PAGE is its path in the build directory), and
# install it. The same bytes for the same page: no name and no time in the archive.
find_program(GZIP gzip REQUIRED)

function(shear_install_page page)
  get_filename_component(name ${page} NAME)
  get_filename_component(section ${page} LAST_EXT)
  string(SUBSTRING ${section} 1 -1 section)
  add_custom_command(OUTPUT ${page}.gz
    COMMAND ${GZIP} -9 -n -k -f ${page}
    DEPENDS ${page} COMMENT "Compressing ${name}" VERBATIM)
  add_custom_target(page_${name} ALL DEPENDS ${page}.gz)
  install(FILES ${page}.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section})
endfunction()
