# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad input: a clear error for each, at once and in little memory, from measure and validate alike."""
import gzip
import math
import os
import re
import socket
import unittest

import fitsfile
from fitsfile import Field
from tool import DONE, INPUT, PATIENCE, ToolTest, shearctl


class BadInput(ToolTest):
    def refused(self, path, *words, args=(), cwd=None):
        """measure and validate refuse the file and say why, with all the words."""
        answer = shearctl("measure", path, *args, cwd=cwd)
        self.assertFails(answer, INPUT, *words)
        self.assertEqual(answer.out, "")
        self.assertIn(os.path.basename(path), answer.err)
        self.assertLess(answer.seconds, PATIENCE)
        verdict = shearctl("validate", path, *args, cwd=cwd)
        self.assertCode(verdict, INPUT)
        self.assertRegex(verdict.out, r"(?m)^  bad ")
        for word in words:
            self.assertIn(word, verdict.out)
        self.assertLess(verdict.seconds, PATIENCE)
        (object_,) = shearctl("validate", "--json", path, *args, cwd=cwd).json()
        self.assertIs(object_["good"], False)
        return answer

    def write(self, name, data):
        with open(self.path(name), "wb") as f:
            f.write(data)
        return self.path(name)


class NotAFieldFile(BadInput):
    def test_missing_file(self):
        self.refused(self.path("none.fits"), "No such file")

    def test_directory(self):
        os.mkdir(self.path("d.fits"))
        self.refused(self.path("d.fits"), "directory")

    def test_fifo_does_not_hang(self):
        os.mkfifo(self.path("pipe.fits"))
        self.refused(self.path("pipe.fits"), "regular file")

    def test_devices_and_sockets(self):
        if os.path.exists("/dev/zero"):
            self.refused("/dev/zero", "regular file")
        with socket.socket(socket.AF_UNIX) as s:
            s.bind(self.path("sock"))
            self.refused(self.path("sock"))

    def test_empty_and_not_fits(self):
        self.refused(self.write("empty.fits", b""))
        self.refused(self.write("text.fits", b"These are not the stamps you are looking for.\n"),
                     "FITS")
        self.refused(self.write("noise.fits", bytes(range(256)) * 100), "FITS")
        self.refused(self.write("fake.fits.gz", b"not gzip"))

    def test_only_a_primary_header(self):
        self.refused(self.write("bare.fits", fitsfile.primary(FIELD="x")), "GALAXY")

    def test_missing_hdus(self):
        for name in ("GALAXY", "NOISE", "PSF"):
            with self.subTest(name=name):
                field = Field(n=4)
                field.skip = (name,)
                self.refused(field.write(self.path("a.fits")), name)

    def test_truncated(self):
        whole = Field(n=8).content()
        for part in (0.02, 0.3, 0.6, 0.9):
            with self.subTest(part=part):
                self.refused(self.write("cut.fits", whole[:int(part * len(whole))]))
        self.refused(self.write("cut.fits", whole[:-fitsfile.BLOCK]))
        self.refused(self.write("cut.fits.gz", gzip.compress(whole)[:-5000]))
        self.assertCode(shearctl("measure", self.write("whole.fits.gz", gzip.compress(whole))),
                        DONE)


