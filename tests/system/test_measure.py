# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl measure on good files: numbers against closed forms, several files of a field, --json
and the table."""
import json
import math
import os
import re
import shutil
import unittest

from fitsfile import BLOCK, Field, hdus, primary, rotate
from tool import DONE, INPUT, PARTLY, USAGE, ToolTest, shearctl

KEYS = ["field", "g1", "g1_err", "g2", "g2_err", "cov12", "n_stamps", "n_used", "n_flagged",
        "flags", "settings", "resolved", "files", "estimator", "error_method", "jackknife", "truth", "pull",
        "delta_err", "no_shear", "noise_level", "influence", "resolution", "estimators", "filter_removed", "warnings",
        "version", "seconds"]
FLAGS = ["galaxy_not_finite", "noise_not_finite", "masked", "empty", "psf_unusable", "bad_weight",
         "bad_r_gal", "overflow", "artefact", "noise_artefact", "edge", "hole", "saturated",
         "neighbour", "no_noise", "no_position"]


def default_settings():
    """As config/sheard.conf documents them (a test of its own keeps it current), in JSON's types."""
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "config", "sheard.conf"),
              encoding="utf-8") as f:
        section = f.read().split("[measure]\n")[1]
    words = dict(re.findall(r"^#([a-z-]+) = (\S+)$", section, re.M))
    return {name: json.loads(word) if re.match(r"[-0-9]|true|false", word) else word for name, word in words.items()}


SETTINGS = default_settings()
RESOLVED = ["interpolation", "oversample", "beta_px", "r_psf_px", "filter", "core_px", "core_found", "width_px",
            "noise_band", "k_cut", "frame", "beta_sky"]


def content_of(path):
    with open(path, "rb") as f:
        return f.read()


def numbers(result):
    """What must not depend on how the work was divided, to the last bit (json keeps 17 digits)."""
    return [result[k] for k in ("g1", "g1_err", "g2", "g2_err", "cov12", "n_stamps", "n_used",
                                "filter_removed")]


