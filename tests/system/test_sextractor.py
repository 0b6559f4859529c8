#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The real source-extractor's catalogs of one simulated exposure of two chips: FITS_LDAC, FITS_1.0 and ASCII_HEAD, plain
and gzipped, hold the same sources, at the places where they were drawn. Skipped if source-extractor is not installed."""
import gzip
import math
import os
import random
import shutil
import subprocess
import tempfile
import unittest

from fitsfile import image, primary

SOURCE_DUMP = os.path.abspath(os.environ["SOURCE_DUMP"])
SEXTRACTOR = shutil.which("source-extractor") or shutil.which("sex")
SIDE = 128
PARAMETERS = ("NUMBER EXT_NUMBER X_IMAGE Y_IMAGE FLUX_APER(3) A_IMAGE B_IMAGE THETA_IMAGE KRON_RADIUS FLUX_RADIUS FLAGS "
              "MAG_AUTO VIGNET(5,5)")


def chip(name, seed):
    """An image of 16 sources on a grid, moved at random, one of them saturated; and their places, from 1."""
    rng = random.Random(seed)
    pixels = [rng.gauss(100, 1) for _ in range(SIDE * SIDE)]
    places = []
    for k in range(16):
        x, y = 16 + 32 * (k % 4) + rng.uniform(-3, 3), 16 + 32 * (k // 4) + rng.uniform(-3, 3)
        peak, size = 2000 if k == 5 else rng.uniform(30, 300), rng.uniform(1.2, 2.0)
        places.append((x + 1, y + 1))
        for j in range(int(y) - 12, int(y) + 13):
            for i in range(int(x) - 12, int(x) + 13):
                pixels[j * SIDE + i] += peak * math.exp(-((i - x) ** 2 + ((j - y) / 1.3) ** 2) / 2 / size ** 2)
    return image(name, (SIDE, SIDE), pixels), places


@unittest.skipUnless(SEXTRACTOR, "source-extractor is not installed")
class Catalogs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.directory.cleanup)
        chips = [chip("N15", 1), chip("N16", 2)]
        cls.places = [places for _, places in chips]
        with open(cls.path("chips.fits"), "wb") as f:
            f.write(primary() + b"".join(data for data, _ in chips))
        with open(cls.path("columns"), "w", encoding="ascii") as f:
            f.write(PARAMETERS.replace(" ", "\n") + "\n")
        for kind in ("FITS_LDAC", "FITS_1.0", "ASCII_HEAD", "ASCII"):
            subprocess.run([SEXTRACTOR, "chips.fits", "-c", "/dev/null", "-CATALOG_TYPE", kind, "-CATALOG_NAME", kind,
                            "-PARAMETERS_NAME", "columns", "-FILTER", "N", "-PHOT_APERTURES", "3,5,8",
                            "-SATUR_LEVEL", "1500", "-DETECT_THRESH", "5", "-BACK_TYPE", "MANUAL", "-BACK_VALUE", "100",
                            "-VERBOSE_TYPE", "QUIET"],
                           cwd=cls.directory.name, check=True, timeout=600)

    @classmethod
    def path(cls, name):
        return os.path.join(cls.directory.name, name)

    def dump(self, name, *select):
        """[(chip, cards, [source, ...]), ...]"""
        process = subprocess.run([SOURCE_DUMP, self.path(name), *select], capture_output=True, text=True, timeout=60)
        self.assertEqual(process.returncode, 0, process.stderr)
        tables = []
        for line in process.stdout.splitlines():
            words = line.split(" ")
            if words[0] == "table":
                tables.append((words[2], int(words[3]), []))
            else:
                tables[-1][2].append([None if word == "nan" else float(word) for word in words])
        return tables

    def assertSame(self, first, second, tolerance):
        self.assertEqual(len(first), len(second))
        for one, other in zip(first, second):
            for a, b, t in zip(one, other, (0, *tolerance, 0)):
                self.assertTrue(a == b or abs(a - b) <= t, (one, other))

    def test_pairs_of_chips(self):
        tables = self.dump("FITS_LDAC")
        self.assertEqual([table[0] for table in tables], ["N15", "N16"])
        for (_, cards, sources), places in zip(tables, self.places):
            self.assertGreater(cards, 5)
            self.assertEqual(len(sources), 16)
            self.assertTrue(1 <= sum(s[7] == 0 for s in sources) < 6)  # the saturated one, and those at the edge
            for _, x, y, r_gal, a, b, _, _ in sources:
                self.assertLess(min(math.hypot(x - px, y - py) for px, py in places), 0.2)
                self.assertTrue(2 < r_gal < 7 and a >= b > 3, (r_gal, a, b))

    def test_formats_agree(self):
        ldac, fits = self.dump("FITS_LDAC"), self.dump("FITS_1.0")
        self.assertEqual([table[:2] for table in fits], [("", 0), ("", 0)])
        for one, other in zip(ldac, fits):
            self.assertSame(one[2], other[2], [0] * 6)
        text = self.dump("ASCII_HEAD")
        self.assertEqual(len(text), 2)  # told apart by EXT_NUMBER
        # Digits of the text: 1e-4 px; 2 x 1e-3; (A 1e-3) x (KRON 1e-2 of about 4) for ellipses of up to 4 px.
        for one, other in zip(ldac, text):
            self.assertSame(one[2], other[2], [6e-5, 6e-5, 1.1e-3, 0.05, 0.05, 6e-3])

    def test_select(self):
        select = "MAG_AUTO < -7.5 && (FLAGS & 4) == 0"
        chosen, text = ([s[7] for table in self.dump(kind, select) for s in table[2]]
                        for kind in ("FITS_LDAC", "ASCII_HEAD"))
        self.assertTrue(0 < sum(chosen) < len(chosen))
        self.assertEqual(chosen, text)

    def test_gzipped(self):
        for kind in ("FITS_LDAC", "ASCII_HEAD"):
            with open(self.path(kind), "rb") as plain, gzip.open(self.path(kind + ".gz"), "wb") as packed:
                packed.write(plain.read())
            self.assertEqual(self.dump(kind), self.dump(kind + ".gz"))

    def test_text_without_head(self):
        process = subprocess.run([SOURCE_DUMP, self.path("ASCII")], capture_output=True, text=True, timeout=60)
        self.assertEqual(process.returncode, 1)
        self.assertRegex(process.stderr, "ASCII_HEAD.*CATALOG_TYPE FITS_LDAC")


if __name__ == "__main__":
    unittest.main()
