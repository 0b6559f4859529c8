#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's experiments in the small: laws (the truth within errors, the order of the methods), not golden numbers.

`test_validation.py NAME` runs one experiment's class; SHEAR_PAPER in the environment is the program."""
import os
import pathlib
import shlex
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PAPER = os.path.abspath(os.environ["SHEAR_PAPER"])


def read_ecsv(path):
    """Rows as dictionaries, and the meta data."""
    kinds, meta, names, rows = {}, {}, None, []
    for line in pathlib.Path(path).read_text().splitlines():
        if line.startswith("# - {name: "):
            name = line.split("name: ")[1].split(",")[0]
            kinds[name] = line.split("datatype: ")[1].split(",")[0]
        elif line.startswith("# - "):
            key, _, value = line[4:].partition(": ")
            meta[key] = value[1:-1].replace("''", "'")
        elif not line.startswith("#"):
            cells = shlex.split(line)
            if names is None:
                names = cells
            else:
                rows.append({n: c if kinds[n] == "string" else float(c) for n, c in zip(names, cells)})
    assert list(kinds) == names, "the header names other columns than the body"
    return rows, meta


class ExperimentTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="shear-paper-")
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)

    def command(self, name, *options, out=None):
        return [PAPER, name, "--out", str(out or self.path), "--quiet", *map(str, options)]

    def run_paper(self, name, *options, out=None):
        """The rows of the table; the figure is there and is a PNG."""
        process = subprocess.run(self.command(name, *options, out=out), capture_output=True, text=True, timeout=250)
        self.assertEqual(process.returncode, 0, process.stderr)
        picture = pathlib.Path(out or self.path) / f"{name}.png"
        self.assertEqual(picture.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.rows, self.meta = read_ecsv(picture.with_suffix(".ecsv"))
        self.assertIn(self.meta["verdict"], process.stdout)
        return self.rows

    def some(self, **values):
        rows = [r for r in self.rows if all(r[k] == v for k, v in values.items())]
        self.assertTrue(rows, values)
        return rows

    def one(self, **values):
        rows = self.some(**values)
        self.assertEqual(len(rows), 1, values)
        return rows[0]


class Usage(ExperimentTest):
    def fails(self, *options, says):
        process = subprocess.run(self.command(*options), capture_output=True, text=True, timeout=60)
        self.assertEqual(process.returncode, 2, process.stderr)
        self.assertIn(says, process.stderr)

    def test_mistakes(self):
        self.fails("nosuch", says="nosuch")
        self.fails("noise", "--nosuch", "1", says="nosuch")
        self.fails("noise", "--galaxies", "many", says="galaxies")
        self.fails("noise", "--ratios", "1,,2", says="ratios")
        self.fails("noise", "--noise-ratio", "1", says="chooses it itself")
        self.fails("noise", "--seed", says="needs a value")
        self.fails("shot", "--snrs", "1", says="snrs")
        self.assertEqual(list(self.path.glob("*.ecsv")), [])

    def test_a_parameter_may_have_a_mock_option_s_name(self):
        self.fails("pixels", "--beta", "none", says="beta")
        self.run_paper("single", "--galaxies", 4, "--objects", 1, "--steps", 20, "--ratios", "1", "--size", 3, "--beta", 2)
        self.assertIn(";size 3;", self.meta["settings"])
        self.assertNotIn("--out", self.meta["command"])

    def test_help(self):
        names = subprocess.run([PAPER, "help"], capture_output=True, text=True, check=True).stdout
        for name in ("noise", "images", "single", "pixels", "overall", "shot", "bias", "errors", "efficiency", "survey",
                     "precision", "narrow", "selection"):
            self.assertIn(name, names)
            text = subprocess.run([PAPER, "help", name], capture_output=True, text=True, check=True).stdout
            self.assertIn(f"usage: shear-paper {name}", text)


class Noise(ExperimentTest):
    SMALL = ("--size", 80, "--r-gal", 10, "--r-psf", 2, "--points", 200, "--ratios", "0.05,0.5,1.5", "--groups", 40)

    def test_correction(self):
        self.run_paper("noise", *self.SMALL, "--galaxies", 800)
        truth = (0.023, -0.037)
        for row in self.some(corrected="yes"):
            self.assertLess(max(abs(row["pull1"]), abs(row["pull2"])), 4.0, row)
        self.assertGreater(float(self.meta["p"]), 1e-3)
        faint, bright = self.one(corrected="no", ratio=0.05), self.one(corrected="no", ratio=1.5)
        self.assertLess(abs(faint["g2"] - truth[1]), 0.15 * abs(truth[1]))
        self.assertLess(abs(bright["g2"]), 0.6 * abs(truth[1]), "without the correction the shear falls towards zero")
        self.assertLess(abs(faint["g2_err"]), abs(self.one(corrected="yes", ratio=1.5)["g2_err"]))
        self.assertTrue((self.path / "noise-images.png").exists())

    def test_threads_and_restarts_change_nothing(self):
        options = (*self.SMALL, "--galaxies", 240)
        table = lambda folder: [line for line in (folder / "noise.ecsv").read_text().splitlines()
                                if not line.startswith(("# - command", "# - seconds", "# - threads"))]
        one, two = self.path / "one", self.path / "two"
        self.run_paper("noise", *options, "--threads", 1, out=one)
        process = subprocess.Popen(self.command("noise", *options, "--threads", 2, out=two),
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + 100
        state = None
        while time.monotonic() < end and process.poll() is None:
            state = next(two.glob("*.state"), None)
            if state and len(state.read_bytes().splitlines()) > 3:
                break
            time.sleep(0.005)
        process.send_signal(signal.SIGKILL)
        process.wait()
        before = state.read_bytes()
        self.assertGreater(len(before.splitlines()), 3)
        damaged = b"noise 39 1.5 0.1 0x1p+0 0x1p+0 end\n"  # not a number of values
        with state.open("ab") as out:
            out.write(damaged + b"noise 39 12 0.1 0x1p+0 0x1")  # a line that a crash cut off
        self.run_paper("noise", *options, "--threads", 2, out=two)
        self.assertEqual(table(one), table(two))
        after = state.read_bytes()
        whole = before[:before.rindex(b"\n") + 1]
        self.assertEqual(after[:len(whole)], whole, "finished groups are not measured again")
        self.assertNotIn(damaged, after)
        self.run_paper("noise", *options, out=two)
        self.assertEqual(state.read_bytes(), after, "a finished run has nothing to do")


class Images(ExperimentTest):
    def test_logarithms_are_positive(self):
        self.run_paper("images")
        for row in self.rows:
            if row["method"].startswith("Log-"):
                self.assertEqual(row["negative"], 0.0)
                self.assertGreaterEqual(row["lowest"], 0.0)
        for name in ("Bicubic", "Spline"):
            self.assertLess(self.one(method=name)["lowest"], -1e-4)
            self.assertLess(self.one(method="Log-" + name)["rms"], self.one(method=name)["rms"])
            self.assertLess(self.one(method=name)["rms"], self.one(method="Bilinear")["rms"])


class Single(ExperimentTest):
    def test_convergence(self):
        self.run_paper("single", "--galaxies", 40, "--objects", 3, "--steps", 300, "--ratios", "2,1,0.5")
        for name in {row["method"] for row in self.rows}:
            rms = [self.one(method=name, psf="fine", ratio=ratio)["rms_all"] for ratio in (2, 1, 0.5)]
            self.assertGreater(rms[0], 1.5 * rms[1], name)
            self.assertGreater(rms[1], 2.0 * rms[2], name)
        for ratio in (2, 1):
            for name in ("Bicubic", "Spline"):
                self.assertLess(self.one(method="Log-" + name, psf="fine", ratio=ratio)["rms_all"],
                                self.one(method=name, psf="fine", ratio=ratio)["rms_all"])

    def test_linear_methods_are_one_where_they_serve_the_psf_too(self):
        self.run_paper("single", "--galaxies", 8, "--objects", 1, "--steps", 300, "--ratios", "1")
        rows = [self.one(method=name, psf="coarse") for name in ("Bilinear", "Bicubic", "Spline")]
        for row in rows[1:]:
            self.assertAlmostEqual(row["bias1"], rows[0]["bias1"], delta=1e-6)
        fine = self.one(method="Bilinear", psf="fine")
        self.assertGreater(fine["rms"], 5.0 * rows[0]["rms"])


class Pixels(ExperimentTest):
    def test_order_of_the_methods(self):
        self.run_paper("pixels", "--galaxies", 160, "--rotate", 4, "--steps", 300, "--sizes", "3.33", "--ratios", "0.5,2",
                       "--groups", 20, "--coarse", 0)
        dev = lambda row: (row["dev1"] ** 2 + row["dev2"] ** 2) ** 0.5
        rows = {(row["method"], row["ratio"]): row for row in self.rows}
        for ratio in (0.5, 2):
            for name in ("Bilinear", "Bicubic", "Spline"):
                plain, log = rows[name, ratio], rows["Log-" + name, ratio]
                self.assertLess(dev(log), dev(plain) + 3 * log["gain_err"], (name, ratio))
            self.assertLess(dev(rows["Spline", ratio]), dev(rows["Bilinear", ratio]))
        self.assertGreater(dev(rows["Bilinear", 2]), 4 * dev(rows["Log-Bicubic", 2]))
        for name in ("Log-Bicubic", "Log-Spline"):
            self.assertLess(dev(rows[name, 0.5]), 3e-4)
            self.assertLess(dev(rows[name, 2]), 0.1 * 0.036)
            for k in (1, 2):
                error = max(4 * rows[name, 0.5][f"g{k}_err"], 2e-4)
                self.assertLess(abs(rows[name, 0.5][f"g{k}"] - (-0.031, 0.018)[k - 1]), error)


class Overall(ExperimentTest):
    def test_truth_within_errors(self):
        self.run_paper("overall", "--galaxies", 160, "--rotate", 4, "--sizes", "10", "--groups", 40)
        self.assertEqual(len(self.rows), 8)
        for row in self.rows:
            # At R_PSF = 0.5 pixels the pixels hold too little: some percent are lost whatever is done.
            lost = 0.05 if row["method"] == "Log-Bicubic" else 0.03
            for k, truth in ((1, -0.031), (2, 0.018)):
                self.assertLess(abs(row[f"g{k}"] - truth), 4 * row[f"g{k}_err"] + lost * abs(truth), row)
                self.assertLess(row[f"g{k}_err"], 0.005, "the test has no teeth where errors are large")


class Shot(ExperimentTest):
    def test_exposure_and_plateau(self):
        self.run_paper("shot", "--galaxies", 160, "--steps", 200, "--rotate", 4, "--groups", 25, "--size", 30, "--r-gal", 5,
                       "--step-size", 0.4, "--photons-1", "1e6", "--photons-2", "1e4", "--photons-3", "1,1000")
        worst = lambda row: max(abs(row["dm1"]), abs(row["dm2"]))
        faint = {row["way"]: row for row in self.some(snr=1, photons=1)}
        for way in ("log-spline", "none"):
            self.assertGreater(worst(faint[way]), 0.2, "counting photons biases the shear")
        for k in (1, 2):
            self.assertLess(abs(faint["plateau"][f"dm{k}"]), 4 * faint["plateau"][f"dm{k}_err"])
        self.assertLess(worst(faint["plateau"]), 0.5 * worst(faint["none"]))
        for row in self.some(snr=1, photons=1000):
            self.assertLess(worst(row), 0.01, "a long exposure cures it")


class Bias(ExperimentTest):
    def test_first_and_next_order(self):
        self.run_paper("bias", "--galaxies", 400, "--groups", 20, "--fewer", 1, "--noises", "0,1", "--psfs", "0",
                       "--points", 60, "--steps", 60)
        for row in self.some(shears="small", noise="none", method="none"):
            for k in (1, 2):
                self.assertLess(abs(row[f"m{k}"]), 1e-3)
                self.assertLess(abs(row[f"c{k}"]), 1e-5)
                self.assertLess(row[f"m{k}_err"], 1e-4)
        for row in self.some(shears="small", noise="white"):
            for k in (1, 2):
                self.assertLess(abs(row[f"m{k}"]), 1e-3 + 3 * row[f"m{k}_err"])
                self.assertLess(abs(row[f"c{k}"]), 4 * row[f"c{k}_err"])
        for row in self.some(shears="small", method="Log-Spline"):
            self.assertLess(abs(row["m1"]), 2e-3)
        for row in self.some(shears="large"):
            # Gaussian galaxies of variance s^2: a = -1 + 6 r (1 - r), r = s^2 / (s^2 + beta^2): at most 1/2.
            self.assertTrue(0.2 < row["cubic"] < 0.55, row)
            self.assertLess(abs(row["m1"]), 3e-4, "what is left at small shears once the cubic term is taken out")


class Errors(ExperimentTest):
    def test_pulls(self):
        self.run_paper("errors", "--galaxies", 40000, "--lengths", "50,500,1000", "--points", 40, "--size", 32,
                       "--r-gal", 5)
        long = {row["errors"]: row for row in self.some(n=500)}
        for row in long.values():
            self.assertLess(abs(row["mean"]), 4 * row["mean_err"])
            self.assertLess(abs(row["width"] - 1), 0.05 + 3 * row["width_err"])
        short = self.one(n=50, errors="jackknife")
        self.assertGreater(short["width"], 1.4, "four groups make Student's t with three degrees of freedom")
        self.assertGreater(short["p_student"], 1e-4)
        self.assertLess(short["p_gauss"], 1e-4)
        self.assertGreater(long["delta"]["p_gauss"], 1e-4)


class Efficiency(ExperimentTest):
    def test_estimators(self):
        self.run_paper("efficiency", "--galaxies", 6000, "--groups", 6, "--ranges", "1,30", "--bias-snr", 20)
        bound = float(self.meta["bound_one_component"])
        self.assertTrue(0.1 < bound < 0.2)
        for row in self.rows:
            self.assertEqual(row["failed"], 0.0)
            self.assertTrue(0.5 < row["pull_width"] < 1.6, row)
            if row["estimator"] == "mean":  # the mean knows nothing of the noise it has
                self.assertLess(abs(row["m"]), 4 * row["m_err"] + 4e-3, row)
        quoted = {(r["flux_range"], r["snr"], r["estimator"]): r["quoted"] for r in self.rows}
        free = {key[::2]: value for key, value in quoted.items() if key[1] != key[1]}
        noisy = {key[::2]: value for key, value in quoted.items() if key[1] == 10}
        # Equal galaxies: both are at the bound; a broad range: one stays there, in noise as well.
        self.assertLess(abs(free[1, "mean"] / bound - 1), 0.15)
        self.assertLess(abs(free[1, "pdf-sym"] / free[1, "mean"] - 1), 0.08)
        self.assertLess(free[30, "pdf-sym"], 1.25 * bound)
        self.assertGreater(free[30, "mean"], 2 * free[30, "pdf-sym"])
        self.assertGreater(noisy[30, "mean"], 1.5 * noisy[30, "pdf-sym"])
        # The cross terms have their price, which is small.
        self.assertTrue(0.9 < noisy[1, "pdf-sym-cross"] / noisy[1, "pdf-sym"] < 1.15)


class Survey(ExperimentTest):
    ROWS = {"reference": 0, "correlated-white": 4, "swapped": 21, "weightless": 23}

    def test_rows(self):
        self.run_paper("survey", "--galaxies", 320, "--groups", 8, "--snrs", "100,40", "--rows",
                       ",".join(str(row) for row in self.ROWS.values()))
        self.assertEqual(len(self.rows), 4 * len(self.ROWS))
        for row in self.some(case="reference", estimator="mean"):
            self.assertLess(abs(row["m"]), 2e-3 + 4 * row["m_err"])
            self.assertLess(row["m_err"], 0.03, "the test has no teeth where errors are large")
            self.assertEqual((row["told"], row["met"], row["flagged"]), ("no", "yes", 0))
        for case in ("swapped", "weightless"):
            for row in self.some(case=case):
                self.assertIn(row["told"].split()[0], ("no", "refused"))
                self.assertNotEqual(row["told"], "no", "there is no shear to be had, and that is told")
                self.assertNotEqual(row["m"], row["m"])
        # Noise stamps that are not like the galaxies' noise: told, or as wrong as it is.
        for row in self.some(case="correlated-white", snr=100, estimator="mean"):
            self.assertTrue(row["told"] != "no" or abs(row["m"]) > 0.1, row)
            self.assertEqual(row["met"], "yes" if row["told"] != "no" else "no")

    def test_nothing_is_left(self):
        environment = {**os.environ, "TMPDIR": str(self.path)}
        subprocess.run(self.command("survey", "--galaxies", 64, "--groups", 4, "--snrs", "50", "--rows", "0", "--least", 64),
                       env=environment, stdout=subprocess.DEVNULL, check=True, timeout=100)
        self.assertEqual([p.name for p in self.path.iterdir() if p.is_dir()], [])


class Precision(ExperimentTest):
    def test_errors(self):
        self.run_paper("precision", "--galaxies", 600, "--groups", 30, "--snrs", "200,12", "--steps", "1,2")
        error = {(r["step"], r["estimator"], r["snr"], r["range"]): r for r in self.rows}
        bright = error["beta-ratio 2", "mean", 200, 1]
        # Noise-free, the error is the scatter of the shapes, 0.26 a component but for the cut and the response.
        self.assertTrue(0.22 < bright["quoted"] < 0.30, bright)
        self.assertLess(abs(bright["error"] - bright["quoted"]), 4 * bright["error_err"])
        self.assertLess(abs(bright["m"]), 3e-3 + 4 * bright["m_err"])
        noisy = [error[f"beta-ratio {ratio}", "mean", 12, 1]["quoted"] for ratio in ("1.5", "2")]
        self.assertGreater(noisy[0], 1.2 * noisy[1], "a narrow target takes in more noise")
        broad = error["beta-ratio 2", "mean", 10, 40], error["beta-ratio 2", "pdf-sym", 10, 40]
        self.assertGreater(broad[0]["quoted"], 1.5 * broad[1]["quoted"])


class Narrow(ExperimentTest):
    def test_no_logarithm_is_needed(self):
        self.run_paper("narrow", "--galaxies", 80, "--groups", 10, "--radii", "0.5,0.7,1.2")
        for row in self.some(settings="defaults"):
            for m in ("m1", "m2"):
                self.assertLess(abs(row[m]), 1e-3 + 3 * row[m + "_err"], row)
                self.assertLess(row[m + "_err"], 2e-3, "the test has no teeth where errors are large")
            sizes = [row[name] for name in ("points", "disks_half", "disks_1", "disks_2")]
            self.assertEqual(sizes, sorted(sizes, reverse=True), "the larger a galaxy, the less it has beyond Nyquist")
            self.assertTrue(sizes[3] < row["aliases"] < sizes[0], row)
        shares = [row["aliases"] for row in self.some(settings="defaults")]
        self.assertEqual(shares, sorted(shares, reverse=True), "the wider the PSF, the less")
        # The logarithm of under-sampled pixels takes away some percent; of well sampled ones there is none.
        for m in ("m1", "m2"):
            self.assertLess(self.one(settings="zhang2010", r_psf=0.5)[m], -0.02)
            self.assertLess(self.one(settings="zhang2010", r_psf=0.7)[m], -0.005)
            self.assertLess(abs(self.one(settings="zhang2010", r_psf=1.2)[m]), 1e-3)
        self.assertTrue(0.3 < float(self.meta["limit"]) < 0.4, self.meta["limit"])


class Selection(ExperimentTest):
    SMALL = ("--galaxies", 1600, "--groups", 16, "--kept", "1,0.5")

    def half(self, cut, estimator="mean"):
        return self.one(cut=cut, estimator=estimator, asked=0.5)

    def test_a_cut_that_keeps_all_changes_nothing(self):
        self.run_paper("selection", *self.SMALL)
        for estimator in ("mean", "pdf-sym"):
            whole = self.some(estimator=estimator, asked=1)
            self.assertEqual(len(whole), 6)
            self.assertEqual({(r["m"], r["m_err"]) for r in whole}, {(whole[0]["m"], whole[0]["m_err"])})
            self.assertEqual({(r["shift"], r["shift_err"]) for r in whole}, {(0, 0)})
        true = self.half("true S/N")
        self.assertLess(abs(true["shift"]), 1e-3 + 3 * true["shift_err"])
        self.assertLess(true["shift_err"], 8e-3, "the test has no teeth where errors are large")
        self.assertLess(abs(true["kept"] - 0.5), 0.01)
        noisy = self.half("D")
        self.assertLess(noisy["shift"] + 3 * noisy["shift_err"], -0.01, "D's noise is what is cut on")

    def test_without_noise_only_shear_is_cut_on(self):
        self.run_paper("selection", *self.SMALL, "--faintest", 3000)
        for cut in ("true S/N", "FLUX", "SNR"):
            self.assertLess(abs(self.half(cut)["shift"]), 2e-4, "no shear changes the whole flux")
        self.assertLess(self.half("aperture S/N")["shift"], -3e-3, "a stretched galaxy loses light from the aperture")
        self.assertAlmostEqual(self.half("aperture S/N")["shift"], self.half("deep aperture")["shift"], delta=1e-3)
        self.assertLess(self.half("D")["shift"], -3e-3)


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
