# SPDX-License-Identifier: GPL-3.0-or-later
"""Exposures as jobs: by options, job files and the watch folder, with the numbers of `shearctl measure`; who may read
their files; what is refused, and by which name; duplicates, restarts, and fields of several frames."""
import json
import math
import os
import subprocess
import unittest

import fitsfile
from daemon import SLOW, SLOW_OPTIONS, FINAL, DaemonTest, content_of, mock, numbers, stamps_for, until
from test_carried import cells as table_cells
from test_daemon_access import OTHER, as_user
from tool import SHEARCTL

PSF_SIDE, FWHM, EXPONENT = 45, 3.8, 3.5  # of the PSF that `shearctl expose` draws
FILES = ("image", "sources", "psf", "weight", "mask", "segmentation", "wcs", "noise_image")
GAP = 80  # pixels between neighbours


def moffat(path):
    """An image of the PSF, in a file of its own."""
    alpha = 0.5 * FWHM / math.sqrt(2 ** (1 / EXPONENT) - 1)
    middle, n = PSF_SIDE // 2, PSF_SIDE
    pixels = [(1 + ((i % n - middle) ** 2 + (i // n - middle) ** 2) / alpha ** 2) ** -EXPONENT for i in range(n * n)]
    with open(path, "wb") as file:
        file.write(fitsfile.primary() + fitsfile.image("PSF", (n, n), pixels, -64))
    return path


def options_of(exposure):
    """An object `exposure` as options of shearctl."""
    options = []
    for name, value in exposure.items():
        if isinstance(value, dict):
            hdu = value.get("extname", value.get("hdu"))
            value = value["path"] + ("" if hdu is None else f":{hdu}")
        options += ["--" + {"noise_image": "noise"}.get(name, name.replace("_", "-")), str(value)]
    return options


def measured_exposure(exposure, *options):
    """The object of `shearctl measure --json`."""
    run = subprocess.run([SHEARCTL, "measure", "--json", *options, *options_of(exposure)], check=True,
                         capture_output=True, encoding="utf-8")
    return json.loads(run.stdout)


class Exposures(DaemonTest):
    settings = {}

    def setUp(self):
        super().setUp()
        self.d = self.daemon(self.settings)
        self.psf = moffat(os.path.join(self.d.data, "psf.fits"))

    def expose(self, name="exp", chips="2x1", size="480x480", seed=1, empty=False, **more):
        """Draw an exposure; its object, with every source's radius known, for the neighbours."""
        path = os.path.join(self.d.data, name + ".fits")
        objects = ["--galaxies", "0"] if empty else ["--spacing", str(GAP)]
        subprocess.run([SHEARCTL, "expose", "--quiet", "--chips", chips, "--chip-size", size, "--stars", "0", *objects,
                        "--flux", "20000,80000", "--cosmic-rays", "3", "--bad-columns", "1", "--psf-shape", "0,0",
                        "--psf-variation", "0", "--rotation", "30", "--seed", str(seed), path],
                       check=True, stdout=subprocess.DEVNULL)
        beside = {key: {"path": os.path.join(self.d.data, f"{name}.{key}.fits")} for key in ("weight", "mask")}
        return {"image": {"path": path}, **beside,
                "sources": {"path": os.path.join(self.d.data, name + ".truth.fits")}, "psf": {"path": self.psf},
                "psf_kind": "cube", "columns": "a=PSF_FWHM,b=PSF_FWHM,theta=E1", "stamp": 40, **more}

    def submit(self, exposure, **more):
        return self.d.call("submit", exposure=exposure, **{"wait": True, **more})["job"]

    def assertRefusedAt(self, code, parameter, **params):
        with self.subTest(parameter=parameter), self.assertRefused(code) as caught:
            self.d.call("submit", **params)
        self.assertEqual(caught.exception.error["data"]["parameter"], parameter)

    def assertSame(self, job, expected):
        self.assertEqual((job["state"], job["message"]), ("done", None))
        self.assertEqual(numbers(job["result"]), numbers(expected))
        self.assertEqual(job["result"]["resolved"], expected["resolved"])
        self.assertEqual(job["checksum"], expected["files"][0]["checksum"])


class Catalogs(Exposures):
    settings = {"catalogues.enabled": "true"}

    def test_columns_are_carried(self):
        """The catalog of a job is that of `measure`, with the columns of its sources."""
        exposure = self.expose(chips="1x1", carry="FLUX,CHIP,IS_STAR,X,FLUX")
        path = os.path.join(self.directory, "local.shear.fits")
        measured_exposure(exposure, "--catalog", path)
        job = self.submit(exposure)
        self.assertEqual((job["state"], job["message"]), ("done", None))
        ours, local = (table_cells(fitsfile.hdus(content_of(p))[-1][1]) for p in
                       (self.d.path(f"catalogues/{job['id']}.shear.fits"), path))
        self.assertEqual(list(ours)[-4:], ["CAT_FLUX", "CHIP", "IS_STAR", "CAT_X"])
        self.assertEqual(ours, local)


class Ways(Exposures):
    def test_by_the_protocol(self):
        exposure = self.expose(noise_stamps=2, amplifiers="2x1", mask_bad="bits=7", select="IS_STAR == 0", frame="sky-east")
        expected = measured_exposure(exposure)
        self.assertNotEqual(numbers(expected), numbers(measured_exposure({**exposure, "amplifiers": "1x1"})))
        self.assertGreater(expected["n_used"], 40)
        job = self.submit(exposure)
        self.assertSame(job, expected)
        self.assertEqual(job["field"], "exp")
        self.assertEqual(job["result"]["resolved"]["frame"], "sky-east")
        self.assertAlmostEqual(job["result"]["resolved"]["beta_sky"],
                               0.263 * job["result"]["resolved"]["beta_px"], delta=1e-3)
        told = {key: value for key, value in job["source"]["exposure"].items() if value is not None}
        self.assertEqual({key: value["path"] if isinstance(value, dict) else value for key, value in told.items()},
                         {key: value["path"] if isinstance(value, dict) else value for key, value in exposure.items()})
        row = self.assertRow(self.d, "exp", numbers(expected), 1)
        self.assertEqual(row["resolved"], expected["resolved"])
        self.assertEqual(row["files"][0]["resolved"]["frame"], "sky-east")

    def test_by_options(self):
        exposure = self.expose(chips="1x1", noise="white")
        job = json.loads(self.d.shearctl("submit", "--wait", "--json", "--quiet", *options_of(exposure)))["job"]
        self.assertSame(job, measured_exposure(exposure))
        shown = self.d.shearctl("show", str(job["id"]))
        for words in ("sources ", "exp.truth.fits", "frame  ", "sky: x to the West, y to the North", "noise  ", "white"):
            self.assertIn(words, shown)
        self.assertIn("exp.fits, an exposure", self.d.shearctl("jobs"))

    def test_an_origin_that_is_wrong_is_told(self):
        for origin in (0, 1):
            exposure = self.expose(f"o{origin}", chips="1x1", size="640x640", origin=origin)
            job = self.submit(exposure, field=f"f{origin}")
            for told in (job, self.d.call("field", field=f"f{origin}")):
                self.assertEqual("give --origin 1" in json.dumps(told), origin == 0)

    def test_by_job_files(self):
        """On the command line and in the watch folder."""
        exposure = self.expose(chips="1x1")
        expected = measured_exposure(exposure)
        path = os.path.join(self.directory, "job.json")
        with open(path, "w", encoding="ascii") as file:
            json.dump({"exposure": exposure, "field": "f"}, file)
        self.assertSame(json.loads(self.d.shearctl("submit", "--wait", "--json", "--quiet", path))["job"], expected)
        wrong = {**exposure, "noise": "loud"}
        absent = {**exposure, "mask": {"path": self.d.data + "/no.fits"}}
        for name, dropped in (("good", exposure), ("wrong", wrong), ("absent", absent)):
            self.d.drop(None, name + ".json", json.dumps({"exposure": dropped, "field": "g"}).encode())
        self.d.wait_idle()
        self.assertEqual(self.d.dropped("done"), ["good.json", "good.json.json"])
        self.assertRow(self.d, "g", numbers(expected), 1)
        self.assertEqual(self.d.side("failed", "absent.json")["code"], "no_such_file")
        side = self.d.side("failed", "wrong.json")
        self.assertEqual(side["code"], "bad_parameter")
        self.assertIn("'exposure.noise'", side["message"])

    def test_every_kind_of_file(self):
        """Packed ones, too: each takes a scratch file. The mask stands for the segmentation that `expose` does not
        draw."""
        exposure = self.expose(chips="1x1")
        with open(os.path.join(self.d.data, "exp.head"), "wb") as file:
            header = next(content for name, content in fitsfile.hdus(content_of(exposure["image"]["path"])) if name)
            cards = [header[i:i + 80] for i in range(0, header.index(b"END     "), 80)]
            file.write(b"".join(card.rstrip() + b"\n" for card in cards if card[:2] in (b"CT", b"CR", b"CD", b"CU", b"PV"))
                       + b"END\n")
        exposure["wcs"] = {"path": file.name}
        chip = exposure["mask"]["path"]
        exposure["segmentation"] = {"path": chip}
        exposure["noise_image"] = self.expose("empty", "1x1", seed=2, empty=True)["image"]
        for key in ("image", "weight", "mask", "segmentation", "noise_image", "sources", "psf"):
            packed = os.path.join(self.d.data, key + ".gz")
            with open(packed, "wb") as file:
                subprocess.run(["gzip", "-c", exposure[key]["path"]], check=True, stdout=file)
            exposure[key] = {"path": packed}
        expected = measured_exposure(exposure)
        self.assertGreater(expected["n_used"], 10)
        self.assertSame(self.submit(exposure), expected)

    def test_a_mosaic_by_its_size(self):
        """Stamps in one image without keywords: --stamp-size. A cube's stamps, one above the other, are such an
        image."""
        whole = mock(os.path.join(self.d.data, "whole.fits"), 16, 32)
        cubes, mosaics = {}, {}
        for name, content in fitsfile.hdus(content_of(whole))[1:4]:
            header = fitsfile.header([("XTENSION", "IMAGE"), ("BITPIX", -32), ("NAXIS", 2), ("NAXIS1", 32),
                                      ("NAXIS2", 16 * 32), ("PCOUNT", 0), ("GCOUNT", 1)])
            flat = content if name == "PSF" else header + content[fitsfile.BLOCK:]
            for parts, folder, hdu in ((cubes, "cube", content), (mosaics, "mosaic", flat)):
                parts[name.lower()] = {"path": os.path.join(self.d.data, f"{folder}-{name}.fits")}
                with open(parts[name.lower()]["path"], "wb") as file:
                    file.write(fitsfile.primary() + hdu)
        options = [text for name, part in mosaics.items() for text in ("--" + name, part["path"])]
        expected = self.d.call("submit", **cubes, wait=True)["job"]
        job = json.loads(self.d.shearctl("submit", "--wait", "--json", "--quiet", "--stamp-size", "32x32", *options))["job"]
        self.assertEqual((job["source"]["stamp_nx"], job["source"]["stamp_ny"], job["source"]["stamps"]), (32, 32, None))
        half = self.d.call("submit", **mosaics, stamp_nx=32, stamps=8, field="half", wait=True)["job"]
        self.assertEqual(numbers(job["result"]), numbers(expected["result"]))
        self.assertEqual((half["state"], half["result"]["n_stamps"]), ("done", 8))
        bare = self.d.call("submit", **mosaics, field="bare", wait=True)["job"]
        self.assertEqual((bare["state"], bare["code"]), ("failed", "bad_file"))


class Refusals(Exposures):
    def test_wrong_members(self):
        exposure = self.expose(chips="1x1")
        cases = [("exposure.sources.hdu", {"sources": {**exposure["sources"], "hdu": 1, "extname": "TRUTH"}}),
                 ("exposure.noise_image.hdu", {"noise_image": {**exposure["image"], "hdu": 1, "extname": "A"}}),
                 ("exposure.weight_kind", {"weight_kind": "heavy"}), ("exposure.frame", {"frame": "moon"}),
                 ("exposure.origin", {"origin": 2}), ("exposure.stamp", {"stamp": 7}),
                 ("exposure.noise_stamps", {"noise_stamps": 65}), ("exposure.psf_kind", {"psf_kind": ""}),
                 ("exposure.noise", {"noise": "white", "noise_image": exposure["image"]}),
                 ("exposure.amplifiers", {"amplifiers": "2"}), ("exposure.amplifiers", {"amplifiers": "999999999x1"}),
                 ("exposure.amplifiers", {"amplifiers": 2}), ("exposure.select", {"select": 4}),
                 ("exposure.mask.path", {"mask": {"path": "mask.fits"}})]
        for parameter, change in cases:
            self.assertRefusedAt("bad_parameter", parameter, exposure={**exposure, **change})
        for name in ("image", "sources", "psf"):
            less = {key: value for key, value in exposure.items() if key != name}
            self.assertRefusedAt("missing_parameter", f"exposure.{name}", exposure=less)
        self.assertRefusedAt("unknown_parameter", "exposure.wieght", exposure={**exposure, "wieght": exposure["weight"]})
        self.assertRefusedAt("bad_parameter", "exposure", exposure=exposure, psf=exposure["psf"])
        self.assertRefusedAt("bad_parameter", "path", exposure=exposure, path=self.psf)
        self.assertRefusedAt("bad_parameter", "stamps", exposure=exposure, stamps=4)
        self.assertEqual(self.d.jobs(), [])

    def test_what_the_files_do_not_have(self):
        exposure = self.expose(chips="1x1")
        for change, words in (({"select": "MAG_AUTO < 24"}, "MAG_AUTO"), ({"columns": "x=XPOS,y=YPOS"}, "XPOS"),
                              ({"image": {**exposure["image"], "extname": "CHIP7"}}, "CHIP7"),
                              ({"select": "X < 0"}, "no source is selected"), ({"mask_bad": "bits=x"}, "bits=x"),
                              ({"amplifiers": "64x1"}, "64 x 1 amplifiers"), ({"psf_kind": "psfex"}, "psf.fits"),
                              ({"segmentation": exposure["psf"]}, "45")):
            with self.subTest(words=words):
                job = self.submit({**exposure, **change})
                self.assertEqual((job["state"], job["class"]), ("failed", "data"), job["message"])
                self.assertIn(words, job["message"])
        self.assertEqual(self.d.call("fields")["fields"], [])

    def test_files_elsewhere(self):
        """Every file passes the same check as a field file."""
        exposure = self.expose(chips="1x1")
        os.mkdir(os.path.join(self.d.data, "folder"))
        os.symlink("/etc/passwd", os.path.join(self.d.data, "link"))
        for name in FILES:
            for code, path in (("outside_roots", "/etc/passwd"), ("outside_roots", self.d.data + "/link"),
                               ("no_such_file", self.d.data + "/no.fits"), ("not_regular", self.d.data + "/folder")):
                self.assertRefusedAt(code, f"exposure.{name}.path", exposure={**exposure, name: {"path": path}})
        self.assertEqual(self.d.jobs(), [])


@unittest.skipUnless(os.getuid() == 0, "only root can become somebody else")
class Rights(Exposures):
    settings = {"daemon.socket_mode": "0666"}

    def test_every_file_is_opened_by_the_peer(self):
        exposure = self.expose(chips="1x1")
        secret = os.path.join(self.d.data, "secret.fits")
        with open(secret, "wb") as file:
            file.write(content_of(exposure["image"]["path"]))
        os.chmod(secret, 0o600)

        def ask():
            for name in FILES:
                self.assertRefusedAt("not_readable", f"exposure.{name}.path",
                                     exposure={**exposure, name: {"path": secret}})
        as_user(self, OTHER, ask)
        os.chown(secret, OTHER, OTHER)
        as_user(self, OTHER, lambda: self.assertEqual(
            self.submit({**exposure, "image": {"path": secret}})["state"], "done"))


class Counting(Exposures):
    def test_once(self):
        exposure = self.expose()
        first = self.submit(exposure)
        for same in (exposure, {**exposure, "stamp": 32}, {**exposure, "frame": "pixel", "noise_stamps": 2}):
            again = self.submit(same)
            self.assertEqual((again["outcome"], again["duplicate_of"]), ("duplicate", first["id"]))
        self.assertRow(self.d, "exp", numbers(measured_exposure(exposure)), 1)

    def test_chips_of_one_file(self):
        """One job for each chip: together as much as there is, and no chip is another's duplicate."""
        exposure = self.expose()
        n = 0
        for chip in ("CHIP1", "CHIP2", "chip2", 1):
            choice = {"hdu": chip} if chip == 1 else {"extname": chip}
            files = {key: {**exposure[key], **choice} for key in ("image", "weight", "mask")}
            job = self.submit({**exposure, **files, "select": f"CHIP == {str(chip)[-1]}"})
            self.assertEqual((job["state"], job["outcome"]),
                             ("done", "duplicate" if chip in ("chip2", 1) else "counted"), job["message"])
            n += job["result"]["n_stamps"] if job["outcome"] == "counted" else 0
        self.assertEqual(n, self.d.call("field", field="exp")["rows"][0]["n_stamps"])
        self.assertEqual(n, measured_exposure(exposure)["n_stamps"])

    def test_frames_do_not_mix(self):
        sky, pixel = self.expose("a"), self.expose("b", seed=2, frame="pixel")
        other = self.submit(sky, field="f")
        self.assertRow(self.d, "f", numbers(measured_exposure(sky)), 1)
        job = self.submit(pixel, field="f")
        self.assertEqual((job["outcome"], job["result"]["resolved"]["frame"], job["result"]["resolved"]["beta_sky"]),
                         ("counted", "pixel", None))
        row = self.d.call("field", field="f")["rows"][0]
        self.assertEqual((row["g1"], row["g2"], row["no_shear"]), (None, None, "mixed_frames"))
        self.assertIn("axes", row["reason"])
        self.assertEqual(row["jobs"], 2)
        shown = self.d.shearctl("field", "f")
        self.assertIn("mixed: its files were measured along different axes", shown)
        self.assertIn("not measured", shown)
        self.d.call("retract", id=job["id"])
        row = self.assertRow(self.d, "f", numbers(measured_exposure(sky)), 1)
        self.assertEqual((row["no_shear"], row["resolved"]["frame"]), (None, "sky"))
        self.d.call("retract", id=other["id"])
        self.submit(pixel, field="f")
        row = self.assertRow(self.d, "f", numbers(measured_exposure(pixel)), 1)
        self.assertEqual(row["resolved"]["frame"], "pixel")

    def test_resumes_after_a_kill(self):
        side = math.ceil(math.sqrt(stamps_for(3, 32, *SLOW_OPTIONS)))
        exposure = self.expose(chips="1x1", size=f"{side * GAP}x{side * GAP}", stamp=32)
        expected = measured_exposure(exposure, *SLOW_OPTIONS)
        job = self.submit(exposure, settings=SLOW, wait=False)["id"]
        until(lambda: self.d.job(job)["progress"]["done"], "it measures")
        self.d.kill()
        self.d.start()
        self.assertEqual(self.d.wait_state(job, *FINAL)["state"], "done")
        self.assertRow(self.d, "exp", numbers(expected), 1)


class Changing(Exposures):
    settings = {"retry.first_delay": "50ms"}

    def test_a_file_that_changes(self):
        """Any of its files: what was measured until then does not count."""
        side = math.ceil(math.sqrt(stamps_for(3, 32, *SLOW_OPTIONS)))
        exposure = self.expose(chips="1x1", size=f"{side * GAP}x{side * GAP}", stamp=32)
        job = self.d.held(self.submit(exposure, settings=SLOW, wait=False)["id"])
        with open(exposure["mask"]["path"], "r+b") as file:
            file.seek(-2880, 2)
            file.write(b"\0" * 8)
        self.d.go_on()
        job = self.d.wait_state(job, *FINAL)
        history = self.d.call("job", id=job["id"])["history"]
        self.assertEqual([(a["ending"], a["code"]) for a in history], [("failed", "file_changed"), ("done", None)])
        self.assertIn("mask", history[0]["message"])
        self.assertRow(self.d, "exp", numbers(measured_exposure(exposure, *SLOW_OPTIONS)), 1)

    def test_too_large_for_the_shared_memory(self):
        exposure = self.expose(chips="1x1", stamp=512, noise_stamps=64)
        job = self.submit(exposure)
        self.assertEqual(job["state"], "failed")
        self.assertIn("[reader] shared_memory", job["advice"])
        self.assertIn("carry fewer columns", job["advice"])


if __name__ == "__main__":
    unittest.main()