class Numbers(ToolTest):
    def test_closed_form(self):
        for bitpix, tolerance in ((-64, 1e-7), (-32, 1e-6)):  # float pixels carry 6e-8 each
            field = Field(n=6)
            field.bitpix = bitpix
            result = self.measure_one(field.write(self.path("a.fits")))
            # The default beta is 2 times the measured radius, which is exact to interpolation.
            self.assertAlmostEqual(result["resolved"]["r_psf_px"], field.r_psf,
                                   delta=2e-3 * field.r_psf)
            self.assertAlmostEqual(result["resolved"]["beta_px"],
                                   2 * result["resolved"]["r_psf_px"], delta=1e-12)
            result = self.measure_one(self.path("a.fits"), "--beta", 1.5 * field.r_psf)
            g1, g2 = field.expected()
            self.assertAlmostEqual(result["g1"], g1, delta=tolerance)
            self.assertAlmostEqual(result["g2"], g2, delta=tolerance)
            # and the closed form itself is near the shear that was put in
            self.assertAlmostEqual(g1, 0.03, delta=1e-3)

    def test_rotated_galaxies_flip_both_signs(self):
        field = Field(n=6, sigma=0.1)
        before = self.measure_one(field.write(self.path("a.fits")))
        field.galaxy = [rotate(s, field.nx) for s in field.galaxy]
        field.noise = [rotate(s, field.nx) for s in field.noise]
        after = self.measure_one(field.write(self.path("b.fits")))
        self.assertGreater(abs(before["g1"]), 0.02)
        self.assertGreater(abs(before["g2"]), 0.01)
        for g in ("g1", "g2"):
            self.assertAlmostEqual(after[g], -before[g], delta=1e-12)
        self.assertAlmostEqual(after["cov12"], before["cov12"],
                               delta=1e-6 * before["g1_err"] * before["g2_err"])

    def test_threads_do_not_matter(self):
        path = Field(n=50, nx=32, ny=32, sigma=0.3, size=2.0).write(self.path("a.fits"))
        results = [self.measure_one(path, "--threads", n) for n in (1, 2, 7)]
        self.assertEqual(numbers(results[0]), numbers(results[1]))
        self.assertEqual(numbers(results[0]), numbers(results[2]))

    def test_jackknife(self):
        path = Field(n=64, nx=24, ny=24, sigma=0.5, size=2.0, r_psf=1.2).write(self.path("a.fits"))
        delta = self.measure_one(path)
        jackknife = self.measure_one(path, "--jackknife", 4)
        self.assertEqual((delta["error_method"], delta["jackknife"]), ("delta", None))
        self.assertEqual((jackknife["error_method"], jackknife["jackknife"]), ("jackknife", 4))
        self.assertEqual((delta["g1"], delta["g2"]), (jackknife["g1"], jackknife["g2"]))
        # An error from four groups is uncertain by 1/sqrt(6): factors beyond 3 mean another thing.
        for error in ("g1_err", "g2_err"):
            self.assertNotEqual(delta[error], jackknife[error])
            self.assertLess(abs(math.log(jackknife[error] / delta[error])), math.log(3))
        self.assertFails(shearctl("measure", path, "--jackknife", 5), USAGE, "4 blocks")

    def test_errors_that_disagree(self):
        """Two galaxies at right angles: blocks hold whole pairs, whose shapes cancel."""
        field = Field(n=160, nx=24, ny=24, sigma=0.01, size=2.0, r_psf=1.2, g1=0.2)
        for i in range(1, field.n, 2):
            field.galaxy[i] = rotate(field.galaxy[i - 1], field.nx)
        path = field.write(self.path("a.fits"))
        self.assertIsNone(self.measure_one(path)["delta_err"])
        jackknife = self.measure_one(path, "--jackknife", 10)
        self.assertEqual(jackknife["delta_err"]["g1"], self.measure_one(path)["g1_err"])
        self.assertLess(jackknife["g1_err"], jackknife["delta_err"]["g1"] / 4)
        self.assertIn("rotated copies", jackknife["warnings"][0])

    def test_flags_are_counted_by_name(self):
        field = Field(n=8)
        field.galaxy[1][5] = math.nan
        field.noise[2][7] = math.inf
        field.galaxy[3] = [1.0] * len(field.galaxy[3])
        field.columns = [("FLAGS", "J", [0, 0, 0, 0, 1, 0, 0, 0]),
                         ("WEIGHT", "D", [1.0, 1.0, 1.0, 1.0, 1.0, -1.0, 2.0, 1.0])]
        result = self.measure_one(field.write(self.path("a.fits")), "--beta", 1.5 * field.r_psf)
        self.assertEqual(result["flags"],
                         {**dict.fromkeys(FLAGS, 0), "galaxy_not_finite": 1, "noise_not_finite": 1,
                                           "empty": 1, "masked": 1, "bad_weight": 1})
        self.assertEqual((result["n_stamps"], result["n_used"], result["n_flagged"]), (8, 3, 5))
        self.assertAlmostEqual(result["g1"], field.expected()[0], delta=1e-6)
        table = shearctl("measure", self.path("a.fits")).out
        self.assertIn("3 of 8 used (1 galaxy_not_finite, 1 noise_not_finite, 1 masked, 1 empty, "
                      "1 bad_weight)", table)

    def test_no_usable_stamp(self):
        field = Field(n=3)
        field.columns = [("FLAGS", "J", [1, 1, 1])]
        answer = shearctl("measure", "--json", field.write(self.path("a.fits")))
        self.assertFails(answer, INPUT, "0 of 3 stamps")
        result = answer.json()[0]
        for key in ("g1", "g1_err", "g2", "g2_err", "cov12"):
            self.assertIsNone(result[key])
        self.assertEqual(result["flags"]["masked"], 3)
        self.assertIn("not measured", shearctl("measure", self.path("a.fits")).out)