class Shapes(BadInput):
    def test_noise_of_another_shape_or_number(self):
        for axes in ((48, 48, 5), (48, 24, 12), (24, 48, 12), (48, 48, 7)):
            with self.subTest(axes=axes):
                field = Field(n=6)
                field.noise_axes = axes
                self.refused(field.write(self.path("a.fits")), "NOISE", "GALAXY")

    def huge(self, name, axes, bitpix=-32):
        """An extension that claims the axes and has one block of data."""
        return fitsfile.image(name, axes, [], bitpix) + b"\0" * fitsfile.BLOCK

    def test_dimensions_beyond_the_file(self):
        psf = fitsfile.image("PSF", (16, 16), fitsfile.gaussian(16, 16, 1.0, (2.0, 2.0, 0.0)))
        for axes in ((10 ** 8, 10 ** 8), (10 ** 8, 10 ** 8, 1), (64, 64, 10 ** 12),
                     (64, 64, 10 ** 15), (2 ** 31, 2 ** 31, 4),
                     (2 ** 62, 4, 1), (1024, 1024, 1000)):
            for bitpix in (8, -64):
                with self.subTest(axes=axes, bitpix=bitpix):
                    data = b"".join(self.huge(name, axes, bitpix) for name in ("GALAXY", "NOISE"))
                    self.refused(self.write("huge.fits", fitsfile.primary() + data + psf), "GALAXY")

    def test_negative_zero_and_odd_axes(self):
        psf = fitsfile.image("PSF", (16, 16), fitsfile.gaussian(16, 16, 1.0, (2.0, 2.0, 0.0)))
        for axes in ((-8, -8, 4), (0, 8, 4), (8, 8, 0), (8,), (7, 7, 3), (1025, 8, 1),
                     (8, 8, 1, 4)):
            with self.subTest(axes=axes):
                data = b"".join(self.huge(name, axes) for name in ("GALAXY", "NOISE"))
                self.refused(self.write("odd.fits", fitsfile.primary() + data + psf))

    def test_huge_psf(self):
        field = Field(n=4)
        field.skip = ("PSF",)
        self.refused(self.write("a.fits", field.content() + self.huge("PSF", (10 ** 8, 10 ** 8))),
                     "PSF")

    def test_catalog_of_another_length(self):
        field = Field(n=4)
        field.columns = [("ID", "K", [1, 2, 3])]
        self.refused(field.write(self.path("a.fits")), "CATALOG")


class Psf(BadInput):
    def test_unusable(self):
        good = Field(n=4)
        cases = {"nan": [math.nan if i == 700 else p for i, p in enumerate(good.psf)],
                 "inf": [math.inf if i == 700 else p for i, p in enumerate(good.psf)],
                 "zero": [0.0] * len(good.psf),
                 "negative": [-p for p in good.psf]}
        for name, psf in cases.items():
            with self.subTest(name=name):
                field = Field(n=4)
                field.psf = psf
                self.refused(field.write(self.path(f"{name}.fits")), "PSF")

    def test_beta_too_small_names_one_that_works(self):
        fine = Field(n=4, r_psf=0.7, size=1.5, psf_oversample=4)
        for field, args in ((Field(n=4), ()), (fine, ("--interp", "spline"))):
            with self.subTest(args=args):
                path = field.write(self.path("a.fits"))
                answer = self.refused(path, "smallest", args=("--beta", 0.2, *args))
                beta = float(re.search(r"smallest.*?(\d+\.\d+)", answer.err).group(1))
                self.assertGreater(beta, 0.2)
                self.assertCode(shearctl("measure", path, "--beta", beta, *args), DONE)
                # and it is the smallest, not just any
                self.assertCode(shearctl("measure", path, "--beta", 0.99 * beta, *args), INPUT)


class Logarithm(BadInput):
    def test_negative_pixels(self):
        field = Field(n=6, sigma=0.5)
        path = field.write(self.path("a.fits"))
        args = ("--interpolation", "log-bicubic", "--oversample", 4)
        answer = shearctl("measure", path, *args)
        self.assertFails(answer, INPUT, "negative", "pedestal", "a.fits")
        verdict = shearctl("validate", path, *args)
        self.assertCode(verdict, INPUT)
        self.assertIn("6 of 6 stamps", verdict.out)
        pedestal = re.search(r"--pedestal (\S+)", verdict.out).group(1)
        lowest = min(map(min, field.galaxy + field.noise))
        self.assertGreater(float(pedestal), -lowest)
        self.assertLess(float(pedestal), -1.2 * lowest)
        for command in ("measure", "validate"):
            self.assertCode(shearctl(command, path, *args, "--pedestal", pedestal), DONE)
            self.assertCode(shearctl(command, path, *args, "--pedestal", -0.9 * lowest), INPUT)


class ExtendedSyntax(BadInput):
    def test_names_with_file_name_syntax_are_plain_names(self):
        Field(n=3).write(self.path("a.fits"))
        for name in ("a.fits(copy.fits)", "a.fits[1]", "a.fits[GALAXY]", "a.fits+1", "!a.fits",
                     "file://a.fits",
                     "mem://", "-", "a.fits[1][col X=1]", "shmem://h1", "http://localhost/a.fits"):
            with self.subTest(name=name):
                answer = shearctl("measure", "--", name, cwd=self.directory)
                self.assertFails(answer, INPUT, name)
                self.assertLess(answer.seconds, PATIENCE)
                self.assertEqual(os.listdir(self.directory), ["a.fits"])


if __name__ == "__main__":
    unittest.main()
