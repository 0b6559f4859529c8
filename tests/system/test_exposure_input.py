# SPDX-License-Identifier: GPL-3.0-or-later
"""What is given with an exposure, in all ways of giving it: flags of galaxies, masks and weights, catalogs, coordinates,
compressed files, noise; and mosaics of stamps without keywords."""
import gzip
import re
import shutil
import subprocess
import unittest

from exposures import ExposureTest, Image, images, ldac, read, write, write_images
from fitsfile import card, hdus, image, pad, primary, table
from tool import DONE, INPUT, ToolTest, shearctl

SATURATE = 40000.0


class Changed(ExposureTest):
    """One exposure, and what a change makes of its galaxies."""

    def setUp(self):
        super().setUp()
        self.draw()
        self.sky = images(self.path("exp.fits"))
        self.places = {n: (chip, x, y) for n, chip, x, y in
                       zip(*(self.truth()[name] for name in ("NUMBER", "CHIP", "X", "Y")))}
        self.whole = self.measure(*self.options())
        self.used = sorted(int(i) for i, f in zip(self.whole[1]["ID"], self.whole[1]["FLAGS"]) if f == 0)
        self.assertGreater(len(self.used), 60)

    def place(self, number):
        """The image of a galaxy's chip, and its place there."""
        chip, x, y = self.places[number]
        return self.sky[chip - 1], x, y

    def layer(self, kind, bitpix, value):
        """An image of one value for each chip, like the exposure's."""
        return [Image(image(chip.name, (chip.nx, chip.ny), [value] * (chip.nx * chip.ny), bitpix)) for chip in self.sky], \
            self.path(f"{kind}.fits")

    def rewrite(self):
        write_images(self.path("exp.fits"), self.sky)

    def objects(self, chip, more=()):
        """Columns of a catalog in pixels of one chip; `more` are rows (NUMBER, X, Y)."""
        rows = [(n, x, y) for n, (c, x, y) in self.places.items() if c == chip] + list(more)
        numbers, x, y = map(list, zip(*rows))
        return [("NUMBER", "J", numbers), ("X_IMAGE", "D", x), ("Y_IMAGE", "D", y), *self.ellipses(len(rows))]

    def ldac(self, *more, order=(1, 2)):
        """A catalog in pixels; `more` rows on the first chip."""
        return write(self.path("exp.ldac"), ldac([(self.sky[c - 1], self.objects(c, more if c == 1 else ()))
                                                  for c in order]))


