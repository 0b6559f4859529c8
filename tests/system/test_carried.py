# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of the input's catalog that are carried to results: the same bytes, with the keywords that they need."""
import struct
import unittest

from exposures import SIZES, ExposureTest, cards_of, images, keywords, ldac, read, write
from fitsfile import Field, hdus, header, pad, primary, table
from tool import DONE, INPUT, USAGE, ToolTest, shearctl

N = 20
#  name, form, further keywords, a cell
COLUMNS = [("ID", "J", {}, lambda i: struct.pack(">i", i + 7)),
           ("ZBIN", "I", {"TNULL": -1}, lambda i: struct.pack(">h", i % 5 - 1)),
           ("MAG", "E", {"TUNIT": "mag"}, lambda i: struct.pack(">f", 20 + i / 7)),
           ("WEIGHT", "D", {}, lambda i: struct.pack(">d", 1.0)),
           ("SNR", "D", {}, lambda i: struct.pack(">d", i / 3)),
           ("NAME", "12A", {}, lambda i: f"galaxy {i}".ljust(12).encode()),
           ("HALF", "I", {"TSCAL": 0.5, "TZERO": 3.25, "TNULL": 9}, lambda i: struct.pack(">h", i)),
           ("COUNT", "K", {"TZERO": 9223372036854775808}, lambda i: struct.pack(">q", -i)),
           ("GOOD", "L", {}, lambda i: b"TF"[i % 2:i % 2 + 1]),
           ("BITS", "11X", {}, lambda i: bytes([i, 32 * (i % 8)])),
           ("APER", "4E", {}, lambda i: struct.pack(">4f", i, float("nan"), 0.1, -i)),
           ("IMAGE", "65B", {}, lambda i: bytes(65)),
           ("LIST", "1PE(3)", {}, lambda i: struct.pack(">ii", 0, 0)),
           ("zbin", "J", {}, lambda i: struct.pack(">i", 5)),
           (None, "J", {}, lambda i: struct.pack(">i", 6))]
CARRIED = {"ZBIN": "ZBIN", "MAG": "MAG", "CAT_SNR": "SNR", "NAME": "NAME", "HALF": "HALF", "COUNT": "COUNT", "GOOD": "GOOD",
           "BITS": "BITS", "APER": "APER"}


