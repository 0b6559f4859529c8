# SPDX-License-Identifier: GPL-3.0-or-later
# `cpack -G DEB` in a build directory, whatever its prefix, makes a Debian package of all of it for /usr. Programs find their
# parts from where they lie, and the rest is decided when it is installed, so that nothing of the build's prefix is in it.
# One package, with libshear: the programs have their own copy of it inside (static), so that the shared one is only for
# those who build on it, and a package of its own for it would serve nobody. control files: systemd/deb.
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES docs/accuracy.md docs/choosing.md docs/field-files.md docs/glossary.md docs/method.md docs/performance.md docs/protocol.md docs/protocol.schema.json
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs)
install(FILES docs/pictures/stamps.png DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs/pictures)
install(FILES config/sheard.conf DESTINATION ${CMAKE_INSTALL_DOCDIR}/config)

# An address that cannot exist (RFC 2606), until whoever distributes a package gives theirs.
set(SHEAR_CONTACT "The sheard developers <sheard@sheard.invalid>" CACHE STRING "Maintainer of packages made here")

# What is not released yet is later than the last release, and earlier than the next one, for apt and dpkg.
set(SHEAR_PACKAGE_VERSION ${PROJECT_VERSION})
file(STRINGS CHANGELOG.md released REGEX "^## \\[${PROJECT_VERSION}\\]")
if(NOT released)
  string(APPEND SHEAR_PACKAGE_VERSION "+unreleased")
endif()

# What only a Debian package has: component "debian", which no other installation takes.
set(debian ${CMAKE_CURRENT_BINARY_DIR}/debian)
configure_file(systemd/deb/changelog.in ${debian}/changelog @ONLY)
add_custom_command(OUTPUT ${debian}/changelog.gz
  COMMAND ${GZIP} -9 -n -k -f ${debian}/changelog DEPENDS ${debian}/changelog VERBATIM)
add_custom_target(debian_changelog ALL DEPENDS ${debian}/changelog.gz)
set(only_debian COMPONENT debian EXCLUDE_FROM_ALL)
install(FILES ${debian}/changelog.gz systemd/deb/copyright DESTINATION share/doc/sheard ${only_debian})
install(FILES systemd/deb/overrides DESTINATION share/lintian/overrides RENAME sheard ${only_debian})

set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sheard)
set(CPACK_PACKAGE_VERSION ${SHEAR_PACKAGE_VERSION})
set(CPACK_PACKAGE_CONTACT "${SHEAR_CONTACT}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "weak-lensing shear from galaxy stamps")
set(CPACK_PACKAGE_DESCRIPTION "sheard measures the average gravitational shear of fields of galaxy images by
the method of Zhang (2010): moments of noise-corrected power spectra, without
any model of a galaxy and without calibration.
.
It is a tool (shearctl), a library (libshear, with its headers) and a service
(sheard) with a watch folder and a Unix socket, which keeps jobs and sums in a
database and reads files in sandboxed processes. The service is not enabled by
itself: \"systemctl enable --now sheard.service\"; see sheard(8).")
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};sheard;ALL;/" "${PROJECT_BINARY_DIR};sheard;debian;/")
# Installed as if to /usr itself, beneath DESTDIR: the installation's own decisions (config/install.cmake.in) see the true prefix.
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_PACKAGE_DEPENDS "systemd, fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
foreach(name conffiles preinst postinst postrm prerm triggers)
  list(APPEND CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/systemd/deb/${name})
endforeach()
include(CPack)