class Flags(Changed):
    def assertFlagged(self, result, **expected):
        """These galaxies have these flags, and they are counted."""
        for name, numbers in expected.items():
            self.assertEqual(self.flagged(result, name), set(numbers), name)
            self.assertEqual(result[0]["flags"][name], len(numbers))

    def test_saturated(self):
        middle, wing, sky = self.used[:3]
        for number, away in ((middle, 0), (wing, 4), (sky, 16)):
            chip, x, y = self.place(number)
            chip.fill(x + away, y, SATURATE, half=1)
        self.rewrite()
        self.assertFlagged(self.measure(*self.options()), saturated={middle, wing}, hole=set())

    def test_holes(self):
        middle, sky = self.used[:2]
        for value in (float("nan"), float("inf"), float("-inf")):
            for number, away in ((middle, 1), (sky, 16)):
                chip, x, y = self.place(number)
                chip.fill(x + away, y, value, half=1)
            self.rewrite()
            result = self.measure(*self.options())
            # Infinite is more than SATURATE, too.
            name = "saturated" if value > 0 else "hole"
            self.assertFlagged(result, **{name: {middle}})
            self.assertEqual(result[0]["flags"]["galaxy_not_finite"], 0)

    def test_one_size_for_all(self):
        """A bad pixel's distance decides, not a galaxy's own FLUX_RADIUS, which grows with its ellipticity."""
        small, large = self.used[:2]
        for number, away in ((small, 11), (large, 16)):
            chip, x, y = self.place(number)
            chip.fill(x + away, y, float("nan"))
        self.rewrite()
        for name, factor, holes in (("FLUX_RADIUS", 1.0, {small}), ("R_GAL", 2.0, {large})):
            chips = []
            for c in (1, 2):
                objects = self.objects(c)
                sizes = [factor * {small: 2.0, large: 8.0}.get(n, 4.0) for n in objects[0][2]]
                chips.append((self.sky[c - 1], [*objects, (name, "D", sizes)]))
            result = self.measure(*self.options(sources=write(self.path("sizes.ldac"), ldac(chips))))
            self.assertFlagged(result, hole=holes)

    def test_edges(self):
        near = [(901, 20.0, 300.0), (902, 300.0, 20.0), (903, 681.0, 300.0), (904, 300.0, 681.0)]
        result = self.measure(*self.options(sources=self.ldac(*near)))
        self.assertFlagged(result, edge={901, 902, 903, 904})

    def test_no_position(self):
        away = [(901, 1e300, 300.0), (902, 300.0, -5.0), (903, float("nan"), 300.0), (904, float("inf"), 300.0),
                (905, 700.6, 300.0), (906, -1e300, 1e18)]
        result = self.measure(*self.options(sources=self.ldac(*away)))
        self.assertFlagged(result, no_position=set(range(901, 907)))

    def test_neighbours(self):
        """Another source, whether it is measured or not; one farther away is only filled."""
        near, far = self.used[:2]
        more = []
        for number, away in ((near, 14), (far, 27)):
            chip, x, y = self.place(number)
            self.assertEqual(chip.name, "CHIP1")
            more.append((900 + number, x + away, y))
        catalog = self.ldac(*more)
        self.assertFlagged(self.measure(*self.options(sources=catalog)), neighbour={near, 900 + near})
        result = self.measure(*self.options(sources=catalog, select="NUMBER < 900"))
        self.assertFlagged(result, neighbour={near})
        self.assertEqual(result[0]["n_stamps"], self.whole[0]["n_stamps"])

    def test_sources_without_a_size(self):
        """They are kept out of each other's noise stamps, and are neighbours, all the same."""
        bare = self.measure(*self.options(sources=self.path("exp.truth.fits")))
        self.assertEqual(bare[0]["n_used"], self.whole[0]["n_used"])
        for name in ("g1", "g2", "g1_err", "g2_err"):
            self.assertAlmostEqual(bare[0][name], self.whole[0][name], 4)
        near = self.used[0]
        _, x, y = self.places[near]
        places = [(n, x, y) for n, (chip, x, y) in self.places.items() if chip == 1] + [(901, x + 9, y)]
        columns = [(name, kind, list(values)) for name, kind, values in zip(("NUMBER", "X", "Y"), "JDD", zip(*places))]
        result = self.measure(*self.options(image=self.path("exp.fits:1"), sources=write(
            self.path("bare.cat"), primary() + table("SOURCES", columns))))
        self.assertFlagged(result, neighbour={near, 901})

    def test_segmentation(self):
        """Who owns a pixel decides, in place of ellipses."""
        near = self.used[0]
        layer, path = self.layer("seg", 32, 0)
        for n in self.used:
            chip, x, y = self.places[n]
            layer[chip - 1].fill(x, y, n, half=6)
        chip, x, y = self.places[near]
        layer[chip - 1].fill(x + 9, y, 7000, half=2)
        write_images(path, layer)
        self.assertFlagged(self.measure(*self.options(segmentation=path)), neighbour={near})

    def test_no_noise(self):
        """Where all the sky around is of other objects."""
        layer, path = self.layer("seg", 32, 0)
        for n in self.used:
            chip, x, y = self.places[n]
            layer[chip - 1].fill(x, y, n, half=6)
        for i in range(25, 700 * 700, 50):
            if layer[0].pixels[i] == 0:
                layer[0].pixels[i] = 7000 + i
        write_images(path, layer)
        result = self.measure(*self.options(segmentation=path))
        without, near = (self.flagged(result, name) for name in ("no_noise", "neighbour"))
        self.assertEqual(without | near, {n for n, (chip, _, _) in self.places.items() if chip == 1})
        self.assertGreater(len(without), 10)
        white = self.measure(*self.options(segmentation=path, noise="white"))
        self.assertEqual(self.flagged(white, "no_noise"), set())

    def test_select(self):
        chosen = set(self.used[::2])
        result = self.measure(*self.options(select="NUMBER % 2 == 0 && A_IMAGE > 2"))
        self.assertEqual({int(i) for i in result[1]["ID"]}, {n for n in self.places if n % 2 == 0})
        self.assertTrue(chosen)
        columns = [("NUMBER", "J", list(self.places)), ("RA", "D", self.truth()["RA"]), ("DEC", "D", self.truth()["DEC"]),
                   ("FLAGS", "J", [4 * (n % 3 == 0) + n % 2 for n in self.places]), *self.ellipses(len(self.places))]
        path = write(self.path("flags.cat"), primary() + table("SOURCES", columns))
        result = self.measure(*self.options(sources=path))
        self.assertEqual({int(i) for i in result[1]["ID"]}, {n for n in self.places if n % 3})
        result = self.measure(*self.options(sources=path, select="FLAGS >= 0"))
        self.assertEqual(len(result[1]["ID"]), len(self.places))
        answer = shearctl("measure", *self.options(select="NUMBER > 10000"))
        self.assertFails(answer, INPUT, "exp.cat", "no source is selected", "--select")


