#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rooms, as the includes show them: nobody includes upwards, or a private header of somebody else; an outside library is
seen by its room only; every source has its licence."""
import re
import unittest

import house
import rooms

TREE = house.Tree()
PLAN = rooms.House()
INCLUDES = rooms.Includes(TREE, PLAN)


def upward(includes, plan):
    """(file, header) that a file may not include, as its room is not above the header's."""
    return sorted((path, header) for path, headers in includes.quoted.items() for _, header in headers
                  if header and not plan.may_use(path, header))


def strangers(includes, plan):
    """(file, header) of outside libraries that the file's room may not see."""
    found = []
    for path, headers in includes.angled.items():
        for header in headers:
            for library, places in plan.outside.items():
                known = header == library or header.startswith(library + "/")
                if known and not any(path.startswith(place + "/") for place in places):
                    found.append((path, header))
    return found


def unknown(includes, plan):
    """(file, name) of quoted includes that are no file of the tree, nor made by the build."""
    return [(path, name) for path, headers in includes.quoted.items() for name, header in headers
            if header is None and name not in plan.made]


def otherwise_written(includes):
    """(file, name) of includes within a component that are not written as from its root: "fits/io/file.h" in core/."""
    return [(path, name) for path, headers in includes.quoted.items() for name, header in headers
            if header and not rooms.is_public(header) and rooms.component_of(header) == rooms.component_of(path)
            and header != f"{rooms.component_of(path)}/{name}"]


def told(pairs):
    return [(path, 0, f"includes {name}") for path, name in pairs]


class Rooms(house.Case):
    def test_there_are_sources(self):
        self.assertGreater(len(TREE.sources()), 300)
        self.nothing([(path, 0, "in no room of rooms.txt") for path in TREE.sources() if PLAN.room_of(path) is None],
                     "floors")

    def test_nobody_includes_upwards(self):
        self.nothing(told(upward(INCLUDES, PLAN)), "upward", "upward")

    def test_private_headers(self):
        self.nothing(told(rooms.private_uses(INCLUDES)), "private", "private")

    def test_includes_are_files(self):
        self.nothing(told(unknown(INCLUDES, PLAN)), "unknown")

    def test_includes_are_written_from_the_root(self):
        self.nothing(told(otherwise_written(INCLUDES)), "written")

    def test_outside_libraries(self):
        self.nothing(told(strangers(INCLUDES, PLAN)), "outside")

    def test_dependencies_name_the_same_rooms(self):
        headers = {"FFTW": "fftw3.h", "CFITSIO": "fitsio.h", "XXHASH": "xxhash.h", "ZLIB": "zlib.h", "GMP": "gmp.h",
                   "GSL": "gsl", "CAIRO": "cairo.h", "JANSSON": "jansson.h", "SECCOMP": "seccomp.h", "UV": "uv.h",
                   "SQLITE": "sqlite3.h", "WCSLIB": "wcslib", "RANDOM123_INCLUDE_DIR": "Random123"}
        told = {name: rooms for name, rooms in re.findall(r"^(?:pkg_check_modules|find_path)\((\w+) .*\)\s+# (.*)$",
                                                          TREE.read("cmake/Dependencies.cmake"), re.M)}
        self.assertEqual(sorted(told), sorted(headers))
        for name, rooms_told in told.items():
            self.assertEqual(set(rooms_told.split(", ")) - {"tests"}, set(PLAN.outside[headers[name]]) - {"bench"}, name)

    def test_licence(self):
        self.nothing([(path, 1, "no licence") for path in TREE.sources()
                      if "SPDX-License-Identifier: GPL-3.0-or-later" not in TREE.read(path)[:200]], "licence")


if __name__ == "__main__":
    unittest.main()
