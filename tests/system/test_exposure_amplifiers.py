# SPDX-License-Identifier: GPL-3.0-or-later
"""Chips that several amplifiers read out: noise stamps are of the galaxy's own, in every way of saying so."""
import array
import random
import sys
import unittest

from exposures import ExposureTest, columns, images, keywords, read, write_images
from fitsfile import TYPECODES, hdus
from tool import DONE, INPUT, USAGE, shearctl

SIGMA = 12.8  # of the sky that `shearctl expose` draws, ADU
SIDE = 700


def variances(path, name):
    """Of the stamps of a field file's cube."""
    hdu = dict(hdus(read(path)))[name]
    keys, begin = keywords(hdu)
    size, bitpix, n = int(keys["NAXIS1"]) * int(keys["NAXIS2"]), int(keys["BITPIX"]), int(keys["NAXIS3"])
    pixels = array.array(TYPECODES[bitpix])
    pixels.frombytes(hdu[begin:begin + n * size * abs(bitpix) // 8])
    if sys.byteorder == "little":
        pixels.byteswap()
    return [sum(v * v for v in pixels[i * size:(i + 1) * size]) / size for i in range(n)]


class Amplifiers(ExposureTest):
    def setUp(self):
        super().setUp()
        self.draw()

    def roughen(self, is_rough):
        """Add noise to the pixels for which that is true of (x, y), from 0."""
        draw = random.Random(1)
        chips = images(self.path("exp.fits"))
        for chip in chips:
            for i in range(SIDE * SIDE):
                if is_rough(i % SIDE, i // SIDE):
                    chip.pixels[i] += draw.gauss(0.0, 0.6 * SIGMA)
        write_images(self.path("exp.fits"), chips)

    def strangers(self, is_rough, *options):
        """How many noise stamps are not of their galaxy's amplifier, of how many."""
        field = self.path("field.fits")
        self.assertCode(shearctl("extract", *self.options(), *options, "-o", field, "--quiet", "--force"), DONE)
        rows = columns(dict(hdus(read(field)))["CATALOG"])
        used = [(x, y, v) for x, y, v in zip(rows["X"], rows["Y"], variances(field, "NOISE")) if v > 0]
        limit = (1 + 0.5 * 0.6 ** 2) * SIGMA ** 2
        return sum((v > limit) != is_rough(round(x) - 1, round(y) - 1) for x, y, v in used), len(used)

    def test_noise_is_of_the_galaxys(self):
        for grid, is_rough in (("2x1", lambda x, y: x >= SIDE // 2), ("1x2", lambda x, y: y >= SIDE // 2),
                               ("3x2", lambda x, y: (3 * x // SIDE + 2 * y // SIDE) % 2 == 1)):
            with self.subTest(grid):
                self.draw()
                self.roughen(is_rough)
                strangers, n = self.strangers(is_rough, "--amplifiers", grid)
                self.assertEqual(strangers, 0)
                self.assertGreater(n, 60)
                self.assertGreater(self.strangers(is_rough)[0], 4)

    def test_extracted_and_measured(self):
        """The same bits; others than for one amplifier, which is the default."""
        self.roughen(lambda x, y: x >= SIDE // 2)
        result = self.measure(*self.options(amplifiers="2x1"))
        field = self.path("field.fits")
        self.assertCode(shearctl("extract", *self.options(amplifiers="2x1"), "-o", field, "--quiet"), DONE)
        self.assertSameBits(result, self.measure(field, keep="field"))
        one = self.measure(*self.options(), keep="one")
        self.assertNotEqual((one[0]["g1"], one[0]["g2"]), (result[0]["g1"], result[0]["g2"]))
        self.assertSameBits(one, self.measure(*self.options(amplifiers="1x1"), keep="other"))
        self.assertCode(shearctl("validate", *self.options(amplifiers="2x1"), "--quiet"), DONE)

    def test_what_is_refused(self):
        for grid in ("0x1", "1x0", "2", "2x", "x2", "", "2x1x1", "-2x1", "2x-1", "+2x1", " 2x1", "2 x 1", "2X1", "65x1",
                     "999999999x1", "99999999999999999999x1", "1x4294967297"):
            with self.subTest(grid):
                answer = shearctl("measure", *self.options(amplifiers=grid))
                self.assertFails(answer, USAGE, f"--amplifiers is '{grid}'", "COLUMNSxROWS", "1 to 64")
        for grid in ("64x64", "11x1", "1x11"):  # a part must hold 48 + 16 px
            answer = shearctl("measure", *self.options(amplifiers=grid))
            self.assertFails(answer, INPUT, "exp.fits", "CHIP1", grid.replace("x", " x "), "700 x 700", "64 x 64",
                             "--amplifiers")
        self.measure(*self.options(amplifiers="10x1"))
        field = self.path("mock.fits")
        self.assertCode(shearctl("mock", field, "--stamps", 5, "--quiet"), DONE)
        self.assertFails(shearctl("measure", field, "--amplifiers", "2x1"), USAGE, "--amplifiers", "--image")


if __name__ == "__main__":
    unittest.main()