class Masks(Changed):
    def setUp(self):
        super().setUp()
        self.bad, self.harmless = self.used[:2]

    def mask(self, bad, harmless=0, good=0, bitpix=16, name="mask", cards=()):
        """A mask with `bad` in one galaxy and `harmless` in another, and its path."""
        layer, path = self.layer(name, bitpix, good)
        for number, value in ((self.bad, bad), (self.harmless, harmless)):
            chip, x, y = self.places[number]
            layer[chip - 1].fill(x + 2, y + 1, value, half=1)
        for chip in layer:
            chip.cards += cards
        return write_images(path, layer)

    def holes(self, path, rule=None, part="mask", **more):
        options = self.options(**{part: path}, **more) + (["--mask-bad", rule] if rule else [])
        result = self.measure(*options)
        return self.flagged(result, "hole"), result

    def test_any(self):
        for rule in (None, "any"):
            self.assertEqual(self.holes(self.mask(64, 0), rule)[0], {self.bad})
            self.assertEqual(self.holes(self.mask(64, 8), rule)[0], {self.bad, self.harmless})

    def test_bits(self):
        for bitpix in (8, 16, 32):
            self.assertEqual(self.holes(self.mask(1 | 8, 8 | 16, bitpix=bitpix), "bits=7")[0], {self.bad})
        self.assertEqual(self.holes(self.mask(1 << 30, 1, bitpix=32), f"bits={1 << 30}")[0], {self.bad})

    def test_zero(self):
        self.assertEqual(self.holes(self.mask(0, 1, good=1), "zero")[0], {self.bad})

    def test_planes(self):
        cards = [card(f"MP_{name}", bit).decode() for bit, name in enumerate(("BAD", "SAT", "INTRP", "CR", "EDGE"))]
        cards += ["HIERARCH MP_DETECTED = 5".ljust(80)]
        self.assertEqual(self.holes(self.mask(8, 32 | 4, cards=cards))[0], {self.bad})
        self.assertEqual(self.holes(self.mask(8, 4, cards=cards), "planes=INTRP,CR")[0], {self.bad, self.harmless})
        saturated = self.holes(self.mask(2, 32, cards=cards))
        self.assertEqual(saturated[0], set())
        self.assertEqual(self.flagged(saturated[1], "saturated"), {self.bad})
        answer = shearctl("measure", *self.options(mask=self.path("mask.fits")), "--mask-bad", "planes=SATURATED")
        self.assertFails(answer, INPUT, "mask.fits", "SATURATED", "BAD")

    def test_kinds_of_weight(self):
        """Weights, variances and standard deviations of the same noise give the same bits."""
        results = []
        for kind, good in (("weight", 0.25), ("variance", 4.0), ("rms", 2.0)):
            path = self.mask(0.0, good, good=good, bitpix=-32, name=kind)
            holes, result = self.holes(path, part="weight", **{"weight-kind": kind})
            self.assertEqual(holes, {self.bad})
            results.append(result)
        for other in results[1:]:
            self.assertSameBits(results[0], other)
        for value in (-1.0, float("nan"), float("inf")):
            self.assertEqual(self.holes(self.mask(value, 0.25, good=0.25, bitpix=-32), part="weight")[0], {self.bad})
        for kind, huge in (("variance", 1e30), ("rms", 1e15)):
            path = self.mask(huge, 1.0, good=1.0, bitpix=-32)
            self.assertEqual(self.holes(path, part="weight", **{"weight-kind": kind})[0], {self.bad})

    def test_weights_are_relative(self):
        one, other = (self.measure(*self.options(weight=self.mask(good, good, good=good, bitpix=-32)))
                      for good in (1.0, 1024.0))
        self.assertEqual(one[0]["n_used"], other[0]["n_used"])
        self.assertAlmostEqual(one[0]["g1"], other[0]["g1"], 6)

    def test_other_sizes(self):
        layer, path = self.layer("mask", 16, 0)
        layer[1] = Image(image("CHIP2", (700, 699), [0] * (700 * 699), 16))
        write_images(path, layer)
        answer = shearctl("measure", *self.options(mask=path))
        self.assertFails(answer, INPUT, "mask.fits", "CHIP2", "700 x 699", "700 x 700")


