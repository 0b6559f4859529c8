# SPDX-License-Identifier: GPL-3.0-or-later
"""shearctl wait."""
import os
import signal
import subprocess
import threading
import time
import unittest

from fake_service import HANG_UP, Refusal, failed, job
from service_test import CANCELLED, JOB_FAILED, SLOW, TIMED_OUT, UNREACHABLE, ServiceTest
from tool import DONE, INPUT, OTHER, PARTLY, SANITIZERS, SHEARCTL


class Wait(ServiceTest):
    def ended(self, *jobs):
        return self.serve(wait={"jobs": jobs, "timed_out": False})

    def test_exit_codes(self):
        cancelled = job(3, "cancelled")
        for jobs, code in (([job(1)], DONE), ([failed(1)], JOB_FAILED), ([failed(1), failed(2)], JOB_FAILED),
                           ([job(1), failed(2)], PARTLY), ([cancelled], CANCELLED), ([job(1), cancelled], PARTLY),
                           ([failed(1), cancelled], JOB_FAILED)):
            service = self.ended(*jobs)
            answer = self.ctl("wait", *(str(j["id"]) for j in jobs))
            service.close()
            with self.subTest(states=[j["state"] for j in jobs]):
                self.assertCode(answer, code)
                self.assertEqual(len(answer.out.splitlines()), 1 + len(jobs))

    def test_a_failure_is_explained(self):
        self.ended(failed(4))
        self.assertFails(self.ctl("wait", "4"), JOB_FAILED, "job 4 failed: GALAXY: no such HDU [bad_file]",
                         "look into the file")

    def test_timeout(self):
        self.serve(wait=lambda p, c: time.sleep(p["timeout_s"]) or {"jobs": [job(1, "running")], "timed_out": True})
        answer = self.ctl("wait", "1", "--timeout", "200ms")
        self.assertFails(answer, TIMED_OUT, "job 1 is not finished: running")
        self.assertGreaterEqual(answer.seconds, 0.2)
        self.assertLess(answer.seconds, SLOW)

    def test_the_services_own_timeout_is_not_ours(self):
        left = [3]

        def wait(_params, _connection):
            left[0] -= 1
            return {"jobs": [job(1, "running" if left[0] else "done")], "timed_out": left[0] > 0}
        service = self.serve(wait=wait)
        self.assertCode(self.ctl("wait", "1"), DONE)
        self.assertEqual(len(service.named("wait")), 3)

    def test_hundreds_of_jobs(self):
        service = self.serve(wait=lambda p, c: {"jobs": [job(i) for i in p["ids"]], "timed_out": False})
        answer = self.ctl("wait", "--json", *map(str, range(1, 601)))
        self.assertCode(answer, DONE)
        self.assertEqual([len(p["ids"]) for p in service.named("wait")], [256, 256, 88])
        self.assertEqual([j["id"] for line in answer.json() for j in line["jobs"]], list(range(1, 601)))

    def test_no_such_job(self):
        def wait(_params, _connection):
            raise Refusal("no_such_job", "there is no job 9")
        self.serve(wait=wait)
        self.assertFails(self.ctl("wait", "9"), INPUT, "no job 9")

    def test_the_service_dies(self):
        self.serve(wait=lambda p, c: HANG_UP)
        self.assertFails(self.ctl("wait", "1"), UNREACHABLE, "closed the connection", "go on")

    def test_interrupt(self):
        asked, stop = threading.Event(), threading.Event()
        self.addCleanup(stop.set)
        self.serve(wait=lambda p, c: asked.set() or stop.wait(60))
        process = subprocess.Popen([SHEARCTL, "wait", "1"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env={**os.environ, **SANITIZERS, "SHEARD_SOCKET": self.socket})
        self.assertTrue(asked.wait(120))
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, OTHER)
        self.assertIn("the jobs go on", err)


if __name__ == "__main__":
    unittest.main()
