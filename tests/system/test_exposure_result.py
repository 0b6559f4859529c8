# SPDX-License-Identifier: GPL-3.0-or-later
"""What the result catalog of an exposure says of its numbers."""
import unittest

from exposures import ExposureTest, columns, keywords, read
from fitsfile import hdus


class Result(ExposureTest):
    def result(self, frame):
        self.measure(*self.options(), "--frame", frame)
        hdu = hdus(read(self.path("result.shear.fits")))[-1][1]
        keys = keywords(hdu)[0]
        names = [keys[f"TTYPE{i}"] for i in range(1, int(keys["TFIELDS"]) + 1)]
        return keys, {name: keys.get(f"TUNIT{i + 1}") for i, name in enumerate(names)}, columns(hdu)

    def test_units_are_those_of_the_frame(self):
        """And D is what its comment says, with the beta of that unit."""
        self.draw()
        for frame, area, beta in (("sky", "arcsec**-2", "BETA_SKY"), ("sky-east", "arcsec**-2", "BETA_SKY"),
                                  ("pixel", "pixel**-2", "BETA")):
            keys, units, rows = self.result(frame)
            self.assertEqual([units[name] for name in ("U", "V", "M4", "X", "RA")], [area] * 3 + ["pixel", "deg"])
            used = [i for i, flags in enumerate(rows["FLAGS"]) if flags == 0]
            self.assertGreater(len(used), 20)
            for i in used:
                d = rows["M20"][i] + rows["M02"][i] - 0.5 * float(keys[beta]) ** 2 * rows["M4"][i]
                self.assertAlmostEqual(d / rows["D"][i], 1.0, delta=1e-9)


if __name__ == "__main__":
    unittest.main()