class SameBits(Changed):
    """The same exposure, written in another way."""

    def assertSame(self, but=(), **changed):
        self.assertSameBits(self.whole, self.measure(*self.options(**changed), keep="other"), but)

    def test_pixels_or_sky(self):
        """The places of a catalog in pixels are those of RA and Dec, but for rounding."""
        result = self.measure(*self.options(sources=self.ldac()))
        self.assertEqual(result[1]["ID"], self.whole[1]["ID"])
        self.assertEqual(result[1]["FLAGS"], self.whole[1]["FLAGS"])
        self.assertAlmostEqual(result[0]["g1"], self.whole[0]["g1"], 6)
        self.assertAlmostEqual(result[0]["g2"], self.whole[0]["g2"], 6)

    def test_order_of_extensions(self):
        """All parts in the order of the image, and all in the other."""
        weight, _ = self.layer("weight", -32, 1.0)
        mask, _ = self.layer("mask", 16, 0)
        for number, layer, value in ((self.used[0], weight, 0.0), (self.used[1], mask, 1), (self.used[-1], mask, 1)):
            chip, x, y = self.places[number]
            layer[chip - 1].fill(x, y, value)
        results = []
        for order in (1, -1):
            changed = {"sources": self.ldac(order=(1, 2)[::order]),
                       "weight": write_images(self.path("weight.fits"), weight[::order]),
                       "mask": write_images(self.path("mask.fits"), mask[::order])}
            results.append(self.measure(*self.options(**changed)))
        self.assertSameBits(*results)
        self.assertEqual(self.flagged(results[0], "hole"), {self.used[0], self.used[1], self.used[-1]})

    def test_one_chip(self):
        """Chips that are measured alone make the whole."""
        catalog = self.ldac()
        parts = [self.measure(*self.options(image=self.path("exp.fits") + hdu, sources=catalog))
                 for hdu in (":1", ":chip2")]
        whole = self.measure(*self.options(sources=catalog))
        self.assertEqual(parts[0][1]["ID"] + parts[1][1]["ID"], whole[1]["ID"])
        self.assertEqual(parts[0][1]["FLAGS"] + parts[1][1]["FLAGS"], whole[1]["FLAGS"])

    def test_packed(self):
        for name in ("exp.fits", "exp.cat", "psf.fits"):
            with gzip.open(self.path(name + ".gz"), "wb", 1) as file:
                file.write(read(self.path(name)))
        self.assertSame(image=self.path("exp.fits.gz"), sources=self.path("exp.cat.gz"), psf=self.path("psf.fits.gz"))

    @unittest.skipUnless(shutil.which("fpack"), "needs fpack")
    def test_tiles(self):
        subprocess.run(["fpack", "-g", "-q", "0", self.path("exp.fits")], check=True, timeout=600)
        self.assertSame(image=self.path("exp.fits.fz"))

    def test_origin(self):
        rounded = {n: (c, round(64 * x) / 64, round(64 * y) / 64) for n, (c, x, y) in self.places.items()}
        self.places = rounded
        one = self.measure(*self.options(sources=self.ldac()))
        self.places = {n: (c, x - 1, y - 1) for n, (c, x, y) in rounded.items()}
        self.assertSameBits(one, self.measure(*self.options(sources=self.ldac(), origin=0)), ("X_IMAGE", "Y_IMAGE"))

    def test_names_of_columns(self):
        content = read(self.path("exp.cat"))
        for name, other in ((b"'RA      '", b"'MY_ALPHA'"), (b"'DEC     '", b"'MY_DELTA'"), (b"'A_IMAGE '", b"'MAJOR   '"),
                            (b"'B_IMAGE '", b"'MINOR   '"), (b"'NUMBER  '", b"'WHO     '")):
            self.assertEqual(content.count(name), 1)
            content = content.replace(name, other)
        path = write(self.path("other.cat"), content)
        # Columns that are named stand as they are: circles of 3 px in place of 9.
        result = self.measure(*self.options(sources=path, columns="ra=my_alpha,dec=MY_DELTA,a=MAJOR,b=MINOR,"
                                                                  "theta=THETA_IMAGE,id=who"))
        self.assertEqual(result[1]["ID"], self.whole[1]["ID"])
        self.assertEqual(result[1]["X"], self.whole[1]["X"])
        self.assertFails(shearctl("measure", *self.options(sources=path)), INPUT, "other.cat", "--columns")

    def test_wcs_of_a_head_file(self):
        """The image has other coordinates, or none."""
        wcs = re.compile(r"(CTYPE|CUNIT|CRVAL|CRPIX|CD|PV)\d|EQUINOX|RADESYS")
        head = "".join("".join(c.rstrip() + "\n" for c in chip.cards if wcs.match(c)) + "END     \n" for chip in self.sky)
        path = write(self.path("exp.head"), head.encode("ascii"))
        self.assertSame(wcs=path)
        for chip in self.sky:
            chip.cards = [c if not wcs.match(c) else c.replace("CRVAL", "XRVAL") for c in chip.cards]
        write_images(self.path("exp.fits"), self.sky)
        self.assertFails(shearctl("measure", *self.options()), INPUT, "exp.fits", "CRVAL1")
        self.assertSame(wcs=path)
        for chip in self.sky:
            chip.cards = [c for c in chip.cards if not wcs.match(c)]
        write_images(self.path("exp.fits"), self.sky)
        self.assertFails(shearctl("measure", *self.options()), INPUT, "exp.cat", "RA and Dec only", "--wcs")
        self.assertSame(wcs=path)
        one = write(self.path("one.head"), head[:head.index("END")].encode("ascii") + b"END\n")
        self.assertEqual(self.measure(*self.options(wcs=one, sources=self.ldac()))[0]["n_stamps"], self.whole[0]["n_stamps"])
        three = write(self.path("three.head"), read(path) + read(one))
        self.assertFails(shearctl("measure", *self.options(wcs=three)), INPUT, "three.head", "3 blocks for 2 chips", "END")


