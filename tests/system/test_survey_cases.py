#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings of shearctl, with default settings, about files as surveys make them: each case that would bias the shear is
reported with its cause, and there is no warning about a good file. How large the biases are is `shear-paper survey`
(validation/survey.md).

A case marked `awaited` is one that the tool does not report yet. Its test fails once the tool does: remove the mark
then."""
import math
import random
import re
import unittest

from fitsfile import Field, gaussian
from tool import ToolTest, shearctl

awaited = unittest.expectedFailure


def bright(n=64, sigma=1.0, **keys):
    """Galaxies of signal-to-noise about 60."""
    return Field(n=n, sigma=sigma, **keys)


def correlated(rng, nx, ny, sigma):
    """White noise through the kernel (1 2 1; 2 4 2; 1 2 1) / 6: variance sigma^2, neighbours alike."""
    wide = [[rng.gauss(0, sigma / 6) for _ in range(nx + 2)] for _ in range(ny + 2)]
    rows = [[r[x] + 2 * r[x + 1] + r[x + 2] for x in range(nx)] for r in wide]
    return [rows[y][x] + 2 * rows[y + 1][x] + rows[y + 2][x] for y in range(ny) for x in range(nx)]


class Case(ToolTest):
    def told(self, field, *options):
        """What validate and measure say beside the numbers: verdict, advice, errors, warnings."""
        path = field if isinstance(field, str) else field.write(self.path("a.fits"))
        validate = shearctl("validate", "--json", path, *options)
        measure = shearctl("measure", "--json", path, *options)
        self.verdict = validate.json()[0] if validate.out else None
        self.result = (measure.json() or [None])[0] if measure.out else None
        words = [validate.err, measure.err]
        if self.verdict and (not self.verdict["good"] or self.verdict["advice"]):
            words += [self.verdict["verdict"], self.verdict["advice"]]
        if self.result:
            words += self.result.get("warnings") or []
        return "\n".join(words).strip()

    def tells(self, field, cause, *options, bad=False):
        words = self.told(field, *options)
        self.assertRegex(words, re.compile(cause, re.IGNORECASE))
        if bad:
            self.assertIs(self.verdict["good"], False)

    def flags(self, field, name, stamps):
        self.told(field)
        self.assertEqual(self.verdict["flags"][name]["first"], stamps)
        self.assertEqual(self.result["flags"][name], len(stamps))


class GoodData(Case):
    def test_nothing_is_said(self):
        self.assertEqual(self.told(bright()), "")
        self.assertIs(self.verdict["good"], True)
        self.assertEqual(self.told(bright(sigma=5.0)), "")
        self.assertEqual(self.result["n_flagged"], 0)

    def test_sharp_and_bright_galaxies_are_no_artefacts(self):
        self.told(Field(n=32, sigma=0.05, size=1.0))
        self.assertEqual(self.result["n_flagged"], 0)


class NoiseUnderTheGalaxies(Case):
    def test_its_level(self):
        field = bright(sigma=3.0)
        rng = random.Random(5)
        for stamp in field.galaxy:  # 4 % more variance
            stamp[:] = [p + rng.gauss(0, 0.2 * 3.0) for p in stamp]
        words = [line for line in self.told(field).splitlines() if "border" not in line]
        self.assertRegex("\n".join(words), r"noise")

    def test_its_shape(self):
        field = bright(sigma=0.0)
        rng = random.Random(5)
        for galaxy, noise in zip(field.galaxy, field.noise):
            galaxy[:] = [p + q for p, q in zip(galaxy, correlated(rng, field.nx, field.ny, 3.0))]
            noise[:] = [rng.gauss(0, 3.0) for _ in noise]
        self.tells(field, r"noise.*(correlat|shape|spectrum)|(correlat|shape|spectrum).*noise", bad=True)
        self.assertRegex(self.verdict["verdict"], r"noise.*spectrum.*biased")

    def without_noise(self, sigma, pixel=lambda rng: 0.0, sky=0.0, bitpix=-32, **keys):
        """Noise stamps without noise: `pixel` over a sky."""
        rng = random.Random(6)
        field = bright(sigma=sigma, **keys)
        field.galaxy = [[p + sky for p in stamp] for stamp in field.galaxy]
        field.noise = [[sky + pixel(rng) for _ in stamp] for stamp in field.noise]
        field.bitpix = bitpix
        return field

    def test_noise_stamps_without_noise(self):
        """Reported with its cause, and nothing else; the size of the bias is that from the noise level, if it can be
        measured."""
        self.tells(self.without_noise(3.0, sky=50.0), r"noise stamps hold no noise.*makes the shear 2[0-9] % too large",
                   bad=True)
        self.assertEqual([w.count("noise stamps hold no noise") for w in self.result["warnings"]], [1])
        weak = self.told(self.without_noise(3.0, lambda rng: rng.gauss(0, 1e-3)))
        self.assertRegex(weak, r"without that, the shear would be 2[0-9] % too large")
        self.assertIs(self.verdict["good"], True)
        self.tells(self.without_noise(10.0), r"hold no noise.*no shear could be measured", bad=True)
        self.assertNotRegex(self.told(self.without_noise(10.0)), r"narrower|borders|gradient")
        self.tells(self.without_noise(3.0, r_psf=0.7, size=1.5), r"noise stamps hold no noise", bad=True)

    def test_rounding_is_no_noise(self):
        """Over a bright sky pixels round, and the rest gives no noise level."""
        for sigma in (0.0, 3.0):
            for wiggle, bitpix in ((1e-12, -64), (3e-4, -32)):
                with self.subTest(sigma=sigma, wiggle=wiggle):
                    words = self.told(self.without_noise(sigma, lambda rng: rng.gauss(0, wiggle), 1e4, bitpix))
                    self.assertIsNone((self.result["noise_level"] or {}).get("alpha"))
                    self.assertIs(self.verdict["good"], sigma == 0.0)
                    self.assertRegex(words, r"^$" if sigma == 0.0 else r"noise stamps hold no noise")


class Sky(Case):
    def shear(self, sky, *options, r_gal=False):
        field = bright(n=24)
        for stamps in (field.galaxy, field.noise):
            stamps[:] = [[p + sky for p in stamp] for stamp in stamps]
        field.bitpix = -64
        if r_gal:
            field.columns = [("R_GAL", "D", [3.0] * field.n)]
        answer = self.measure_one(field.write(self.path(f"sky{sky}.fits")), *options)
        return answer["g1"], answer["g2"]

    def test_a_sky_in_both_changes_nothing(self):
        for options, r_gal in ((("--core", 14), False), ((), True), ((), False)):
            with self.subTest(options=options, r_gal=r_gal):
                dark, sky = self.shear(0.0, *options, r_gal=r_gal), self.shear(100.0, *options, r_gal=r_gal)
                self.assertLess(math.dist(dark, sky), 1e-4)


    def slope(self, field, x, y):
        """A plane that rises by so much of the flux, over the whole stamp, from border to border."""
        step = sum(field.galaxy[0]) / len(field.galaxy[0]) / (field.nx - 1)
        for k, stamp in enumerate(field.galaxy):
            sign = 1 if k % 2 == 0 or abs(x) + abs(y) < 2 else -1
            stamp[:] = [p + sign * step * (x * (i % field.nx - field.nx / 2) + y * (i // field.nx - field.ny / 2))
                        for i, p in enumerate(stamp)]
        return field

    def test_a_gradient(self):
        self.assertEqual(self.told(self.slope(bright(sigma=0.1), 0.1, 0.1)), "")
        self.tells(self.slope(bright(sigma=0.1), 0.8, -0.5), r"a gradient lies over the stamps.*right.*brighter",
                   "--filter", "none")

    def test_gradients_of_many_directions(self):
        self.tells(self.slope(bright(), 2.0, 1.0), r"gradients lie over the stamps.*changing directions")


class Artefacts(Case):
    PIXEL = 10 * 48 + 12

    def spoilt(self, value, add):
        field = bright(sigma=2.0)
        for stamp in (5, 40):
            field.galaxy[stamp][self.PIXEL] = value + (field.galaxy[stamp][self.PIXEL] if add else 0.0)
        return field

    def test_a_cosmic_ray(self):
        self.flags(self.spoilt(80.0, True), "artefact", [5, 40])

    def test_a_hot_pixel(self):
        self.flags(self.spoilt(400.0, True), "artefact", [5, 40])

    def test_sentinels(self):
        for value in (-9999.0, -1e30):
            with self.subTest(value=value):
                self.told(self.spoilt(value, False))
                self.assertEqual(self.result["n_flagged"], 2)


    def test_flat_tops(self):
        """Two galaxies that lose their peaks to a ceiling; and counts of photons, which are often equal."""
        field = bright(sigma=0.5)
        for stamp in (5, 40):
            top = 0.6 * max(field.galaxy[stamp])
            field.galaxy[stamp] = [min(p, top) for p in field.galaxy[stamp]]
        self.flags(field, "artefact", [5, 40])
        counts = bright(sigma=1.0)
        for stamps in (counts.galaxy, counts.noise):
            stamps[:] = [[float(round(p + 20.0)) for p in stamp] for stamp in stamps]
        self.flags(counts, "artefact", [])


class OneStampDecides(Case):
    def flagged_or_named(self, field, stamp):
        words = self.told(field)
        if self.result and self.result["n_flagged"]:
            self.assertEqual(self.result["n_flagged"], 1)
            named = [f["first"] for f in self.verdict["flags"].values() if f["count"]]
            self.assertEqual(named, [[stamp]])
        else:
            self.assertRegex(words, rf"stamp {stamp}\b")

    def test_a_star(self):
        field = bright()
        star = gaussian(field.nx, field.ny, 3e6, (1.5 ** 2, 1.5 ** 2, 0.0), 7.0, -4.0)
        field.galaxy[17] = [p + q for p, q in zip(field.galaxy[17], star)]
        self.flagged_or_named(field, 17)

    def test_a_stamp_off_the_chip(self):
        field = bright()
        for i in range(field.ny * field.nx):
            if i % field.nx > 30:
                field.galaxy[17][i] = -1000.0
        self.flagged_or_named(field, 17)

    def with_psf(self, psf):
        field = bright()
        field.columns = [("PSF_ID", "J", list(range(field.n)))]
        field.psf_cube = [field.psf] * field.n
        field.psf_cube[17] = psf
        return field

    def test_a_flat_psf(self):
        rng = random.Random(1)
        for noise in (0.0, 0.01):
            with self.subTest(noise=noise):
                self.flags(self.with_psf([1.0 + rng.gauss(0, noise) for _ in range(48 * 48)]), "psf_unusable", [17])

    def test_a_psf_of_noise(self):
        rng = random.Random(1)
        self.flagged_or_named(self.with_psf([1.0 + rng.gauss(0, 0.1) for _ in range(48 * 48)]), 17)


class PsfImages(Case):
    def with_psf(self, change, **keys):
        field = bright(n=24, **keys)
        n = field.psf_nx
        field.psf = [change(p, i % n - (n - 1) / 2, i // n - (n - 1) / 2) for i, p in enumerate(field.psf)]
        return field

    def test_a_border(self):
        peak = max(bright(n=1).psf)
        self.tells(self.with_psf(lambda p, x, y: p + 0.01 * peak), r"psf.*(border|background|pedestal)")

    def test_corner_ordered(self):
        field = bright(n=24)
        n, half = field.psf_nx, field.psf_nx // 2
        field.psf = [field.psf[(y + half) % n * n + (x + half) % n] for y in range(n) for x in range(n)]
        self.tells(field, r"corner")

    def test_cut(self):
        self.tells(self.with_psf(lambda p, x, y: p if max(abs(x), abs(y)) < 2 else 0.0), r"psf.*(cut|wings|edge)")

    def test_one_sample_a_pixel_where_it_is_narrow(self):
        self.tells(Field(n=24, r_psf=0.45), r"psf.*sampl|OVERSAMP")

    def test_a_star_s_noise(self):
        rng = random.Random(3)
        norm = math.sqrt(sum(p * p for p in bright(n=1).psf))
        self.tells(self.with_psf(lambda p, x, y: p + rng.gauss(0, norm / 100)), r"psf.*nois")


class Mistakes(Case):
    def test_galaxy_and_noise_swapped(self):
        field = bright()
        field.galaxy, field.noise = field.noise, field.galaxy
        self.tells(field, r"swapped|exchanged|the wrong way", bad=True)

    def test_noise_is_galaxy(self):
        field = bright()
        field.noise = [list(stamp) for stamp in field.galaxy]
        self.tells(field, r"equal|the same|identical", bad=True)

    def test_no_weight(self):
        field = bright()
        field.columns = [("WEIGHT", "D", [0.0] * field.n)]
        self.tells(field, r"weight", bad=True)

    def test_oversamp_forgotten(self):
        field = bright(psf_oversample=3)
        field.oversample = 1
        self.tells(field, r"OVERSAMP", bad=True)


class SmallStamps(Case):
    def test_small_for_beta(self):
        """12 px, beta = 2 px: the shear is 1.5 times what it should be."""
        field = Field(n=24, nx=12, ny=12, size=1.0, r_psf=1.0)
        self.tells(field, r"stamps of 12 x 12 px are small for beta = 2 px.*20 px at least", bad=True)
        self.assertGreater(self.result["g1"], 0.04)
        self.assertEqual(self.told(Field(n=24, nx=22, ny=22, size=1.0, r_psf=1.0)), "")

    def test_too_small_for_any_shear(self):
        for sigma in (0.0, 0.5):
            field = Field(n=24, nx=8, ny=8, size=2.0, r_psf=1.2, sigma=sigma)
            self.tells(field, r"stamps are too small for beta", bad=True)
            self.assertNotRegex(self.told(field), r"narrower")


class Wings(Case):
    def test_no_advice_that_harms(self):
        """Wings that are cut off are not neighbours: a filter at the edge would bias the shear."""
        field = bright(nx=32, ny=32, sigma=0.01)
        for i, stamp in enumerate(field.galaxy):
            flux = sum(stamp)
            for part, size in ((0.5, 5.0), (0.4, 9.0)):
                xx, yy = size ** 2 * (1.1 if i % 2 else 0.9), size ** 2 * (0.9 if i % 2 else 1.1)
                stamp[:] = [p + q for p, q in zip(stamp, gaussian(32, 32, part * flux, (xx, yy, 0.0)))]
        words = self.told(field)
        self.assertIn("larger stamps", words)
        self.assertNotIn("filter edge", words)


if __name__ == "__main__":
    unittest.main()
