# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl status, metrics, drain, reload, shutdown, and watch in lines."""
import unittest

from fake_service import HANG_UP, Refusal, failed, job, status, summary
from service_test import UNREACHABLE, ServiceTest
from tool import DONE, OTHER


class State(ServiceTest):
    def test_status(self):
        self.serve(status=status(state="draining", problems=["the disk is nearly full"]))
        answer = self.ctl("status")
        self.assertCode(answer, DONE)
        for words in ("sheard 0.1.0  draining  pid 4711  up 2 h 03 min", "queued 9  running 2  waiting 1  done 40  failed 3",
                      "12 of 1000 unfinished", "3 of 4 busy", "12345/s stamps, 0.25/s jobs", "5.0 GiB free", "2.0 MiB",
                      "problem    the disk is nearly full", "started    2026-01-31 14:00:00"):
            self.assertIn(words, answer.out)

    def test_status_without_a_spool(self):
        self.serve(status=status(spool=None))
        self.assertRegex(self.ctl("status").out, r"(?m)^  spool      none$")

    def test_metrics(self):
        self.serve(metrics={"content_type": "text/plain", "text": "# HELP a b\na 1\n"})
        self.assertEqual(self.ctl("metrics").out, "# HELP a b\na 1\n")

    def test_drain_reload_shutdown(self):
        service = self.serve(drain={"state": "draining", "running": 2, "queued": 5},
                             reload={"changed": ["limits.queue"], "restart": ["daemon.workers"],
                                     "warnings": ["data root /d is missing"]},
                             shutdown={"state": "stopping", "running": 1, "queued": 0})
        self.assertEqual(self.ctl("drain").out, "draining: 2 jobs running, 5 wait for the next start\n")
        self.assertEqual(self.ctl("reload").out, "changed: limits.queue\nneeds a restart: daemon.workers\n"
                         "warning: data root /d is missing\n")
        self.assertIn("stopping", self.ctl("shutdown", "--now", "--timeout", "2min").out)
        self.assertEqual(service.named("shutdown"), [{"mode": "now", "timeout_s": 120}])

    def test_shutdown_tells_who_starts_it_again(self):
        stopping = {"state": "stopping", "running": 0, "queued": 0}
        self.serve(status=status(activated=True), shutdown=stopping)
        self.assertIn("systemctl stop sheard.service", self.ctl("shutdown").out)
        self.assertEqual(self.ctl("shutdown", "--json").json(), [stopping])

    def test_shutdown_of_a_service_of_its_own_socket(self):
        self.serve(status=status(), shutdown={"state": "stopping", "running": 0, "queued": 0})
        self.assertNotIn("systemctl", self.ctl("shutdown").out)

    def test_not_admin(self):
        def refuse(_params, _connection):
            raise Refusal("not_admin", "you are no administrator")
        self.serve(drain=refuse, reload=refuse, shutdown=refuse)
        for name in ("drain", "reload", "shutdown"):
            self.assertFails(self.ctl(name), OTHER, "you are no administrator", "not_admin")

    def test_watch_lines(self):
        service = self.serve(status=status(), jobs=lambda p, c: {"jobs": [job(1, "running")] if p["states"] == ["running"]
                             else [job(2), failed(3)], "cursor": None},
                             fields={"fields": [summary("deep"), summary("deeper")], "cursor": None})
        answer = self.ctl("watch", "--count", "2", "--interval", "50ms")
        self.assertCode(answer, DONE)
        self.assertNotIn("\x1b", answer.out)
        self.assertEqual(answer.out.count("3 of 4 busy"), 2)
        self.assertRegex(answer.out, r"\[#####\.+\] +25% 500 stamps/s 0:01 left")
        self.assertNotIn("deeper", answer.out)  # begins alike, but no job's field
        self.assertEqual(len(service.named("hello")), 1)
        lines = self.ctl("watch", "--json", "--count", "3", "--interval", "50ms").json()
        self.assertEqual(len(lines), 3)
        self.assertEqual(lines[0]["status"], status())
        self.assertEqual([sorted(line) for line in lines], [["active", "fields", "finished", "status"]] * 3)

    def test_watch_lines_end_when_the_service_goes(self):
        left = [2]

        def answer(_params, _connection):
            left[0] -= 1
            return status() if left[0] >= 0 else HANG_UP
        self.serve(status=answer, jobs={"jobs": [], "cursor": None})
        self.assertFails(self.ctl("watch", "--json", "--interval", "50ms"), UNREACHABLE, "closed the connection")


if __name__ == "__main__":
    unittest.main()
