#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The house rules that a compiler cannot keep: each outside library is seen by its room only, and nothing of one machine
is written into the tree."""
import os
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOMS = {  # header -> the folders that may include it (tests may include anything)
    "fftw3.h": ["core/fft", "bench"],
    "fitsio.h": ["core/fits", "bench"],
    "gmp.h": ["core/exact"],
    "xxhash.h": ["core/fits"],
    "zlib.h": ["core/fits"],
    "cairo.h": ["figures"],
    "jansson.h": ["protocol"],
    "ini.h": ["config"],
    "sqlite3.h": ["daemon/store", "bench"],
    "seccomp.h": ["daemon/reader"],
    "uv.h": ["daemon"],
    "Random123": ["mocks"],
    "gsl": ["mocks", "validation"],
}
SOURCES = [p for folder in ("core", "mocks", "figures", "protocol", "config", "daemon", "client", "validation", "bench")
           for p in (ROOT / folder).rglob("*.[ch]")]


class Rooms(unittest.TestCase):
    def test_there_are_sources(self):
        self.assertGreater(len(SOURCES), 100)

    def test_outside_libraries(self):
        for path in SOURCES:
            where = path.relative_to(ROOT).as_posix()
            for header in re.findall(r"#include\s*<([^>]+)>", path.read_text()):
                for library, rooms in ROOMS.items():
                    if header == library or header.startswith(library + "/"):
                        self.assertTrue(any(where.startswith(room + "/") for room in rooms),
                                        f"{where} includes <{header}>, which belongs to {rooms}")

    def test_core_knows_nothing_above_it(self):
        for path in (ROOT / "core").rglob("*.[ch]"):
            for header in re.findall(r'#include\s*"([^"]+)"', path.read_text()):
                self.assertRegex(header, r"^(shear|base|exact|fft|measure|fits|run)/|^shear\.h$",
                                 f"{path.name} includes \"{header}\"")

    def test_licence(self):
        for path in SOURCES:
            self.assertIn("SPDX-License-Identifier: GPL-3.0-or-later", path.read_text()[:200], str(path))


if __name__ == "__main__":
    os.chdir(ROOT)
    unittest.main()
