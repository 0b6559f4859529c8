# SPDX-License-Identifier: GPL-3.0-or-later
"""Real files of surveys through the command line, where the folder SHEAR_SHARED/survey exists: each is read, or refused
with its reason. What is in them, and where they are from, is in the folder's SOURCES.md."""
import fnmatch
import glob
import json
import math
import os
import re
import shutil
import subprocess
import unittest

from exposures import FLAG, PSF_UNUSABLE, ExposureTest, columns, keywords, psf_image, read, write
from fitsfile import card, hdus, header, image, pad, primary, table
from tool import DONE, INPUT, SANITIZED, shearctl

SURVEY = os.path.join(os.environ.get("SHEAR_SHARED", ""), "survey")
SEXTRACTOR = shutil.which("source-extractor") or shutil.which("sex")
MEDS = "is a MEDS file .*, which cannot be read"
NO_TABLE, NO_IMAGE, NO_PSF, TEXT = "has no binary table", "has no 2-D image", "holds no PSF", "not a FITS file"
NO_PLACES, SEVERAL = "has no positions: no numbers X_IMAGE", "images, none of which is called PSF"
# As image, catalog and PSF: None: read; else why it is refused. The first pattern that fits decides.
FILES = (
    ("exposures/HSC-*", None, NO_PLACES, SEVERAL),
    ("exposures/*_ood_*", None, NO_TABLE, "not positive"),
    ("exposures/k4m*_ooi_*", None, NO_TABLE, None),  # a PSF at first sight
    ("exposures/*weight.fits", None, NO_TABLE, "flat"),
    ("exposures/ntt*", None, NO_TABLE, None),
    ("exposures/*", None, NO_TABLE, "edge|corners"),
    ("ldac/*findstars.fits", NO_IMAGE, None, None),
    ("ldac/sim_ASCII.cat.gz", TEXT, "ASCII_HEAD", TEXT),
    ("ldac/sim_ASCII_HEAD.cat", TEXT, None, TEXT),
    ("ldac/*", NO_IMAGE, None, NO_PSF),
    ("meds/*.fits", MEDS, "none of 12 selected sources is on the image", MEDS),
    ("piff/test_single*", NO_IMAGE, "3 tables of sources", "'Moffat' of Piff needs Piff itself"),
    ("piff/testStarsRubin*", NO_IMAGE, NO_PLACES, "none of .* has a PSF"),  # its stars are elsewhere
    ("piff/truth*", NO_IMAGE, None, NO_PSF),
    ("piff/*", NO_IMAGE, None, "none of .* has a PSF"),  # the models of another place on the sky
    ("psfex/*snapshots*", None, NO_TABLE, None),
    ("psfex/*s.fits", None, NO_TABLE, None),
    ("psfex/truth*", "one table of pixel positions", NO_TABLE, SEVERAL),
    ("psfex/sim_psfex_out.cat", NO_IMAGE, None, NO_PSF),
    ("psfex/invalid*", NO_IMAGE, NO_PLACES, "PSFAXIS3 is 3, but PSF_MASK has 6 planes"),
    ("psfex/sim_ldac_mag.psf", NO_IMAGE, NO_PLACES, "no column MAG_AUTO, on which the PSF model depends"),
    ("psfex/*", NO_IMAGE, NO_PLACES, None),
    ("run/ntt_ldac.cat.gz", NO_IMAGE, None, r"only \d+ of 680 stamps look like stars"),
    ("run/*.cat*", NO_IMAGE, None, NO_PSF),
    ("run/sim_truth.fits", NO_IMAGE, None, NO_PSF),
    ("run/*.fits*", None, NO_TABLE, "images of the sky|not of the sky"),
    ("run/*.psf", NO_IMAGE, NO_PLACES, None),
    ("stamps/*catalog*", NO_IMAGE, "is on the image", NO_PSF),
    ("stamps/14*g1_0.02*", None, NO_TABLE, "edge is as bright"),
    ("stamps/14*", None, NO_TABLE, None),
    ("stamps/*", "one table of pixel positions", NO_TABLE, SEVERAL),
    ("wcs/*header.fits", NO_IMAGE, NO_TABLE, NO_PSF),
    ("wcs/scamp.head", TEXT, "neither FITS nor SExtractor's ASCII_HEAD", TEXT),
    ("wcs/*sample.fits", None, NO_TABLE, "not finite"),
    ("wcs/pole.fits", None, NO_TABLE, "not finite"),
    ("wcs/razero.fits", None, NO_TABLE, "not finite"),
    ("wcs/*.fits*", None, NO_TABLE, None),
)


