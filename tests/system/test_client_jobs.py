# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl jobs, fields, show, field, cancel and retry."""
import os
import re
import unittest

from fake_service import REPORT, Refusal, failed, job, status, summary
from service_test import ServiceTest
from tool import DONE, INPUT, OTHER, PARTLY


class Lists(ServiceTest):
    def test_jobs(self):
        self.serve(jobs={"jobs": [job(3, "running"), failed(2), job(1, outcome="duplicate", duplicate_of=9)],
                         "cursor": None})
        answer = self.ctl("jobs")
        self.assertCode(answer, DONE)
        self.assertEqual(answer.err, "")
        lines = answer.out.splitlines()
        self.assertRegex(lines[0], r"^ID +STATE +FIELD +DONE +PRIO +USER +AGE +TOOK +SOURCE$")
        self.assertRegex(lines[1], r"^ *3 +running +deep +25% +0 +ann .* /data/3\.fits$")
        self.assertRegex(lines[2], r"^ *2 +failed +deep +bad_file .* 3 min 05 s +/data/2\.fits$")
        self.assertRegex(lines[3], r"^ *1 +done +deep +duplicate ")
        self.assertNotIn("\x1b", answer.out)

    def test_job_filters(self):
        service = self.serve(jobs={"jobs": [], "cursor": None})
        self.assertCode(self.ctl("jobs", "--state", "failed,cancelled", "--field", "deep", "--user", "12345", "--limit",
                                 "7", "--cursor", "c1"), DONE)
        self.assertCode(self.ctl("jobs", "--user", "me"), DONE)
        first, second = service.named("jobs")
        self.assertEqual(sorted(first.pop("states")), ["cancelled", "failed"])
        self.assertEqual(first, {"field": "deep", "owner": 12345, "limit": 7, "cursor": "c1"})
        self.assertEqual(second["owner"], os.getuid())

    def test_job_pages(self):
        def pages(params, _connection):
            first = int(params.get("cursor") or 1000)
            return {"jobs": [job(first - i) for i in range(params.get("limit", 50))],
                    "cursor": str(first - params.get("limit", 50))}
        service = self.serve(jobs=pages)
        answer = self.ctl("jobs", "--limit", "450", "--brief")
        self.assertCode(answer, DONE)
        self.assertEqual(answer.out.split(), [str(i) for i in range(1000, 550, -1)])
        self.assertEqual([p.get("limit", 50) for p in service.named("jobs")], [200, 200, 50])
        self.assertIn("--cursor 550", answer.err)

    def test_empty_pages_end(self):
        self.serve(jobs={"jobs": [], "cursor": "again"}, fields={"fields": [], "cursor": "again"})
        self.assertCode(self.ctl("jobs"), DONE)
        self.assertCode(self.ctl("fields"), DONE)

    def test_fields(self):
        service = self.serve(fields={"fields": [summary("a"), summary("b", partial=True, unfinished=2, mixed=True),
                                                summary("c", g1=None, g1_err=None)], "cursor": None})
        answer = self.ctl("fields", "pre")
        self.assertCode(answer, DONE)
        self.assertEqual(service.named("fields")[0]["prefix"], "pre")
        lines = answer.out.splitlines()
        self.assertRegex(lines[1], r"^a +\+0\.02850 \+- 0\.00080 +-0\.03010 \+- 0\.00090 +990 +1000 +3 +0 ")
        self.assertRegex(lines[2], r"^b .* 2 .* partial settings d1$")
        self.assertRegex(lines[3], r"^c +- ")
        self.assertEqual(self.ctl("fields", "--brief").out, "a\nb\nc\n")

    def test_json_is_what_the_service_said(self):
        page = {"jobs": [job(1)], "cursor": None}
        fields = {"fields": [summary()], "cursor": None}
        self.serve(jobs=page, fields=fields, status=status(), metrics={"content_type": "text/plain", "text": "a 1\n"},
                   job={"job": job(1), "history": []}, cancel=job(1, "cancelled"), retry=job(1, "queued"),
                   drain={"state": "draining", "running": 1, "queued": 2}, reload={"changed": ["a.b"], "restart": []},
                   shutdown={"state": "stopping", "running": 0, "queued": 0},
                   field={"field": "deep", "mixed": False, "rows": []}, new_member={})
        for args, expected in ((["jobs"], page), (["fields"], fields), (["show", "1"], {"job": job(1), "history": []}),
                               (["cancel", "1"], job(1, "cancelled")), (["retry", "1"], job(1, "queued")),
                               (["status"], status()), (["metrics"], {"content_type": "text/plain", "text": "a 1\n"}),
                               (["drain"], {"state": "draining", "running": 1, "queued": 2}),
                               (["reload"], {"changed": ["a.b"], "restart": []}),
                               (["shutdown"], {"state": "stopping", "running": 0, "queued": 0}),
                               (["field", "deep"], {"field": "deep", "mixed": False, "rows": []})):
            with self.subTest(args=args):
                answer = self.ctl(*args, "--json")
                self.assertCode(answer, DONE)
                self.assertEqual(answer.json(), [expected])
                self.assertEqual(answer.err, "")

    def test_hostile_names_do_not_steer_the_terminal(self):
        evil = "a\x1b[2J\x9b31m\n\r\x07b"
        self.serve(jobs={"jobs": [job(1, field=evil, user=evil)], "cursor": None},
                   fields={"fields": [summary(evil)], "cursor": None}, job={"job": job(1, field=evil), "history": []},
                   status=status(version=evil, problems=[evil]))
        for args in (["jobs"], ["fields"], ["show", "1"], ["status"]):
            with self.subTest(args=args):
                answer = self.ctl(*args, env={"LC_ALL": "C.UTF-8"})
                self.assertCode(answer, DONE)
                self.assertEqual(re.findall(r"[\x00-\x09\x0b-\x1f\x7f-\x9f]", answer.out), [])


