# SPDX-License-Identifier: GPL-3.0-or-later
"""Stamps with cosmic rays, hot pixels and sentinels: left out by default, named by validate, with
the pixel's place in the catalog; and the result is that of the file without them."""
import struct
import unittest

from fitsfile import BLOCK, Field, hdus
from tool import ToolTest, shearctl

NX = 48


def rows_of(path):
    """FLAGS, ART_X, ART_Y of a catalog: its last three columns."""
    with open(path, "rb") as f:
        (table,) = [content for name, content in hdus(f.read()) if name == "SHEAR"]
    cards = [table[k:k + 80].decode("latin-1") for k in range(0, len(table), 80)]
    keys = {c[:8].strip(): c[10:30].strip() for c in cards[:cards.index(f"{'END':80}")]}
    width, n = int(keys["NAXIS1"]), int(keys["NAXIS2"])
    start = -(-80 * (cards.index(f"{'END':80}") + 1) // BLOCK) * BLOCK
    return [struct.unpack(">3i", table[start + i * width - 12:start + i * width])
            for i in range(1, n + 1)]


class Artefacts(ToolTest):
    def spoil(self, field):
        """Stamps 1, 3, 5 and 7."""
        field.galaxy[1][10 * NX + 20] += 45.0
        for k in range(3):
            field.galaxy[3][(30 + k) * NX + 8 + k] += 42.0
        field.galaxy[5][24 * NX + 20] = -9999.0
        field.noise[7][5 * NX + 40] += 200.0

    def test_as_if_they_were_not_there(self):
        spoiled, masked = Field(n=12, sigma=1.0), Field(n=12, sigma=1.0)
        self.spoil(spoiled)
        masked.columns = [("FLAGS", "J", [i % 2 if i < 8 else 0 for i in range(12)])]
        path = spoiled.write(self.path("a.fits"))
        out = self.path("out.fits")
        result = self.measure_one(path, "--catalog", out)
        without = self.measure_one(masked.write(self.path("b.fits")))
        self.assertEqual((result["flags"]["artefact"], result["flags"]["noise_artefact"]), (3, 1))
        self.assertEqual(result["n_used"], 8)
        for key in ("g1", "g2", "g1_err", "g2_err", "cov12"):
            self.assertEqual(result[key], without[key])
        rows = rows_of(out)
        self.assertEqual([row[0] for row in rows], [0, 256, 0, 256, 0, 256, 0, 512, 0, 0, 0, 0])
        self.assertEqual(rows[1][1:], (21, 11))
        self.assertIn(rows[3][1:], ((9, 31), (10, 32), (11, 33)))
        self.assertEqual(rows[5][1:], (21, 25))
        self.assertEqual(rows[7][1:], (41, 6))
        self.assertTrue(all(row[1:] == (0, 0) for row in rows if row[0] == 0))
        self.assertIn("3 artefact, 1 noise_artefact", shearctl("measure", path).out)

    def test_validate_names_them(self):
        field = Field(n=12, sigma=1.0)
        self.spoil(field)
        path = field.write(self.path("a.fits"))
        (verdict,) = shearctl("validate", "--json", path).json()
        self.assertTrue(verdict["good"])
        self.assertEqual(verdict["flags"]["artefact"], {"count": 3, "first": [1, 3, 5]})
        self.assertEqual(verdict["flags"]["noise_artefact"], {"count": 1, "first": [7]})
        self.assertEqual(verdict["n_measurable"], 8)
        self.assertGreater(verdict["lowest_pixel"], -100.0)
        words = shearctl("validate", path).out
        self.assertIn("3 artefact", words)
        self.assertIn("stamps 1, 3, 5", words)

    def test_keep(self):
        field = Field(n=12, sigma=1.0)
        self.spoil(field)
        (kept,) = shearctl("measure", "--json", field.write(self.path("a.fits")), "--artefacts",
                           "keep").json()
        self.assertEqual(kept["n_used"], 12)
        self.assertEqual(kept["settings"]["artefacts"], "keep")
        self.assertFalse(kept["g1"] is not None and abs(kept["g1"] - 0.03) < 0.02)

    def test_bad_value(self):
        for value, bitpix in ((-9999, -32), (-1e30, -32), (-1e30, -64)):
            field = Field(n=8, sigma=1.0)
            field.bitpix = bitpix
            field.galaxy[2][100] = field.noise[4][7] = float(value)
            path = field.write(self.path("a.fits"))
            result = self.measure_one(path, "--bad-value", value, "--artefacts", "keep")
            self.assertEqual((result["flags"]["galaxy_not_finite"],
                              result["flags"]["noise_not_finite"], result["n_used"]), (1, 1, 6))
            self.assertEqual(result["settings"]["bad-value"], value)
            (verdict,) = shearctl("validate", "--json", path, "--bad-value", value).json()
            self.assertEqual(verdict["n_measurable"], 6)
            self.assertGreater(verdict["lowest_pixel"], -100.0)
        self.assertEqual(self.measure_one(path)["settings"]["bad-value"], "none")

    def test_sentinels_under_a_logarithm(self):
        field = Field(n=8, sigma=1.0)
        for stamps in (field.galaxy, field.noise):
            stamps[:] = [[p + 100.0 for p in stamp] for stamp in stamps]
        field.galaxy[2][100] = -9999.0
        result = self.measure_one(field.write(self.path("a.fits")), "--interpolation", "log-bicubic",
                                  "--oversample", 2)
        self.assertEqual((result["flags"]["artefact"], result["n_used"]), (1, 7))


if __name__ == "__main__":
    unittest.main()
