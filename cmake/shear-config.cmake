# SPDX-License-Identifier: GPL-3.0-or-later
# find_package(shear): the shared library libshear as target shear::shear.
include("${CMAKE_CURRENT_LIST_DIR}/shear-targets.cmake")
