# SPDX-License-Identifier: GPL-3.0-or-later
# `cpack -G DEB` in a build directory, whatever its prefix, makes a Debian package of all of it for /usr. Programs find their
# parts from where they lie, and the rest is decided when it is installed, so that nothing of the build's prefix is in it.
# Three packages, each a component of the installation: libshear0 (the shared library), libshear-dev (what is needed to build
# on it) and sheard, which is all that names no other component (CMAKE_INSTALL_DEFAULT_COMPONENT_NAME). sheard's programs keep
# a copy of libshear inside (static) and do not depend on libshear0: a library that is upgraded beneath a running service
# would change the bits of results between two jobs of a field, and the reader that it starts would be of another release
# than itself. control files: systemd/deb.
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES docs/accuracy.md docs/choosing.md docs/exposures.md docs/field-files.md docs/glossary.md docs/method.md docs/performance.md docs/protocol.md docs/protocol.schema.json
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs)
install(FILES docs/pictures/stamps.png DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs/pictures)
install(FILES config/sheard.conf DESTINATION ${CMAKE_INSTALL_DOCDIR}/config)

# An address that cannot exist (RFC 2606), until whoever distributes a package gives theirs.
set(SHEAR_CONTACT "The sheard developers <sheard@sheard.invalid>" CACHE STRING "Maintainer of packages made here")

# What is not released yet is later than the last release, and earlier than the next one, for apt and dpkg.
set(SHEAR_PACKAGE_VERSION ${PROJECT_VERSION})
file(STRINGS CHANGELOG.md headings REGEX "^## \\[")
list(GET headings 0 newest)
if(newest MATCHES "Unreleased")
  string(APPEND SHEAR_PACKAGE_VERSION "+unreleased")
endif()
# The first version of three packages; the one package before it had the library's files.
set(first_split 0.1.0+unreleased)

# What only a Debian package has: no other installation takes it.
set(debian ${CMAKE_CURRENT_BINARY_DIR}/debian)
configure_file(systemd/deb/changelog.in ${debian}/changelog @ONLY)
add_custom_command(OUTPUT ${debian}/changelog.gz
  COMMAND ${GZIP} -9 -n -k -f ${debian}/changelog DEPENDS ${debian}/changelog VERBATIM)
add_custom_target(debian_changelog ALL DEPENDS ${debian}/changelog.gz)
function(debian_files component package)
  install(FILES ${debian}/changelog.gz systemd/deb/copyright DESTINATION share/doc/${package} COMPONENT ${component} EXCLUDE_FROM_ALL)
  if(ARGN)
    install(FILES ${ARGN} DESTINATION share/lintian/overrides RENAME ${package} COMPONENT ${component} EXCLUDE_FROM_ALL)
  endif()
endfunction()
debian_files(libshear libshear0 systemd/deb/libshear0/overrides)
debian_files(libshear_dev libshear-dev systemd/deb/libshear-dev/overrides)
debian_files(sheard sheard systemd/deb/overrides)

set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sheard)
set(CPACK_PACKAGE_VERSION ${SHEAR_PACKAGE_VERSION})
set(CPACK_PACKAGE_CONTACT "${SHEAR_CONTACT}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # the first line of each description below
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};sheard;ALL;/")
# Installed as if to /usr itself, beneath DESTDIR: the installation's own decisions (config/install.cmake.in) see the true prefix.
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL libshear libshear_dev sheard)
set(CPACK_COMPONENTS_GROUPING IGNORE) # a package for each
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(about "measures the mean gravitational shear of fields of galaxy images by
the method of Zhang (2010): moments of noise-corrected power spectra, without
any model of a galaxy and without calibration.
.")

set(CPACK_DEBIAN_LIBSHEAR_PACKAGE_NAME libshear0)
set(CPACK_DEBIAN_LIBSHEAR_PACKAGE_SOURCE sheard)
set(CPACK_DEBIAN_LIBSHEAR_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBSHEAR_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_LIBSHEAR_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/systemd/deb/libshear0/triggers)
set(CPACK_DEBIAN_LIBSHEAR_DESCRIPTION "weak-lensing shear from galaxy stamps (shared library)
libshear ${about}
This is the library for programs of others. shearctl and sheard have a copy of
their own and do not need it.")

set(CPACK_DEBIAN_LIBSHEAR_DEV_PACKAGE_NAME libshear-dev)
set(CPACK_DEBIAN_LIBSHEAR_DEV_PACKAGE_SOURCE sheard)
set(CPACK_DEBIAN_LIBSHEAR_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBSHEAR_DEV_PACKAGE_DEPENDS "libshear0 (= ${SHEAR_PACKAGE_VERSION})")
set(CPACK_DEBIAN_LIBSHEAR_DEV_PACKAGE_SUGGESTS "pkg-config, cmake")
set(CPACK_DEBIAN_LIBSHEAR_DEV_DESCRIPTION "weak-lensing shear from galaxy stamps (development files)
libshear ${about}
These are its headers, how pkg-config and CMake find it, examples, and
reference pages (HTML, and section 3 of the manual).")

set(CPACK_DEBIAN_SHEARD_PACKAGE_NAME sheard)
set(CPACK_DEBIAN_SHEARD_PACKAGE_SECTION science)
set(CPACK_DEBIAN_SHEARD_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_SHEARD_PACKAGE_DEPENDS "systemd, fonts-dejavu-core")
set(CPACK_DEBIAN_SHEARD_PACKAGE_SUGGESTS "libshear-dev")
set(CPACK_DEBIAN_SHEARD_DESCRIPTION "weak-lensing shear from galaxy stamps
sheard ${about}
It is a tool (shearctl) and a service (sheard) with a watch folder and a Unix
socket, which keeps jobs and sums in a database and reads files in sandboxed
processes. The service is not enabled by itself: \"systemctl enable --now
sheard.service\"; see sheard(8).")
foreach(name conffiles preinst postinst postrm prerm)
  list(APPEND CPACK_DEBIAN_SHEARD_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/systemd/deb/${name})
endforeach()

foreach(component LIBSHEAR LIBSHEAR_DEV)
  set(CPACK_DEBIAN_${component}_PACKAGE_BREAKS "sheard (<< ${first_split})")
  set(CPACK_DEBIAN_${component}_PACKAGE_REPLACES "sheard (<< ${first_split})")
endforeach()
include(CPack)