class Report(ToolTest):
    def test_json_keys_and_types(self):
        path = Field(n=6, sigma=0.05).write(self.path("a.fits"))
        result = self.measure_one(path)
        self.assertEqual(list(result), KEYS)
        self.assertEqual(list(result["flags"]), FLAGS)
        self.assertEqual(result["settings"], SETTINGS)
        self.assertEqual(list(result["resolved"]), RESOLVED)
        self.assertEqual(result["field"], "gauss")
        self.assertEqual((result["resolved"]["interpolation"], result["resolved"]["filter"]),
                         ("none", "none"))
        self.assertIsNone(result["resolved"]["core_px"])
        self.assertEqual(result["truth"], {"g1": 0.03, "g2": -0.02})
        for g in ("g1", "g2"):
            pull = (result[g] - result["truth"][g]) / result[g + "_err"]
            self.assertAlmostEqual(result["pull"][g], pull, delta=1e-12 * abs(pull))
        (file,) = result["files"]
        self.assertEqual((file["path"], file["field"], file["n_stamps"], file["n_used"]),
                         (path, "gauss", 6, 6))
        self.assertRegex(file["checksum"], r"^[0-9a-f]{32}$")
        self.assertEqual(file["resolved"], result["resolved"])
        self.assertEqual(result["warnings"], [])

    def test_no_truth(self):
        result = self.measure_one(Field(n=4, truth=False).write(self.path("a.fits")))
        self.assertIsNone(result["truth"])
        self.assertIsNone(result["pull"])

    def test_table(self):
        path = Field(n=6, sigma=0.05).write(self.path("a.fits"))
        answer = shearctl("measure", path)
        self.assertCode(answer, DONE)
        self.assertEqual(answer.err, "")  # not a terminal: no bar
        self.assertTrue(answer.out.startswith("field gauss\n"))
        self.assertRegex(answer.out,
                         r"(?m)^  g1 +\+0\.0\d+ \+- 0\.\d+ +truth \+0\.0300* +pull [+-]\d+\.\d\d$")
        self.assertRegex(answer.out,
                         r"(?m)^  g2 +-0\.0\d+ \+- 0\.\d+ +truth -0\.0200* +pull [+-]\d+\.\d\d$")
        self.assertIn("6 of 6 used", answer.out)
        self.assertIn("interpolation none, R_PSF 1.5", answer.out)
        self.assertIn("stamps/s", answer.out)

    def test_what_was_done(self):
        """One line for each: filter, background, artefacts, noise level, influence; the noise level's with the number of the
        warning."""
        def lines(field, *options):
            out = shearctl("measure", field.write(self.path("a.fits")), *options).out
            return dict(re.findall(r"(?m)^  (\S+) +(.*)$", out))
        field = Field(n=128, nx=64, ny=64, sigma=2.0)
        told = lines(field)
        self.assertRegex(told["filter"], r"^core [\d.]+ px \(found: it leaves the galaxies whole\), width 3\S* px$")
        self.assertEqual(told["background"], "the noise stamps' level is taken off both stamps")
        self.assertEqual(told["artefacts"], "none found")
        self.assertRegex(told["level"],
                         r"^noise [01]\.\d+ \+- 0\.0\d+ times the noise stamps' variance, measured beyond 3/4")
        self.assertRegex(told["influence"], r"^128 stamps count as 1[12]\d\.\d equal ones; stamp \d+ counts most, with ")
        field.galaxy[3][64 * 20 + 20] = -9999.0
        told = lines(field, "--core", 20, "--background", "keep", "--noise-level", "none")
        self.assertEqual(told["filter"].split(",")[0], "core 20 px (given)")
        self.assertEqual(told["background"], "kept: it ends at the filter's edge")
        self.assertEqual(told["artefacts"], "1 stamp with a pixel that no sky can produce: left out")
        self.assertEqual(told["level"], "noise assumed to be that of the noise stamps, as requested")
        told = lines(Field(n=20), "--artefacts", "keep")
        self.assertRegex(told["filter"], r"^none \(no core .* too few stamps to tell\)$")
        self.assertRegex(told["artefacts"], "^not looked for")
        self.assertEqual(lines(Field(n=20), "--filter", "none")["filter"], "none")
        field = Field(n=20)
        field.columns = [("R_GAL", "D", [3.0] * field.n)]
        self.assertRegex(lines(field)["filter"], r"^core by each stamp's R_GAL, width")

    def test_file_name_that_is_not_utf8_and_steers_terminals(self):
        path = Field(n=4).write(self.path("x\x1b[31m\udcff.fits"))  # byte 0xff
        result = self.measure_one(path)
        self.assertEqual(result["files"][0]["path"], self.path("x\x1b[31m\ufffd.fits"))
        answer = shearctl("measure", path)
        self.assertCode(answer, DONE)
        self.assertIn("x?[31m", answer.out)
        self.assertNotIn("\x1b", answer.out)
        self.assertNotIn("\x1b", shearctl("measure", path + "\x1b").err)