def any_table(name, columns, n=N):
    """A BINTABLE of such columns."""
    rows = b"".join(b"".join(cell(i) for *_, cell in columns) for i in range(n))
    cards = [("XTENSION", "BINTABLE"), ("BITPIX", 8), ("NAXIS", 2), ("NAXIS1", len(rows) // n), ("NAXIS2", n), ("PCOUNT", 0),
             ("GCOUNT", 1), ("TFIELDS", len(columns)), ("EXTNAME", name)]
    for i, (key, form, more, _) in enumerate(columns, 1):
        cards += ([(f"TTYPE{i}", key)] if key else []) + [(f"TFORM{i}", form)] + [(k + str(i), v) for k, v in more.items()]
    return header(cards) + pad(rows)


def cells(hdu):
    """The cells of each column of a table as bytes, and its further keywords."""
    keys, begin = keywords(hdu)
    width, found, offset = int(keys["NAXIS1"]), {}, 0
    for i in range(1, int(keys["TFIELDS"]) + 1):
        form = keys[f"TFORM{i}"]
        kind = form.lstrip("0123456789")[0]
        count = int(form[:form.index(kind)] or 1)
        size = 8 if kind == "P" else (count + 7) // 8 if kind == "X" else count * SIZES[kind]
        more = {key: keys[key + str(i)] for key in ("TUNIT", "TNULL", "TSCAL", "TZERO") if key + str(i) in keys}
        more = {key: value if key == "TUNIT" else float(value) for key, value in more.items() if value != ""}
        found.setdefault(keys.get(f"TTYPE{i}"), (
            [hdu[begin + row * width + offset:][:size] for row in range(int(keys["NAXIS2"]))], more))
        offset += size
    return found


class Fields(ToolTest):
    def setUp(self):
        super().setUp()
        self.input = self.path("field.fits")
        write(self.input, Field(n=N).content() + any_table("CATALOG", COLUMNS))
        self.given = cells(hdus(read(self.input))[-1][1])

    def result(self, path):
        out = self.path("out.fits")
        self.assertCode(shearctl("measure", path, "--catalog", out, "--force", "--quiet"), DONE)
        return cells(hdus(read(out))[-1][1])

    def test_cells_and_keywords(self):
        result = self.result(self.input)
        self.assertEqual(list(result)[-len(CARRIED):], list(CARRIED))
        for name, source in CARRIED.items():
            self.assertEqual(result[name], self.given[source], name)
        self.assertNotEqual(result["SNR"], self.given["SNR"])

    def test_a_table_of_one_kind_of_column_only(self):
        path = write(self.path("one.fits"), Field(n=N).content() + any_table("CATALOG", COLUMNS[5:6]))
        self.assertEqual(self.result(path)["NAME"], self.given["NAME"])

    def test_names_that_are_alike(self):
        """The first of them counts, even where it cannot be carried itself."""
        columns = [("BIG", "65A", {}, lambda i: 65 * b"x"), ("big", "J", {}, lambda i: struct.pack(">i", i)), COLUMNS[5]]
        path = write(self.path("alike.fits"), Field(n=N).content() + any_table("CATALOG", columns))
        result = self.result(path)
        self.assertEqual(result["NAME"], self.given["NAME"])
        self.assertNotIn("big", result)

    def test_extreme_numbers_of_keywords(self):
        columns = [("LEAST", "K", {"TNULL": -2 ** 63}, lambda i: struct.pack(">q", i - 2 ** 63)),
                   ("LOW", "K", {"TZERO": -2 ** 63}, lambda i: struct.pack(">q", i)),
                   ("ODD", "K", {"TZERO": 2 ** 63 - 1}, lambda i: struct.pack(">q", -i)),
                   ("HUGE", "D", {"TSCAL": 1e-300, "TZERO": -1e300}, lambda i: struct.pack(">d", i)),
                   ("TINY", "E", {"TSCAL": 5e-324, "TZERO": 1.2345678901234567e-308}, lambda i: struct.pack(">f", i))]
        path = write(self.path("extreme.fits"), Field(n=N).content() + any_table("CATALOG", columns))
        out = self.path("out.fits")
        result = self.result(path)
        for name, given in cells(hdus(read(path))[-1][1]).items():
            self.assertEqual(result[name], given, name)
        keys, _ = keywords(hdus(read(out))[-1][1])
        numbers = {value for key, value in keys.items() if key.startswith(("TNULL", "TZERO"))}
        self.assertLessEqual({str(-2 ** 63), str(2 ** 63 - 1)}, numbers)  # to the last digit

    def test_a_thousand_columns(self):
        """What has room is carried: 900 columns."""
        columns = [(f"C{k}", "J", {}, lambda i, k=k: struct.pack(">i", 1000 * i + k)) for k in range(999)]
        path = write(self.path("wide.fits"), Field(n=N).content() + any_table("CATALOG", columns))
        result, given = self.result(path), cells(hdus(read(path))[-1][1])
        self.assertEqual([name for name in result if name in given], [f"C{k}" for k in range(900)])
        self.assertEqual(result["C899"], given["C899"])


class Exposures(ExposureTest):
    def setUp(self):
        super().setUp()
        self.draw()
        self.numbers = self.truth()["NUMBER"]
        more = [("ZBIN", "I", {}, lambda i: struct.pack(">h", i % 3)),
                ("FLAGS", "I", {}, lambda i: struct.pack(">h", i % 2)),
                ("MAG_APER", "3E", {"TUNIT": "mag"}, lambda i: struct.pack(">3f", i, i, i)), COLUMNS[-3]]
        self.extend(more)

    def extend(self, more):
        """Add columns to the catalog."""
        path = self.path("exp.cat")
        _, hdu = hdus(read(path))[-1]
        rows = cells(hdu)
        columns = [(name, "J" if name == "NUMBER" else "D", {}, lambda i, name=name: rows[name][0][i]) for name in rows]
        write(path, primary() + any_table("SOURCES", columns + more, len(self.numbers)))
        self.given = cells(hdus(read(path))[-1][1])

    def cells_of(self, path):
        return cells(hdus(read(path))[-1][1] if path.endswith("shear.fits") else
                     dict(hdus(read(path)))["CATALOG"])

    def assertCarried(self, path, *names, least=50):
        """These columns are in the result, each cell in its galaxy's row."""
        result = self.cells_of(path)
        at = {cell: i for i, cell in enumerate(self.given["NUMBER"][0])}
        rows = [at[struct.pack(">i", struct.unpack(">q", cell)[0])] for cell in result["ID"][0]]
        self.assertGreater(len(rows), least)
        for name in names:
            wanted, keys = self.given[name.removeprefix("CAT_")]
            self.assertEqual(result[name], ([wanted[i] for i in rows], keys), name)
        return result

    def test_all(self):
        self.measure(*self.options())
        result = self.assertCarried(self.path("result.shear.fits"), "NUMBER", "ZBIN", "CAT_FLAGS", "MAG_APER", "A_IMAGE",
                                    "CAT_RA")
        self.assertNotIn("LIST", result)

    def test_of_a_selection(self):
        """The rows are the galaxies', not the first of the table."""
        self.measure(*self.options(select="NUMBER % 3 == 1", carry="NUMBER,ZBIN"))
        result = self.assertCarried(self.path("result.shear.fits"), "NUMBER", "ZBIN", least=20)
        self.assertEqual({struct.unpack(">i", cell)[0] % 3 for cell in result["NUMBER"][0]}, {1})

    def test_extracted(self):
        whole = self.measure(*self.options())
        self.assertCode(shearctl("extract", *self.options(), "-o", self.path("x.fits"), "--quiet"), DONE)
        self.assertCarried(self.path("x.fits"), "NUMBER", "ZBIN", "CAT_FLAGS", "MAG_APER")
        self.measure(self.path("x.fits"), keep="again")
        self.assertEqual(self.cells_of(self.path("again.shear.fits")), self.cells_of(self.path("result.shear.fits")))
        self.assertSameBits(self.measure(self.path("x.fits")), whole)

    def test_chosen(self):
        self.measure(*self.options(carry="none"))
        bare = self.cells_of(self.path("result.shear.fits"))
        self.measure(*self.options(carry="mag_aper,ZBIN"))
        result = self.assertCarried(self.path("result.shear.fits"), "MAG_APER", "ZBIN")
        self.assertEqual(list(result), [*bare, "MAG_APER", "ZBIN"])

    def test_refused(self):
        for carry, said in (("ZBINS", "no column ZBINS to be carried"), ("LIST", "has a variable length"),
                            ("ZBIN,NOPE", "no column NOPE")):
            answer = shearctl("measure", *self.options(carry=carry))
            self.assertCode(answer, INPUT)
            self.assertIn(said, answer.err)
        self.assertFails(shearctl("measure", *self.options(carry="")), USAGE, "--carry is empty", "leave it out")

    def test_names_that_are_cut_off(self):
        """A text has names that are longer than a card: no two columns of results have one name."""
        names = ["NUMBER", "ALPHA_J2000", "DELTA_J2000", "A_IMAGE", "B_IMAGE", "THETA_IMAGE", 68 * "Q" + "1", 68 * "Q" + "2"]
        truth = self.truth()
        text = "".join(f"# {i} {name} one\n" for i, name in enumerate(names, 1))
        for row in zip(*(truth[key] for key in ("NUMBER", "RA", "DEC"))):
            text += "{} {} {} 3 3 0 7 8\n".format(*row)
        self.measure(*self.options(sources=write(self.path("long.cat"), text.encode())))
        keys, _ = keywords(hdus(read(self.path("result.shear.fits")))[-1][1])
        self.assertEqual([value for key, value in keys.items() if key.startswith("TTYPE")].count(68 * "Q"), 1)

    def test_scaling_that_is_none(self):
        self.draw()
        self.extend([("WRONG", "I", {"TSCAL": 0}, lambda i: struct.pack(">h", i))])
        self.measure(*self.options())
        self.assertNotIn("WRONG", self.cells_of(self.path("result.shear.fits")))
        self.assertFails(shearctl("measure", *self.options(carry="WRONG")), INPUT,
                         "column WRONG cannot be carried: its keyword TSCALn, TZEROn or TNULLn (TSCALn) is 0")

    def test_two_of_one_name_in_results(self):
        self.draw()
        self.extend([("CAT_RA", "I", {}, lambda i: struct.pack(">h", i))])
        self.measure(*self.options(carry="CAT_RA,cat_ra,NUMBER"))
        self.assertEqual(list(self.cells_of(self.path("result.shear.fits")))[-2:], ["CAT_RA", "NUMBER"])
        answer = shearctl("measure", *self.options(carry="RA,CAT_RA"))
        self.assertCode(answer, INPUT)
        self.assertIn("column CAT_RA cannot be carried: it would be called like another one in results", answer.err)

    def test_numbers_that_mean_something_else(self):
        """Of a table for each chip: cells of another unit, scale or undefined number are not those of the first table."""
        chips, truth, content = images(self.path("exp.fits")), self.truth(), primary()
        odd = [[{}, {"TNULL": 3}, {"TSCAL": 2.0}, {"TZERO": 32768}, {"TUNIT": "mag"}], 5 * [{}]]
        for k in (1, 2):
            rows = [(n, x, y) for n, c, x, y in zip(*(truth[key] for key in ("NUMBER", "CHIP", "X", "Y"))) if c == k]
            number = lambda i, rows=rows: struct.pack(">i", rows[i][0])
            more = [(f"C{j}", "I", keys, lambda i: struct.pack(">h", i)) for j, keys in enumerate(odd[k - 1])]
            columns = [("NUMBER", "J", {}, number), ("X_IMAGE", "D", {}, lambda i, rows=rows: struct.pack(">d", rows[i][1])),
                       ("Y_IMAGE", "D", {}, lambda i, rows=rows: struct.pack(">d", rows[i][2]))]
            columns += [(name, form, {}, lambda i, values=values: struct.pack(">d", values[i]))
                        for name, form, values in self.ellipses(len(rows))]
            header_cells = ldac([(chips[k - 1], [("NUMBER", "J", [0])])])
            content += b"".join(hdu for name, hdu in hdus(header_cells) if name == "LDAC_IMHEAD")
            content += any_table("LDAC_OBJECTS", columns + more, len(rows))
        path = write(self.path("odd.ldac"), content)
        self.measure(*self.options(sources=path))
        result = self.cells_of(self.path("result.shear.fits"))
        self.assertEqual([name for name in result if name.startswith("C") and name[1:].isdigit()], ["C0"])
        answer = shearctl("measure", *self.options(sources=path, carry="C3"))
        self.assertCode(answer, INPUT)
        self.assertIn("with the same TNULL, TSCAL and TZERO", answer.err)

    def test_tables_that_differ(self):
        """Of a table for each chip: what all of them have."""
        chips = images(self.path("exp.fits"))
        truth = self.truth()
        tables = []
        for k, chip in enumerate(chips, 1):
            rows = [(n, x, y) for n, c, x, y in zip(*(truth[key] for key in ("NUMBER", "CHIP", "X", "Y"))) if c == k]
            n, x, y = map(list, zip(*rows))
            odd = ("ONLY_1", "J", n) if k == 1 else ("ONLY_2", "J", n)
            same = ("SAME", "J", n) if k == 1 else ("same", "J", n)
            kind = ("KIND", "J" if k == 1 else "D", n)
            tables.append((chip, [odd, ("NUMBER", "J", n), ("X_IMAGE", "D", x), kind, ("Y_IMAGE", "D", y), same,
                                  *self.ellipses(len(n))]))
        path = write(self.path("exp.ldac"), ldac(tables))
        self.measure(*self.options(sources=path))
        result = self.cells_of(self.path("result.shear.fits"))
        self.assertEqual([name for name in result if name in ("ONLY_1", "ONLY_2", "KIND", "SAME")], ["SAME"])
        self.assertEqual([struct.unpack(">i", c) for c in result["SAME"][0]],
                         [(struct.unpack(">q", c)[0],) for c in result["ID"][0]])
        answer = shearctl("measure", *self.options(sources=path, carry="ONLY_1"))
        self.assertCode(answer, INPUT)
        self.assertIn("no column ONLY_1 of the form 1J", answer.err)


if __name__ == "__main__":
    unittest.main()
