# SPDX-License-Identifier: GPL-3.0-or-later
# Parts of daemon/service that stand alone.
shear_add_test(owner SOURCES test_owner.c LIBRARIES sheard_service LABELS service)
shear_add_test(processors SOURCES test_processors.c LIBRARIES sheard_service LABELS service)
