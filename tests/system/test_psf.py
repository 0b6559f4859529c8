# SPDX-License-Identifier: GPL-3.0-or-later
"""Images that are no PSFs, or doubtful ones: the messages of measure and validate, and no message about good ones."""
import random
import unittest

from fitsfile import Field, gaussian
from tool import DONE, INPUT, ToolTest, shearctl


def rolled(psf, n):
    """As numpy.fft.ifftshift leaves it."""
    return [psf[(y + n // 2) % n * n + (x + n // 2) % n] for y in range(n) for x in range(n)]


class Psf(ToolTest):
    def field(self, change=None, **keys):
        field = Field(n=4, **keys)
        if change:
            field.psf = change(field.psf)
        return field.write(self.path("psf.fits"))

    def warnings(self, path, *args):
        """Of measure and validate: they must agree."""
        (verdict,) = shearctl("validate", "--json", path, *args).json()
        answer = shearctl("measure", "--json", path, *args)
        self.assertCode(answer, DONE)
        (result,) = answer.json()
        self.assertEqual(verdict["warnings"], result["warnings"])
        for words in result["warnings"]:
            self.assertIn(words, answer.err)
        return result["warnings"], verdict

    def assertWarned(self, path, flaw, *words):
        warnings, verdict = self.warnings(path)
        self.assertEqual(verdict["psf"]["flaws"],
                         {name: int(name == flaw) for name in verdict["psf"]["flaws"]})
        self.assertEqual(len(warnings), 1)
        for word in words:
            self.assertIn(word, warnings[0])
        self.assertIs(verdict["good"], True)
        self.assertIn("warning    " + warnings[0], shearctl("validate", path).out)

    def test_good_is_silent(self):
        for oversample in (1, 3):
            warnings, verdict = self.warnings(self.field(psf_oversample=oversample))
            self.assertEqual(warnings, [])
            self.assertEqual((verdict["psf"]["looked_at"], verdict["psf"]["unusable"]), (1, 0))
            self.assertAlmostEqual(verdict["psf"]["sampling"], 1.5 * oversample, 2)

    def test_corner_ordered_is_refused(self):
        path = self.field(lambda psf: rolled(psf, 48))
        words = "the PSF lies round the image's corners: its peak is at sample"
        answer = shearctl("measure", path)
        self.assertFails(answer, INPUT, words, "numpy.fft.fftshift(psf)")
        answer = shearctl("validate", path)
        self.assertCode(answer, INPUT)
        self.assertIn(words, answer.out)
        self.assertIn("advice     put its centre into the middle: numpy.fft.fftshift(psf)",
                      answer.out)

    def test_border(self):
        path = self.field(lambda psf: [p + 0.01 * max(psf) for p in psf])
        self.assertWarned(path, "pedestal", "border is at 0.99 % of its peak", "subtract")

    def test_cut(self):
        def moffat(_):
            return [(1 + ((i % 11 - 5) ** 2 + (i // 11 - 5) ** 2) / 12.0) ** -3.0
                    for i in range(121)]
        field = Field(n=4)
        field.psf_nx = field.psf_ny = 11
        field.psf = moffat(None)
        self.assertWarned(field.write(self.path("psf.fits")), "cut", "wings are cut off",
                          "larger image of the PSF")

    def test_noisy(self):
        rng = random.Random(3)
        sigma = 1e-2 / (4 * 3.14 * 1.5 ** 2) ** 0.5  # of a star of S/N 100
        path = self.field(lambda psf: [p + rng.gauss(0, sigma) for p in psf])
        self.assertWarned(path, "noisy", "the PSF is noisy", "more stars")

    def test_undersampled(self):
        field = Field(n=4, size=3.0, r_psf=0.56, truth=False)
        field.psf = gaussian(48, 48, 1.0, (0.56 ** 2, 0.56 ** 2, 0.0), 0.5, 0.5)
        path = field.write(self.path("psf.fits"))
        (verdict,) = shearctl("validate", "--json", path, "--beta", "1.3",
                              "--interpolation", "none").json()
        self.assertEqual(verdict["psf"]["flaws"]["undersampled"], 1)
        self.assertIn("OVERSAMP", verdict["warnings"][0])

    def test_one_flat_among_many(self):
        field = Field(n=64, nx=32, ny=32)
        field.psf_cube = [field.psf] * 64
        field.psf_cube[7] = [1.0] * len(field.psf)
        path = field.write(self.path("psf.fits"))
        warnings, verdict = self.warnings(path)
        self.assertEqual(verdict["flags"]["psf_unusable"], {"count": 1, "first": [7]})
        self.assertEqual((verdict["psf"]["looked_at"], verdict["psf"]["unusable"]), (64, 1))
        self.assertEqual(len(warnings), 1)
        self.assertIn("1 of 64 PSFs examined are unusable", warnings[0])
        result = self.measure_one(path)
        self.assertEqual(result["flags"]["psf_unusable"], 1)
        for name, expected in zip(("g1", "g2"), field.expected()):
            self.assertAlmostEqual(result[name], expected, 4)

    def test_some_doubtful_among_many(self):
        field = Field(n=12, nx=32, ny=32)
        field.psf_cube = [field.psf] * 12
        for i in (2, 3, 5):
            field.psf_cube[i] = [p + 0.02 * max(field.psf) for p in field.psf]
        warnings, verdict = self.warnings(field.write(self.path("psf.fits")))
        self.assertEqual(verdict["psf"]["flaws"]["pedestal"], 3)
        self.assertEqual(len(warnings), 1)
        self.assertIn("3 of 12 PSFs examined (the worst): the PSF's border is at 2 %", warnings[0])

    def test_a_later_file(self):
        paths = [Field(n=4 + i, name="one").write(self.path(f"{i}.fits")) for i in range(3)]
        self.assertEqual(self.measure_one(*paths)["warnings"], [])
        field = Field(n=9, name="one")
        field.psf = [p + 0.02 * max(field.psf) for p in field.psf]
        paths.append(field.write(self.path("bad.fits")))
        (answer,) = shearctl("measure", "--json", *paths).json()
        (words,) = answer["warnings"]
        self.assertIn("1 of 3 files after the first have doubtful PSFs: " + paths[-1], words)
        self.assertIn("border is at 2 %", words)

    def test_all_corner_ordered(self):
        field = Field(n=4)
        field.psf_cube = [rolled(field.psf, 48)] * 4
        self.assertFails(shearctl("measure", field.write(self.path("psf.fits"))), INPUT,
                         "none of 4 PSFs is usable: the PSF lies round the image's corners",
                         "fftshift")


if __name__ == "__main__":
    unittest.main()
