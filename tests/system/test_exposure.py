# SPDX-License-Identifier: GPL-3.0-or-later
"""From a mock exposure to a shear: examples/survey/run, with the real source-extractor and psfex."""
import cmath
import math
import os
import re
import shutil
import struct
import subprocess
import tempfile
import unittest

from fitsfile import hdus
from tool import SHEARCTL, PATIENCE

RUN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples", "survey", "run")
TOOLS = (shutil.which("source-extractor") or shutil.which("sex")) and shutil.which("psfex")
CHIPS, SIDE, SCALE = 2, 1024, 0.263
G1, G2 = 0.04, -0.03
SIZES = {"B": 1, "I": 2, "J": 4, "E": 4, "D": 8, "L": 1, "A": 1}


def keywords(hdu):
    """The keywords of one HDU, and where its data begin."""
    found, at = {}, 0
    while not hdu[at:at + 80].startswith(b"END     "):
        text = hdu[at:at + 80].decode("ascii")
        if text[8:10] == "= ":
            found[text[:8].strip()] = text[10:].split(" /")[0].strip().strip("'").strip()
        at += 80
    return found, at + 80 + -(at + 80) % 2880


def rows(hdu, names):
    """The rows of a table: tuples of the columns `names`; a vector is a tuple."""
    keys, begin = keywords(hdu)
    fields, offset = {}, 0
    for i in range(1, int(keys["TFIELDS"]) + 1):
        count, kind = re.match(r"(\d*)(\w)", keys[f"TFORM{i}"]).groups()
        count = int(count or 1)
        fields[keys[f"TTYPE{i}"]] = (offset, f">{count}{kind.translate(str.maketrans('IJED', 'hifd'))}", count)
        offset += count * SIZES[kind]
    width = int(keys["NAXIS1"])
    for row in range(int(keys["NAXIS2"])):
        values = []
        for name in names:
            place, form, count = fields[name]
            value = struct.unpack_from(form, hdu, begin + row * width + place)
            values.append(value[0] if count == 1 else value)
        yield tuple(values)


def median(values):
    return sorted(values)[len(values) // 2]


@unittest.skipUnless(TOOLS, "needs source-extractor and psfex")
class Survey(unittest.TestCase):
    """One run of the example; each test looks at another of its products."""

    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        cls.directory = directory.name
        options = ["--chips", f"{CHIPS}x1", "--chip-size", SIDE, "--galaxies", 15, "--stars", 5, "--fours",
                   "--shear", f"{G1},{G2}", "--distortion", 0.04, "--rotation", 30, "--mirrored", "--seed", 5]
        cls.run_ = subprocess.run([RUN, cls.directory, *map(str, options)], env={**os.environ, "SHEARCTL": SHEARCTL},
                                  capture_output=True, text=True, timeout=100 * PATIENCE, check=False)
        if cls.run_.returncode != 0:
            raise AssertionError(cls.run_.stdout + cls.run_.stderr)

    def hdus(self, name):
        with open(os.path.join(self.directory, name), "rb") as file:
            return [content for _, content in hdus(file.read())]

    def truth(self, *names):
        return list(rows(self.hdus("exp.truth.fits")[1], names))

    def test_source_extractor_finds_the_objects_where_they_are(self):
        catalog = self.hdus("exp.cat")
        mask = self.hdus("exp.mask.fits")
        truth = self.truth("CHIP", "X", "Y", "RA", "DEC", "FLUX")
        found, missed, east, north = 0, 0, [], []
        for chip in range(1, CHIPS + 1):
            names = ("X_IMAGE", "Y_IMAGE", "ALPHA_J2000", "DELTA_J2000", "FLAGS", "IMAFLAGS_ISO")
            objects = list(rows(catalog[2 * chip], names))
            _, begin = keywords(mask[chip])
            for _, x, y, ra, dec, flux in (row for row in truth if row[0] == chip):
                pixel = (min(SIDE, max(1, round(y))) - 1) * SIDE + min(SIDE, max(1, round(x))) - 1
                if flux < 5000 or mask[chip][begin + 2 * pixel + 1] or not (10 < x < SIDE - 10 and 10 < y < SIDE - 10):
                    continue
                nearest = min(objects, key=lambda o, x=x, y=y: (o[0] - x) ** 2 + (o[1] - y) ** 2)
                if math.hypot(nearest[0] - x, nearest[1] - y) > 1.5:
                    missed += 1
                elif nearest[4] == 0 and nearest[5] == 0:
                    found += 1
                    east.append((nearest[2] - ra) * math.cos(math.radians(dec)) * 3600 / SCALE)
                    north.append((nearest[3] - dec) * 3600 / SCALE)
        self.assertGreater(found, 100)
        self.assertLess(missed, 0.15 * found)  # behind brighter ones
        for offsets in (east, north):
            self.assertLess(abs(median(offsets)), 0.02)
            self.assertLess(median(list(map(abs, offsets))), 0.1)

    def test_psfex_models_the_psf_that_was_drawn(self):
        models = self.hdus("exp.stars.psf")
        stars = self.truth("CHIP", "X", "Y", "PSF_FWHM", "PSF_E1", "PSF_E2")
        for chip in range(1, CHIPS + 1):
            keys, _ = keywords(models[chip])
            (planes,) = next(rows(models[chip], ["PSF_MASK"]))
            side, step = int(keys["PSFAXIS1"]), float(keys["PSF_SAMP"])
            middle = min((row for row in stars if row[0] == chip),
                         key=lambda row: math.hypot(row[1] - SIDE / 2, row[2] - SIDE / 2))
            x, y = ((middle[i] - float(keys[f"POLZERO{i}"])) / float(keys[f"POLSCAL{i}"]) for i in (1, 2))
            terms = (1.0, x, x * x, y, x * y, y * y)
            psf = [sum(t * planes[k * side * side + i] for k, t in enumerate(terms)) for i in range(side * side)]
            for kx, ky in ((0.3, 0.0), (0.0, 0.3), (0.4, 0.4), (0.4, -0.4)):
                w = sum(value * cmath.exp(-1j * step * (kx * (i % side) + ky * (i // side)))
                        for i, value in enumerate(psf))
                self.assertAlmostEqual(abs(w) / sum(psf) / self.drawn(kx, ky, *middle[3:]), 1.0, delta=0.02)

    @staticmethod
    def drawn(kx, ky, fwhm, e1, e2):
        """The transform of the Moffat profile of exponent 3.5 in a square pixel."""
        alpha = 0.5 * fwhm / math.sqrt(2 ** (1 / 3.5) - 1) / math.sqrt(1 - e1 * e1 - e2 * e2)
        k = alpha * math.hypot((1 + e1) * kx + e2 * ky, e2 * kx + (1 - e1) * ky)
        pixel = math.prod(math.sin(q / 2) / (q / 2) if q else 1.0 for q in (kx, ky))
        return (1 + k + k * k / 3) * math.exp(-k) * pixel

    def test_the_shear_is_the_true_one(self):
        found = re.search(r"pdf-sym +g1 (\S+) \+- (\S+), g2 (\S+) \+- (\S+)", self.run_.stdout)
        self.assertIsNotNone(found, self.run_.stdout)
        g1, error1, g2, error2 = map(float, found.groups())
        self.assertLess(max(error1, error2), 0.03)
        self.assertLess(abs(g1 - G1), 4 * error1)
        self.assertLess(abs(g2 - G2), 4 * error2)

    def test_a_picture_is_left(self):
        with open(os.path.join(self.directory, "exp.png"), "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")


if __name__ == "__main__":
    unittest.main()
