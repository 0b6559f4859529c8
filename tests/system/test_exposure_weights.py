# SPDX-License-Identifier: GPL-3.0-or-later
"""Weight maps read as another kind than they are: what `shearctl validate` sees of it."""
import random
import unittest

from exposures import ExposureTest, Image, images, write_images
from fitsfile import image
from tool import DONE, shearctl

KINDS = {"weight": -2.0, "variance": 2.0, "rms": 1.0}  # powers of the standard deviation


class Kinds(ExposureTest):
    def setUp(self):
        super().setUp()
        self.draw("--chips", "1x1", "--galaxies", 40)
        (self.sky,) = images(self.path("exp.fits"))
        self.base = images(self.path("exp.weight.fits"))[0].pixels[0] ** -0.5

    def layer(self, values, bitpix=-32):
        write_images(self.path("map.fits"), [Image(image("MAP", (self.sky.nx, self.sky.ny), values, bitpix))])
        return self.path("map.fits")

    def warnings(self, path, kind):
        answer = shearctl("validate", "--json", "--quiet", *self.options(weight=path, **{"weight-kind": kind}))
        self.assertCode(answer, DONE)
        return "\n".join(answer.json()[0]["warnings"])

    def test_noise_that_varies(self):
        """Each kind is recognized when it is read as each other."""
        rng, n = random.Random(1), self.sky.nx
        sigma = [self.base * (1 + 2 * x / n) for x in range(n)]
        self.sky.pixels[:] = type(self.sky.pixels)("f", (
            p + (sigma[i % n] ** 2 - self.base ** 2) ** 0.5 * rng.gauss(0, 1) for i, p in enumerate(self.sky.pixels)))
        write_images(self.path("exp.fits"), [self.sky])
        for held, power in KINDS.items():
            path = self.layer([sigma[i % n] ** power for i in range(n * self.sky.ny)])
            for read in KINDS:
                told = self.warnings(path, read)
                if read == held:
                    self.assertNotIn("weight", told)
                else:
                    self.assertIn(f"as a map of kind '{held}' does, but it is read as '{read}': give --weight-kind "
                                  f"{held}", told)

    def test_even_noise(self):
        """Nothing can be said of a flat map, but that its bad pixels have great weights."""
        flat = [self.base ** 2] * (self.sky.nx * self.sky.ny)
        for read in KINDS:
            self.assertNotIn("weight", self.warnings(self.layer(flat), read))
        flat[5000:5007] = [1e30] * 7
        path = self.layer(flat)
        self.assertIn("7 of its pixels have 10^10 times the weight of most", self.warnings(path, "weight"))
        self.assertNotIn("weight", self.warnings(path, "variance"))


if __name__ == "__main__":
    unittest.main()
