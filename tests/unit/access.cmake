# SPDX-License-Identifier: GPL-3.0-or-later
# Who may read what. The tests see the private headers of the room, too.
shear_add_test(beneath SOURCES test_beneath.c LIBRARIES sheard_access LABELS access)
foreach(name access access_roots access_peers)
  shear_add_test(${name} SOURCES test_${name}.c access_fixture.c LIBRARIES sheard_access LABELS access)
endforeach()