def path_of(name):
    return os.path.join(SURVEY, name)


@unittest.skipIf(SANITIZED, "a star field that is given as the PSF takes minutes there")
@unittest.skipUnless(os.path.isdir(SURVEY), "needs the folder of real files")
class Real(ExposureTest):
    def setUp(self):
        super().setUp()
        self.psf = write(self.path("psf.fits"), primary() + image("PSF", (33, 33), psf_image(33), -64))

    def grid(self, n=5, first=30.0, step=20.0):
        """A catalog of places in pixels."""
        places = [(first + step * (i % n), first + step * (i // n)) for i in range(n * n)]
        return write(self.path("grid.cat"), primary() + table("GRID", [
            ("NUMBER", "J", list(range(n * n))), ("X", "D", [x for x, _ in places]), ("Y", "D", [y for _, y in places])]))

    def extract(self, *options):
        """The columns of the extracted field's catalog."""
        field = self.path("field.fits")
        answer = shearctl("extract", *options, "-o", field, "--force", "--quiet")
        self.assertCode(answer, DONE)
        return columns(dict(hdus(read(field)))["CATALOG"])


class Every(Real):
    def told(self, *options):
        """None if all is read, even if there is no shear in it; else the error."""
        answer = shearctl("measure", "--json", "--quiet", "--artefacts", "keep", *options)
        self.assertIn(answer.code, (DONE, INPUT), answer.err)
        return None if answer.out else answer.err

    def test_is_read_or_refused(self):
        self.draw("--chips", 1)
        own = {"image": self.path("exp.fits"), "sources": self.path("exp.truth.fits"), "psf": self.psf, "stamp": 16}
        grid = self.grid(4)
        names = [name for name in glob.glob(path_of("*/*")) if name.endswith((".fits", ".psf", ".cat", ".gz", ".piff",
                                                                              ".head", ".fz"))]
        self.assertGreater(len(names), 60)
        for name in sorted(names):
            short = os.path.relpath(name, SURVEY)
            _, *expected = next(row for row in FILES if fnmatch.fnmatch(short, row[0]))
            for part, why in zip(("image", "sources", "psf"), expected):
                with self.subTest(file=short, part=part):
                    parts = {**own, part: name, **({"sources": grid} if part == "image" else {})}
                    words = self.told(*(w for p, v in parts.items() for w in (f"--{p}", v)))
                    if why is None:
                        self.assertIsNone(words)
                    else:
                        self.assertRegex(words or "it was read", why)


class Coordinates(Real):
    def image_of(self, name):
        """The image with the coordinates of wcs_truth.json, and its HDU."""
        return {"tpv_mosaic.fits": "wcs/tpv.fits", "tanpv_scamp_style.fits": "wcs/tanpv.fits.gz",
                "tanflip.fits": "wcs/tanflip.fits.gz", "hsc_small.fits": "exposures/HSC-0908120-056-small.fits:1",
                "sim_sci.fits": "run/sim_sci_int16.fits.fz",
                "decam_ooi.fits": "exposures/c4d_170916_045042_ooi_r_ls9.N15.fits"}.get(name, "wcs/" + name)

    def with_pixels(self, name):
        """A file with the header's cards and an image that is 0."""
        (_, hdu), = hdus(read(path_of(name)))
        keys, _ = keywords(hdu)
        every = [hdu[i:i + 80] for i in range(0, len(hdu), 80)]
        wcs = [one for one in every if re.match(rb"(CTYPE|CRVAL|CRPIX|CD|PV|CUNIT)\d", one)]
        nx, ny = 2048, 4096
        cards = [card("SIMPLE", True), card("BITPIX", 8), card("NAXIS", 2), card("NAXIS1", nx), card("NAXIS2", ny), *wcs]
        self.assertGreater(len(wcs), 20, keys)
        return write(self.path("pixels.fits"), pad(b"".join(cards) + card("END"), b" ") + pad(bytes(nx * ny)))

    def test_places_and_jacobians(self):
        with open(path_of("wcs/wcs_truth.json"), encoding="ascii") as file:
            truth = json.load(file)
        self.assertEqual(len(truth), 10)
        for name, entry in truth.items():
            points = entry["points"]
            path = self.with_pixels("wcs/" + name) if name.endswith("header.fits") else path_of(self.image_of(name))
            sources = write(self.path("radec.cat"), primary() + table("POINTS", [
                ("NUMBER", "J", list(range(len(points)))), ("RA", "D", [p["ra"] for p in points]),
                ("DEC", "D", [p["dec"] for p in points])]))
            with self.subTest(name):
                rows = self.extract("--image", path, "--sources", sources, "--psf", self.psf, "--stamp", 16)
                for i, point in enumerate(points):
                    self.assertLess(math.dist((rows["X"][i], rows["Y"][i]), (point["x"], point["y"])), 1e-3)
                    (a, b), (c, d) = point["J"]
                    xx, yy, xy = b * b + d * d, a * a + c * c, -(a * b + c * d)
                    root = 2 * abs(a * d - b * c)
                    self.assertAlmostEqual(rows["GF1"][i], (xx - yy) / (xx + yy + root), 5)
                    self.assertAlmostEqual(rows["GF2"][i], 2 * xy / (xx + yy + root), 5)

    def test_head_of_scamp(self):
        """A sky of THELI's mosaic in place of an image's own."""
        rows = self.extract("--image", path_of("wcs/tpv.fits"), "--wcs", path_of("wcs/scamp.head"), "--sources",
                            self.grid(), "--psf", self.psf, "--stamp", 16)
        # 9,600 px from the reference pixel at 15.7, -3.2, of 0.184 arcsec
        for ra, dec in zip(rows["RA"], rows["DEC"]):
            self.assertTrue(15.9 < ra < 16.4 and -4.0 < dec < -3.5, (ra, dec))


class EndToEnd(Real):
    def test_ntt(self):
        """A real deep field; its catalog and its PSF are SExtractor's and PSFEx's."""
        options = ["--image", path_of("exposures/ntt_emmi_galaxies.fits"), "--sources", path_of("run/ntt_ldac.cat.gz"),
                   "--weight", path_of("exposures/ntt_emmi_galaxies.weight.fits"), "--psf", path_of("run/ntt_ldac.psf"),
                   "--stamp", 32]
        result = self.measure(*options)
        self.assertEqual(result[0]["n_stamps"], 649)
        self.assertGreater(result[0]["n_used"], 400)
        self.assertTrue(0.85 < result[0]["resolved"]["r_psf_px"] < 1.05)
        self.assertNotIn("GF1", result[1])  # it has no coordinates
        field = self.path("field.fits")
        self.assertCode(shearctl("extract", *options, "-o", field, "--quiet"), DONE)
        self.assertSameBits(result, self.measure(field))
        for more in (["--noise", "white"], ["--noise-stamps", 4], ["--psf", path_of("psfex/ntt_sextractor_default.psf")]):
            self.assertGreater(self.measure(*options, *more)[0]["n_used"], 400)

    def test_simulation(self):
        """A compressed image of integers with everything, sheared by (0.03, -0.02); all catalogs and models of it."""
        options = ["--image", path_of("run/sim_sci_int16.fits.fz"), "--weight", path_of("run/sim_wht.fits.gz"), "--mask",
                   path_of("run/sim_flg.fits.gz"), "--select", "FLAGS < 4 && FLUX_RADIUS > 2.6", "--stamp", 48]
        results = {}
        for sources in ("FITS_1.0", "ASCII_HEAD"):
            results[sources] = self.measure(*options, "--sources", path_of(f"ldac/sim_{sources}.cat"), "--psf",
                                            path_of("psfex/sim_ldac.psf"))
        for name in ("n_stamps", "n_used", "flags"):
            self.assertEqual(results["FITS_1.0"][0][name], results["ASCII_HEAD"][0][name])
        models = {name: self.measure(*options, "--sources", path_of("ldac/sim_FITS_1.0.cat"), "--psf",
                                     path_of(f"psfex/sim_ldac{name}.psf")) for name in ("_s05", "_mag", "_const", "_gl")}
        for name, (answer, rows) in {**results, **models}.items():
            with self.subTest(name):
                best = answer["estimators"]["pdf-sym"]
                self.assertGreater(answer["n_used"], 300)
                self.assertLess(abs(best["g1"] - 0.03), 3.5 * best["g1_err"])
                self.assertLess(abs(best["g2"] + 0.02), 3.5 * best["g2_err"])
                for flag in ("edge", "hole", "saturated", "neighbour"):
                    self.assertGreater(answer["flags"][flag], 0)
                self.assertLess(max(abs(g) for g in rows["GF1"]), 0.01)

    def test_planes_of_hsc(self):
        """Its own mask and variance are found, by EXTTYPE and by the planes' names; DETECTED is no defect."""
        name = path_of("exposures/HSC-0908120-056-small.fits")
        options = ["--image", name + ":1", "--sources", self.grid(7, 28.0, 24.0), "--psf", self.psf, "--stamp", 24]
        alone = self.extract("--image", name, *options[2:])
        named = self.extract(*options, "--mask", name + ":2", "--weight", name + ":3", "--weight-kind", "variance")
        for column, values in alone.items():
            self.assertEqual(list(map(repr, values)), list(map(repr, named[column])), column)
        every = self.extract(*options, "--mask", name + ":2", "--mask-bad", "any")
        self.assertLess(sum(f & FLAG["hole"] != 0 for f in alone["DROPPED"]), 5)
        self.assertGreater(sum(f & FLAG["hole"] != 0 for f in every["DROPPED"]), 5)

    @unittest.skipUnless(SEXTRACTOR, "needs source-extractor")
    def test_decam(self):
        """Image, inverse variances, codes and PSF of one chip of a real exposure."""
        name = path_of("exposures/c4d_170916_045042_{}_r_ls9.N15.fits").format
        write(self.path("columns"), b"NUMBER X_IMAGE Y_IMAGE FLAGS FLUX_RADIUS".replace(b" ", b"\n"))
        subprocess.run([SEXTRACTOR, name("ooi"), "-c", "/dev/null", "-CATALOG_TYPE", "FITS_LDAC", "-CATALOG_NAME", "ooi.cat",
                        "-PARAMETERS_NAME", "columns", "-FILTER", "N", "-DETECT_THRESH", "1.5", "-VERBOSE_TYPE", "QUIET",
                        "-CHECKIMAGE_TYPE", "SEGMENTATION", "-CHECKIMAGE_NAME", "seg.fits"],
                       cwd=self.directory, check=True, timeout=600)
        options = ["--image", name("ooi"), "--weight", name("oow"), "--mask", name("ood"), "--segmentation",
                   self.path("seg.fits"), "--select", "X >= 0", "--stamp", 16, "--psf",
                   path_of("psfex/c4d_170916_045042_ooi_r_ls9-N15-psfex.fits")]
        found = self.extract(*options, "--sources", self.path("ooi.cat"), "--select", "FLAGS < 8")
        self.assertGreater(len(found["X"]), 3)  # crowded in the middle, or at the edge
        places = self.extract(*options, "--sources", self.grid(4, 26.0, 16.0))
        self.assertGreater(sum(f == 0 for f in places["DROPPED"]), 3)
        for rows in (found, places):
            self.assertFalse(any(f & ~(FLAG["edge"] | FLAG["neighbour"]) for f in rows["DROPPED"]))
            self.assertLess(max(map(abs, rows["GF1"])), 0.02)

    def test_compressed_and_small(self):
        """Mosaic-3, tile-compressed; and 90prime with a model that has lost most of its keywords."""
        k4m = path_of("exposures/k4m_160319_075112_{}_zd_ls9.CCD3.fits").format
        ksb = path_of("exposures/ksb_160203_115029_{}_r_v1-ccd2.fits").format
        for name, psf, n in ((k4m, self.psf, 8), (ksb, path_of("psfex/decam-5742149339-ccd2.fits"), 2)):
            rows = self.extract("--image", name("ooi"), "--weight", name("oow"), "--mask", name("ood"), "--sources",
                                self.grid(n, 25.0, 10.0), "--psf", psf, "--stamp", 12)
            self.assertFalse(any(f & (PSF_UNUSABLE | FLAG["no_position"]) for f in rows["DROPPED"]))
            self.assertEqual(len(rows["X"]), n * n)

    def piff(self, name):
        """Measure on an empty sky where the stars of a Piff file were. Return the median seeing that it gives, arcsec."""
        tables = [(n.lower(), hdu) for n, hdu in hdus(read(path_of("piff/" + name)))]
        stars = columns(dict(tables)["psf_stars"])
        ra, dec = (sum(stars[c]) / len(stars[c]) for c in ("ra", "dec"))
        side, scale = 1800, 0.7
        wcs = [("CTYPE1", "RA---TAN"), ("CTYPE2", "DEC--TAN"), ("CRVAL1", 15 * ra), ("CRVAL2", dec), ("CRPIX1", side / 2),
               ("CRPIX2", side / 2), ("CDELT1", -scale / 3600), ("CDELT2", scale / 3600)]
        sky = header([("SIMPLE", True), ("BITPIX", 8), ("NAXIS", 2), ("NAXIS1", side), ("NAXIS2", side), *wcs])
        write(self.path("sky.fits"), sky + pad(bytes((i * 7919 >> 3) & 15 for i in range(side * side))))
        sources = write(self.path("stars.cat"), primary() + table("STARS", [
            ("NUMBER", "J", list(range(len(stars["ra"])))), ("RA", "D", [15 * r for r in stars["ra"]]),
            ("DEC", "D", stars["dec"])]))
        options = ["--image", self.path("sky.fits"), "--sources", sources, "--psf", path_of("piff/" + name), "--stamp", 24]
        rows = self.extract(*options)
        self.assertFalse(any(f & (PSF_UNUSABLE | FLAG["no_position"]) for f in rows["DROPPED"]))
        answer = shearctl("measure", "--json", "--quiet", *options, "--beta", 3)
        return answer.json()[0]["resolved"]["r_psf_px"] * scale

    def test_piff(self):
        for name in ("D00240560_r_c01_r2362p01_piff.fits", "D00232418_i_c19_r5006p01_piff-model.fits"):
            self.assertTrue(0.25 < self.piff(name) < 0.6, name)

    def test_real_stars(self):
        """117 real stars of DECam, many of them with bad pixels, against PSFEx's model of them: they are noisy, and it is
        told."""
        stars = "ldac/DECam_00241238_01_psfcat_tb_maxmag_17.0_magcut_3.0_findstars.fits"
        nx, ny = 2046, 4094
        sky = header([("SIMPLE", True), ("BITPIX", 8), ("NAXIS", 2), ("NAXIS1", nx), ("NAXIS2", ny)])
        write(self.path("sky.fits"), sky + pad(bytes(range(256)) * (nx * ny // 256 + 1))[:nx * ny + -(nx * ny) % 2880])
        radii, warnings = [], []
        for psf in (stars, "psfex/DECam_00241238_01_psfcat.psf"):
            answer = shearctl("measure", "--json", "--quiet", "--image", self.path("sky.fits"), "--sources", path_of(stars),
                              "--psf", path_of(psf), "--frame", "pixel", "--stamp", 48, "--select", "FLAGS >= 0")
            radii.append(answer.json()[0]["resolved"]["r_psf_px"])
            warnings.append("the PSF is noisy" in " ".join(answer.json()[0]["warnings"]))
        self.assertEqual(warnings, [True, False])
        self.assertAlmostEqual(radii[0] / radii[1], 1.0, delta=0.04)


if __name__ == "__main__":
    unittest.main()