class Noise(Changed):
    def compare(self, result):
        """As many galaxies are used, with a shear that is the same within the noise."""
        self.assertGreaterEqual(result[0]["n_used"], self.whole[0]["n_used"] - 2)
        for name in ("g1", "g2"):
            error = self.whole[0][name + "_err"]
            self.assertLess(abs(result[0][name] - self.whole[0][name]), error)
            self.assertLess(result[0][name + "_err"], 1.3 * error)
        self.assertEqual(result[0]["warnings"], self.whole[0]["warnings"])
        self.assertAlmostEqual(result[0]["noise_level"]["alpha"], 1.0, delta=0.1)

    def test_white(self):
        self.compare(self.measure(*self.options(noise="white")))

    def test_an_image(self):
        self.assertCode(shearctl("expose", self.path("noise.fits"), *self.DRAWN, "--seed", 77, "--galaxies", 0,
                                 "--spacing", 0), DONE)
        result = self.measure(*self.options(noise=self.path("noise.fits")))
        self.compare(result)
        chips = images(self.path("noise.fits"))
        answer = shearctl("measure", *self.options(noise=self.path("noise.fits")), "--noise-stamps", 2)
        self.assertNotEqual(answer.code, DONE)
        self.assertIn("noise", answer.err)
        noise = write_images(self.path("noise.fits"), chips[::-1])
        self.assertSameBits(result, self.measure(*self.options(noise=noise)))
        _, x, y = self.places[self.used[0]]
        chips[0].fill(x, y, float("nan"))
        write_images(noise, chips[:1])  # one for all
        self.compare(self.measure(*self.options(noise=noise)))
        other = Image(image("CHIP2", (700, 699), [0.0] * (700 * 699)))
        for wrong, words in (([chips[0], other], ("CHIP2", "700 x 699", "700 x 700")),
                             (chips + [other], ("3 images of noise", "CHIP2"))):
            write_images(noise, wrong)
            self.assertFails(shearctl("measure", *self.options(noise=noise)), INPUT, "noise.fits", *words)

    def test_several_stamps(self):
        result = self.measure(*self.options(), "--noise-stamps", 3)
        self.compare(result)
        field = self.path("field.fits")
        self.assertCode(shearctl("extract", *self.options(), "--noise-stamps", 3, "-o", field, "--quiet"), DONE)
        self.assertSameBits(result, self.measure(field, keep="field"))

    def test_is_reproducible(self):
        self.assertSameBits(self.whole, self.measure(*self.options(), "--threads", 7))