class Files(ToolTest):
    def write_halves(self, whole):
        """The field cut into two files of 16 stamps."""
        parts = []
        for k, name in enumerate("ab"):
            part = Field(n=1, nx=24, ny=24, r_psf=1.2, name="gauss")
            part.n = 16
            part.galaxy, part.noise = whole.galaxy[16 * k:][:16], whole.noise[16 * k:][:16]
            part.keys = whole.keys
            parts.append(part.write(self.path(f"{name}.fits")))
        return parts

    def test_files_of_one_field_are_joined(self):
        whole = Field(n=32, nx=24, ny=24, sigma=0.2, size=2.0, r_psf=1.2)
        parts = self.write_halves(whole)
        one = self.measure_one(whole.write(self.path("whole.fits")))
        two = self.measure_one(*parts)
        self.assertEqual(numbers(one), numbers(two))
        self.assertEqual(numbers(one), numbers(self.measure_one(*reversed(parts))))
        self.assertEqual([f["n_stamps"] for f in two["files"]], [16, 16])
        self.assertIn("files      2", shearctl("measure", *parts).out)
        # The jackknife's groups follow the checksums, not the order of the arguments.
        there, back = (self.measure_one("--jackknife", 2, *order) for order in (parts, parts[::-1]))
        self.assertEqual(numbers(there), numbers(back))

    def test_the_core_is_found_from_the_galaxies(self):
        path = Field(n=96, sigma=0.05).write(self.path("a.fits"))
        found = self.measure_one(path)
        core = found["resolved"]["core_px"]
        self.assertEqual(found["resolved"]["filter"], "paper")
        self.assertEqual(4 * core, round(4 * core))
        self.assertGreater(core, 6)
        given = self.measure_one(path, "--core", core)
        self.assertEqual(numbers(found), numbers(given))
        self.assertEqual(numbers(found), numbers(self.measure_one(path, "--threads", 3)))
        none = self.measure_one(path, "--filter", "none")
        self.assertLess(abs(found["g1"] - none["g1"]), 2 * none["g1_err"])
        self.assertLess(found["g1_err"], none["g1_err"])
        for args in (("--filter", "none"), ("--filter", "r-gal"), ("--preset", "zhang2010")):
            self.assertEqual(self.measure_one(path, *args)["resolved"]["filter"], "none")

    def test_symmetry_of_any_order(self):
        symmetric = ("--estimator", "pdf-sym")
        whole = Field(n=32, nx=24, ny=24, sigma=0.2, size=2.0, r_psf=1.2)
        parts = self.write_halves(whole)
        path = whole.write(self.path("whole.fits"))
        one = self.measure_one(path, *symmetric)
        self.assertEqual((one["estimator"], one["error_method"], one["settings"]["estimator"]),
                         ("pdf-sym", "symmetry", "pdf-sym"))
        mean = self.measure_one(path)
        for g in ("g1", "g2"):
            self.assertNotEqual(one[g], mean[g])
            self.assertLess(abs(one[g] - mean[g]), 5 * (one[g + "_err"] + mean[g + "_err"]))
        for order in (parts, parts[::-1]):
            for threads in (1, 2, 5):
                result = self.measure_one("--threads", threads, *symmetric, *order)
                self.assertEqual(numbers(one), numbers(result))
        self.assertIn("estimator  pdf-sym", shearctl("measure", path, *symmetric).out)
        crossed = self.measure_one(path, "--estimator", "pdf-sym-cross")
        self.assertEqual((crossed["estimator"], crossed["error_method"]), ("pdf-sym-cross", "symmetry"))
        for g in ("g1", "g2"):
            self.assertNotEqual(one[g], crossed[g])
            self.assertLess(abs(one[g] - crossed[g]), one[g + "_err"] + crossed[g + "_err"])
        self.assertFails(shearctl("measure", path, "--estimator", "pdf-sym-cross", "--no-noise-correction"), USAGE,
                         "noise-correction")
        self.assertFails(shearctl("measure", path, *symmetric, "--jackknife", 2), USAGE,
                         "--estimator mean")

    def test_symmetry_over_a_background(self):
        """What galaxy and noise stamp share has no part in their cross terms."""
        path = self.path("bright.fits")
        self.assertEqual(shearctl("mock", path, "--size", 48, "--points", 60, "--r-gal", 4, "--stamps", 400,
                                  "--photons", 500, "--shear", "0.02,-0.03", "--rotate", 1).code, 0)
        result = self.measure_one(path, "--estimator", "pdf-sym-cross")
        for k, truth in (("g1", 0.02), ("g2", -0.03)):
            self.assertLess(abs(result[k] - truth), 5 * result[k + "_err"])

    def test_both_estimators_are_told(self):
        """From 200 used stamps on, for any --estimator, with the same numbers; also as text."""
        path = self.path("many.fits")
        self.assertEqual(shearctl("mock", path, "--size", 32, "--points", 30, "--r-gal", 4, "--stamps", 240, "--white", 0.3,
                                  "--shear", "0.02,-0.03", "--rotate", 1).code, 0)
        mean = self.measure_one(path, "--threads", 1)
        for kind in ("pdf-sym", "pdf-sym-cross"):
            chosen = self.measure_one(path, "--estimator", kind)
            both = chosen["estimators"]
            self.assertEqual(list(both), ["mean", kind])
            for g in ("g1", "g1_err", "g2", "g2_err", "cov12", "error_method"):
                self.assertEqual(both["mean"][g], mean[g])
                self.assertEqual(both[kind][g], chosen[g])
            if kind == "pdf-sym":
                self.assertEqual(both, mean["estimators"])
        out = shearctl("measure", path).out
        self.assertRegex(out, r"\n  mean +g1 \+0\.0\d+ \+- [^\n]*, g2 -0\.0[^\n]*\n  pdf-sym +g1 [^\n]*\n  precision +\S")
        self.assertIn("estimator  mean", out)
        first, second = (math.hypot(mean["estimators"][k]["g1_err"], mean["estimators"][k]["g2_err"])
                         for k in ("mean", "pdf-sym"))
        times = max(first / second, second / first)
        if times >= 1.05:
            self.assertIn(f"{times ** 2:.3g} times as many galaxies", out)
        else:
            self.assertIn("equally precise", out)
        few = Field(n=199, nx=16, ny=16).write(self.path("few.fits"))
        self.assertIsNone(self.measure_one(few)["estimators"])
        self.assertNotIn("precision", shearctl("measure", few).out)

    def test_weights_of_the_flux(self):
        field = Field(n=210, nx=24, ny=24, sigma=2.0)
        fluxes = [sum(stamp) for stamp in field.galaxy]
        for weights, warned in (([1 / f ** 2 for f in fluxes], True), ([1 + i % 7 for i in range(210)], False)):
            field.columns = [("WEIGHT", "D", weights)]
            result = self.measure_one(field.write(self.path(f"{warned}.fits")))
            self.assertEqual(any("WEIGHT follows" in w for w in result["warnings"]), warned)

    def test_symmetry_needs_16_stamps(self):
        path = Field(n=15).write(self.path("a.fits"))
        self.assertFails(shearctl("measure", path, "--estimator", "pdf-sym"), INPUT, "usable")

    def test_fields_in_order_of_first_appearance_and_override(self):
        paths = [Field(n=4, seed=k, name=name).write(self.path(f"{k}.fits"))
                 for k, name in enumerate(("beta", "alpha", "beta"))]
        answer = shearctl("measure", "--json", *paths)
        self.assertCode(answer, DONE)
        self.assertEqual([(r["field"], r["n_stamps"]) for r in answer.json()],
                         [("beta", 8), ("alpha", 4)])
        joined = self.measure_one("--field", "all of it", *paths)
        self.assertEqual((joined["field"], joined["n_stamps"]), ("all of it", 12))
        self.assertEqual([f["field"] for f in joined["files"]], ["beta", "alpha", "beta"])

    def test_field_without_a_name_is_called_after_its_file(self):
        path = Field(n=4, name=None).write(self.path("deep.fits"))
        self.assertEqual(self.measure_one(path)["field"], "deep")

    def test_truths_that_differ_are_no_truth(self):
        paths = [Field(n=4, g1=g).write(self.path(f"{g}.fits")) for g in (0.01, 0.02)]
        self.assertIsNone(self.measure_one(*paths)["truth"])

    def test_duplicates_count_once(self):
        first = Field(n=4).write(self.path("a.fits"))
        copy = shutil.copy(first, self.path("b.fits"))
        one = self.measure_one(first)
        answer = shearctl("measure", "--json", first, copy, first)
        self.assertCode(answer, DONE)
        (result,) = answer.json()
        self.assertEqual(numbers(result), numbers(one))
        self.assertEqual(len(result["files"]), 1)
        self.assertEqual(len(result["warnings"]), 2)
        self.assertIn("counted once", result["warnings"][0])
        self.assertEqual(len(re.findall(r"(?m)^shearctl: warning: .*counted once", answer.err)), 2)
        self.assertEqual(shearctl("measure", "--quiet", first, copy).err, "")

    def test_one_bad_among_good(self):
        good = Field(n=4, name="good").write(self.path("a.fits"))
        other = Field(n=4, name="other", seed=2).write(self.path("c.fits"))
        bad = self.path("b.fits")
        with open(bad, "w", encoding="ascii") as f:
            f.write("not FITS")
        answer = shearctl("measure", "--json", good, bad, other)
        self.assertFails(answer, PARTLY, "b.fits")
        self.assertEqual([r["field"] for r in answer.json()], ["good", "other"])
        self.assertFails(shearctl("measure", bad, bad), INPUT, "b.fits")

    def test_failure_while_measuring_leaves_the_rest_of_the_field(self):
        good = Field(n=4, name="f").write(self.path("a.fits"))
        bad = Field(n=4, name="f", seed=2)
        bad.psf = [-p for p in bad.psf]
        answer = shearctl("measure", "--json", good, bad.write(self.path("b.fits")))
        self.assertFails(answer, PARTLY, "b.fits", "PSF")
        (result,) = answer.json()
        self.assertEqual(numbers(result), numbers(self.measure_one(good)))
        self.assertIn("1 of 2 files failed", result["warnings"][0])


