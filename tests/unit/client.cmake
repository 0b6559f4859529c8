# SPDX-License-Identifier: GPL-3.0-or-later
# Tests of client/.
shear_add_test(client SOURCES test_client.c LIBRARIES shear_client LABELS client)
shear_add_test(client_service SOURCES test_client_service.c LIBRARIES shear_client LABELS client)