class Mosaics(ToolTest):
    """Stamps side by side in an image whose header does not say so."""

    def setUp(self):
        super().setUp()
        self.field = self.path("field.fits")
        self.assertCode(shearctl("mock", self.field, "--stamps", 20, "--size", 48, "--quiet"), DONE)
        parts = dict(hdus(read(self.field)))
        self.stamps = {}
        for name in ("GALAXY", "NOISE"):
            at = parts[name].index(b"END".ljust(80))
            data = parts[name][at + 80 + -(at + 80) % 2880:]
            bitpix = int(re.search(rb"BITPIX  = +(-?\d+)", parts[name]).group(1))
            self.assertEqual(bitpix, -32)
            rows = [data[4 * 48 * k:4 * 48 * (k + 1)] for k in range(48 * 20)]
            mosaic = b"".join(rows[(5 * j + i) * 48 + y] for j in range(4) for y in range(48) for i in range(5))
            head = b"".join([card("SIMPLE", True), card("BITPIX", -32), card("NAXIS", 2), card("NAXIS1", 240),
                             card("NAXIS2", 192), card("END")])
            self.stamps[name] = write(self.path(name + ".fits"), pad(head, b" ") + pad(mosaic))
        self.parts = ["--galaxy", self.stamps["GALAXY"], "--noise", self.stamps["NOISE"], "--psf", self.field]

    def test_with_their_size(self):
        cube = self.measure_one(self.field, "--quiet")
        mosaic = self.measure_one(*self.parts, "--catalog-in", self.field, "--stamp-size", 48, "--quiet")
        for name in ("n_stamps", "n_used", "g1", "g2", "g1_err", "cov12"):
            self.assertEqual(cube[name], mosaic[name])
        self.assertEqual(self.measure_one(*self.parts, "--stamp-size", "48x48", "--stamps", 17, "--quiet")["n_stamps"], 17)

    def test_sizes_that_do_not_fit(self):
        self.assertFails(shearctl("measure", *self.parts, "--stamp-size", 50), INPUT, "GALAXY.fits", "240 x 192", "50")
        self.assertFails(shearctl("measure", *self.parts, "--stamp-size", 48, "--stamps", 21), INPUT, "21", "20")
        for size in ("0", "48x", "x", "-48", "48x48x2", "1e9", "99999999999999999999"):
            answer = shearctl("measure", *self.parts, "--stamp-size", size)
            self.assertNotEqual(answer.code, DONE)
            self.assertIn("stamp-size", answer.err)

    def test_a_large_image_without_size(self):
        """It is no stamp of 1,024 px."""
        side = 1024
        head = b"".join([card("SIMPLE", True), card("BITPIX", -32), card("NAXIS", 2), card("NAXIS1", side),
                         card("NAXIS2", side), card("END")])
        grid, noise = (write(self.path(name), pad(head, b" ") + pad(bytes(4 * side * side)))
                       for name in ("grid.fits", "noise.fits"))
        answer = shearctl("measure", "--galaxy", grid, "--noise", noise, "--psf", self.field)
        self.assertFails(answer, INPUT, "grid.fits", "1024 x 1024", "--stamp-size")


if __name__ == "__main__":
    unittest.main()