class Advice(ToolTest):
    def test_filter_that_takes_flux_away(self):
        path = Field(n=32, size=4.0, sigma=0.01).write(self.path("a.fits"))
        result = self.measure_one(path, "--core", 4, "--width", 2)
        self.assertGreater(result["filter_removed"], 0.05)
        self.assertEqual(len(result["warnings"]), 1)
        self.assertIn("--core", result["warnings"][0])
        self.assertEqual(self.measure_one(path)["warnings"], [])

    def test_neighbours_at_the_border(self):
        field = Field(n=32, sigma=0.05)
        for stamp in field.galaxy:
            for y in range(10, 16):
                stamp[y * field.nx] += 0.8  # together 0.6 % of the flux
        path = field.write(self.path("a.fits"))
        answer = shearctl("measure", "--json", path)
        warnings = answer.json()[0]["warnings"]
        self.assertTrue(any("brighter" in w for w in warnings), warnings)
        self.assertTrue(any("rougher" in w for w in warnings), warnings)
        self.assertTrue(any("neighbours lie on that side" in w for w in warnings), warnings)
        self.assertTrue(all("larger stamps" in w or "gradient" in w for w in warnings), warnings)
        self.assertFalse(any("--filter edge" in w for w in warnings), warnings)
        self.assertIn("shearctl: warning: field gauss: ", answer.err)
        self.assertEqual(self.measure_one(path, "--filter", "edge")["warnings"], [])


