# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl submit."""
import json
import os
import subprocess
import unittest

from fake_service import FakeService, Refusal, failed, job
from service_test import JOB_FAILED, UNREACHABLE, ServiceTest
from tool import DONE, INPUT, OTHER, PARTLY, SANITIZERS, SHEARCTL, USAGE


class Submit(ServiceTest):
    def accept(self, **other):
        numbers = iter(range(1, 1000))
        return self.serve(submit=lambda p, c: {"job": job(next(numbers), "queued", source={
            "path": p.get("path"), "galaxy": p.get("galaxy"), "noise": p.get("noise"), "psf": p.get("psf"),
            "catalog": p.get("catalog")}),
            "known": False}, **other)

    def test_paths_become_absolute_and_links_stay(self):
        service = self.accept()
        os.mkdir(self.path("real"))
        os.symlink("real", self.path("link"))
        os.symlink("/somewhere/else.fits", self.path("real/l.fits"))
        real = os.path.realpath(self.directory)
        answer = self.ctl("submit", "a.fits", "link/../b.fits", "link/l.fits", "/x/../y.fits", cwd=self.directory)
        self.assertCode(answer, DONE)
        self.assertEqual([p["path"] for p in service.named("submit")],
                         [f"{real}/a.fits", f"{real}/b.fits", f"{real}/real/l.fits", "/x/../y.fits"])
        self.assertEqual(answer.out.splitlines()[0], f"job 1 queued: {real}/a.fits")

    def test_a_directory_that_is_not_there(self):
        service = self.accept()
        self.assertFails(self.ctl("submit", "no/such/a.fits"), INPUT, "no/such/a.fits", "directory")
        self.assertFails(self.ctl("submit", "x/"), INPUT, "not the name of a file")
        self.assertEqual(service.named("submit"), [])

    def test_options(self):
        service = self.accept()
        answer = self.ctl("submit", "/a.fits", "--field", "deep", "--priority", "-5", "--force", "--key", "k1", "--beta",
                          "2.5", "--no-noise-correction", "--filter=edge")
        self.assertCode(answer, DONE)
        self.assertEqual(service.named("submit"), [{
            "path": "/a.fits", "field": "deep", "priority": -5, "force": True, "key": "k1",
            "settings": {"beta": 2.5, "noise-correction": False, "filter": "edge"}}])

    def test_separate_images(self):
        service = self.accept()
        self.touch("odd:1")
        parts = ("--galaxy", "/g.fits:2", "--noise", "/n.fits:SKY", "--psf", self.path("odd:1"))
        answer = self.ctl("submit", *parts)
        self.assertCode(answer, DONE)
        self.assertCode(self.ctl("submit", *parts, "--catalog", "/t.fits:STARS"), DONE)
        images = {"galaxy": {"path": "/g.fits", "hdu": 2}, "noise": {"path": "/n.fits", "extname": "SKY"},
                  "psf": {"path": self.path("odd:1")}}
        self.assertEqual(service.named("submit"),
                         [images, {**images, "catalog": {"path": "/t.fits", "extname": "STARS"}}])
        self.assertIn("/g.fits:2 + noise, psf", answer.out)

    def test_job_files(self):
        service = self.accept()
        with open(self.path("j.json"), "w", encoding="utf-8") as file:
            json.dump({"path": "/a.fits", "field": "f", "priority": 3, "wait": True,
                       "settings": {"beta": 2.5, "filter": "edge"}}, file, indent=2)
        self.assertCode(self.ctl("submit", self.path("j.json"), "--priority", "0", "--filter", "none"), DONE)
        process = subprocess.run([SHEARCTL, "submit", "-", "--field", "g"], input=b'{"path": "/b.fits", "force": true}',
                                 capture_output=True, check=False,
                                 env={**os.environ, **SANITIZERS, "SHEARD_SOCKET": self.socket})
        self.assertEqual(process.returncode, DONE, process.stderr)
        self.assertEqual(service.named("submit"), [
            {"path": "/a.fits", "field": "f", "settings": {"beta": 2.5, "filter": "none"}},
            {"path": "/b.fits", "field": "g", "force": True}])

    def test_bad_job_files(self):
        service = self.accept()
        for text, word in (("{", "j.json"), ("[]", "object"), ('{"path": "/a", "colour": 1}', "colour"),
                           ('{"path": "a.fits"}', "path"), ("{}", "path"), ('{"path": "/a", "priority": 1000}', "priority"),
                           (" " * 70000 + "{}", "65536")):
            with open(self.path("j.json"), "w", encoding="utf-8") as file:
                file.write(text)
            with self.subTest(text=text[:40]):
                self.assertFails(self.ctl("submit", self.path("j.json")), INPUT, word)
        self.assertFails(self.ctl("submit", self.path("none.json")), INPUT, "none.json")
        self.assertEqual(service.named("submit"), [])

    def test_json(self):
        self.accept()
        answer = self.ctl("submit", "--json", "/a.fits", "/b.fits")
        self.assertCode(answer, DONE)
        self.assertEqual([r["job"]["id"] for r in answer.json()], [1, 2])

    def test_known_by_its_key(self):
        self.serve(submit={"job": job(7), "known": True})
        self.assertIn("job 7 done (known by its key)", self.ctl("submit", "--key", "k", "/a.fits").out)

    def test_refused(self):
        for code, retry, exit_code in (("queue_full", True, OTHER), ("outside_roots", False, INPUT),
                                       ("not_readable", False, INPUT), ("no_such_file", False, INPUT),
                                       ("bad_setting", False, USAGE), ("draining", True, OTHER),
                                       ("stopping", True, UNREACHABLE), ("of_a_later_version", False, OTHER)):
            def refuse(_params, _connection, code=code, retry=retry):
                raise Refusal(code, "because", "so do this", retry=retry)
            with self.subTest(code=code):
                service = FakeService(self.socket, submit=refuse)
                answer = self.ctl("submit", "/a.fits")
                service.close()
                self.assertFails(answer, exit_code, "/a.fits: because", f"[{code}]", "so do this")

    def test_some_refused(self):
        def some(params, _connection):
            if params["path"] == "/b.fits":
                raise Refusal("no_such_file", "not there")
            return {"job": job(1, "queued"), "known": False}
        service = self.serve(submit=some)
        answer = self.ctl("submit", "/a.fits", "/b.fits", "/c.fits")
        self.assertFails(answer, PARTLY, "/b.fits")
        self.assertEqual(len(service.named("submit")), 3)

    def test_a_full_queue_stops_the_rest(self):
        def full(_params, _connection):
            raise Refusal("queue_full", "full", retry=True)
        service = self.serve(submit=full)
        self.assertFails(self.ctl("submit", "/a.fits", "/b.fits", "/c.fits"), OTHER, "2 more files were not submitted")
        self.assertEqual(len(service.named("submit")), 1)

    def test_wait(self):
        service = self.accept(wait=lambda p, c: {"jobs": [job(i) for i in p["ids"]], "timed_out": False})
        answer = self.ctl("submit", "--wait", "/a.fits", "/b.fits")
        self.assertCode(answer, DONE)
        self.assertEqual([p["ids"] for p in service.named("wait")], [[1, 2]])
        self.assertNotIn("wait", service.named("submit")[0])
        self.assertRegex(answer.out, r"(?m)^ *2 +done +deep +\+0\.02850 \+- 0\.00080 +-0\.03010 \+- 0\.00090 +990 +1000 ")

    def test_wait_json(self):
        self.accept(wait=lambda p, c: {"jobs": [failed(1)], "timed_out": False},
                    job=lambda p, c: {"job": failed(p["id"]), "history": []})
        answer = self.ctl("submit", "--wait", "--json", "/a.fits")
        self.assertCode(answer, JOB_FAILED)
        self.assertEqual([(r["job"]["id"], r["history"]) for r in answer.json()], [(1, [])])

    def test_wait_and_some_refused(self):
        def some(params, _connection):
            if params["path"] == "/b.fits":
                raise Refusal("no_such_file", "not there")
            return {"job": job(1, "queued"), "known": False}
        self.serve(submit=some, wait={"jobs": [job(1)], "timed_out": False})
        self.assertFails(self.ctl("submit", "--wait", "/a.fits", "/b.fits"), PARTLY, "/b.fits")


if __name__ == "__main__":
    unittest.main()