class One(ServiceTest):
    def test_show(self):
        history = [{"number": 1, "started": "2026-01-31T12:00:01.000Z", "ended": "2026-01-31T12:00:02.500Z",
                    "ending": "failed", "class": "transient", "code": "disk_full", "message": "full"}]
        self.serve(job={"job": job(1, settings={"beta": 2.5, "filter": "edge"}, key="k1"), "history": history})
        answer = self.ctl("show", "1")
        self.assertCode(answer, DONE)
        for line in (r"job 1  done", r"  field      deep", r"  file       /data/1\.fits",
                     r"  stamps     990 of 1000 used \(10 galaxy_not_finite\)", r"  g1         \+0\.02850 \+- 0\.00080",
                     r"  submitted  2026-01-31 14:00:00 by ann \(socket\)", r"  key        k1",
                     r"  finished   2026-01-31 14:03:06 \(took 3 min 05 s\)", r"  warning    the borders are bright",
                     r"  settings   beta=2\.5 filter=edge",
                     r"  attempt    1: 2026-01-31 14:00:01, failed after 1\.5 s, disk_full"):
            self.assertRegex(answer.out, rf"(?m)^{line}$")
        self.assertIn("2026-01-31 12:00:00Z", self.ctl("show", "--utc", "1").out)

    def test_show_failed_and_waiting_and_running(self):
        jobs = {1: failed(1), 2: job(2, "waiting", code="disk_full", message="full", not_before="2026-01-31T13:00:00.000Z",
                                     **{"class": "transient"}), 3: job(3, "running", cancel_asked=True),
                4: job(4, outcome="duplicate", duplicate_of=2)}
        self.serve(job=lambda p, c: {"job": jobs[p["id"]], "history": []})
        text = self.ctl("show", "1", "2", "3", "4").out
        for words in ("bad_file (data): GALAXY: no such HDU", "advice     look into the file", "not before 2026-01-31 15:00",
                      "running (being cancelled)", " 25% 500 stamps/s 0:01 left", "duplicate of job 2"):
            self.assertIn(words, text)

    def test_several_and_some_missing(self):
        def find(params, _connection):
            if params["id"] == 2:
                raise Refusal("no_such_job", "there is no job 2")
            return {"job": job(params["id"]), "history": []}
        service = self.serve(job=find)
        self.assertFails(self.ctl("show", "1", "2", "3"), PARTLY, "no job 2")
        self.assertEqual(len(service.named("job")), 3)
        self.assertFails(self.ctl("show", "2"), INPUT, "no job 2")

    def test_cancel_and_retry(self):
        def refuse(_params, _connection):
            raise Refusal("not_owner", "job 1 is ann's", "ask ann")
        service = self.serve(cancel=lambda p, c: job(p["id"], "running", cancel_asked=True), retry=refuse)
        answer = self.ctl("cancel", "4", "5")
        self.assertCode(answer, DONE)
        self.assertEqual(answer.out, "job 4 running, being cancelled\njob 5 running, being cancelled\n")
        self.assertFails(self.ctl("retry", "1"), OTHER, "job 1 is ann's", "ask ann", "not_owner")
        self.assertEqual(service.named("cancel"), [{"id": 4}, {"id": 5}])

    def test_field(self):
        row = {**REPORT, "digest": "d1", "jobs": 3, "unfinished": 2, "partial": True, "running": [31, 32],
               "updated": "2026-01-31T12:03:06.000Z", "more": True,
               "contributions": [{"id": 5, "job": 4, "checksum": "c4", "n_stamps": 100, "n_used": 99,
                                  "counted": "2026-01-31T12:03:06.000Z"}]}
        service = self.serve(field={"field": "deep", "mixed": True, "rows": [row, {**row, "digest": "d2"}]})
        answer = self.ctl("field", "deep")
        self.assertCode(answer, DONE)
        self.assertEqual(answer.out.count("field deep  (partial: more is to come)\n"), 2)
        self.assertIn("3 counted, 2 to come (running: 31, 32)", answer.out)
        self.assertIn("kept apart", answer.err)
        self.assertRegex(self.ctl("field", "deep", "--jobs").out, r"(?m)^ +5 +4 +99 +100 +2026-01-31 14:03:06 +c4$")
        self.ctl("field", "deep", "--digest", "d2", "--after", "5", "--limit", "3")
        self.assertEqual(service.named("field"), [{"field": "deep"}, {"field": "deep"},
                                                  {"field": "deep", "digest": "d2", "after": 5, "limit": 3}])

    def test_no_such_field(self):
        def refuse(_params, _connection):
            raise Refusal("no_such_field", "there is no field x")
        self.serve(field=refuse)
        self.assertFails(self.ctl("field", "x"), INPUT, "no field x")


if __name__ == "__main__":
    unittest.main()