class Parts(ToolTest):
    """Galaxies, noise and PSF in separate files."""

    def cut(self, field):
        """The whole file, and options for its parts in files of their own."""
        whole, options = field.write(self.path("whole.fits")), []
        for name, content in hdus(content_of(whole))[1:]:
            path = self.path(f"{name}.fits")
            with open(path, "wb") as f:
                f.write(primary() + content)
            options += ["--catalog-in" if name == "CATALOG" else "--" + name.lower(), path]
        return whole, options

    def test_the_same_numbers(self):
        whole, options = self.cut(Field(n=20, sigma=0.2))
        parts = self.measure_one(*options)
        self.assertEqual(numbers(parts), numbers(self.measure_one(whole)))
        self.assertEqual(parts["field"], "GALAXY")  # of the galaxies' file
        self.assertEqual(self.measure_one(*options, "--jackknife", 2)["jackknife"], 2)

    def test_catalog(self):
        whole, options = self.cut(Field(n=20))
        os.mkdir(self.path("out"))
        self.measure_one(*options, "--catalog", self.path("out"))
        self.measure_one(whole, "--catalog", self.path("whole.cat"))
        rows = [content_of(self.path(name))[-BLOCK:]  # 20 rows of less than 144 bytes
                for name in ("out/GALAXY.shear.fits", "whole.cat")]
        self.assertEqual(*rows)
        for path in options[1::2]:  # no part is overwritten
            self.assertFails(shearctl("measure", *options, "--catalog", path, "--force"), USAGE,
                             "one of the input files")

    def test_another_catalog_for_a_field_file(self):
        field = Field(n=6, sigma=0.2)
        field.columns = [("WEIGHT", "D", [1.0] * 6)]
        whole = field.write(self.path("whole.fits"))
        own = self.measure_one(whole)
        field.columns = [("WEIGHT", "D", [1.0, 2.0, 1.0, 3.0, 1.0, 1.0]), ("FLAGS", "J", [0, 0, 1, 0, 0, 0])]
        other = field.write(self.path("other.fits"))
        result = self.measure_one(whole, "--catalog-in", other)
        self.assertEqual(numbers(result), numbers(self.measure_one(other)))
        self.assertEqual((result["field"], result["flags"]["masked"], own["flags"]["masked"]), ("gauss", 1, 0))
        self.assertFails(shearctl("measure", whole, other, "--catalog-in", other), USAGE, "one field file")

    def test_usage(self):
        whole, options = self.cut(Field(n=4))
        self.assertFails(shearctl("measure", *options, whole), USAGE, "either field files")
        self.assertFails(shearctl("measure", *options[:4]), USAGE, "belong together")
        self.assertFails(shearctl("measure", "--catalog-in", whole), USAGE, "belong together")
        self.assertFails(shearctl("measure", *options[2:], "--galaxy", whole + ":99999"), USAGE,
                         "from 0 to 9999")
        self.assertFails(shearctl("measure", *options[2:], "--galaxy", whole + ":NONE"), INPUT,
                         "has no HDU NONE")
        self.assertFails(shearctl("measure", *options[2:], "--galaxy", self.path("no")), INPUT,
                         "No such file")


if __name__ == "__main__":
    unittest.main()
