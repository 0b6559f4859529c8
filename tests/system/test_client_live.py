# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables, bars and the live picture of a service on a (pseudo) terminal."""
import os
import re
import signal
import subprocess
import threading
import time
import unittest

from fake_service import Refusal, failed, job, send, status, summary
from service_test import ServiceTest
from terminal_test import TerminalTest
from tool import DONE


class OnATerminal(ServiceTest, TerminalTest):
    def start_service(self, *args, **how):
        """shearctl with all three streams on a terminal."""
        return self.start(*args, **{"columns": 100, "rows": 30, "streams": ("stdin", "stdout", "stderr"), **how},
                          env={"LC_ALL": "C.UTF-8", "SHEARD_SOCKET": self.socket, "NO_COLOR": ""})

    def test_tables_have_colours_and_fit(self):
        self.serve(jobs={"jobs": [job(1), failed(2, source={"path": "/" + "long/" * 40})], "cursor": None})
        process, main = self.start_service("jobs", columns=60)
        text = self.read(main)
        self.assertEqual(process.wait(120), DONE)
        self.assertIn("\x1b[32mdone\x1b[0m", text)
        plain = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", text)
        self.assertLessEqual(max(map(len, plain.splitlines())), 60)

    def test_wait_shows_a_bar_from_notifications(self):
        go = threading.Event()

        def wait(_params, connection):
            for done in (100, 500, 900):
                send(connection, {"jsonrpc": "2.0", "method": "job_progress", "params": {
                    "id": 1, "progress": {"done": done, "total": 1000, "rate": 100.0, "eta_s": 1.0}}})
                time.sleep(0.15)
            go.wait(120)
            return {"jobs": [job(1)], "timed_out": False}
        service = self.serve(subscribe={"jobs": 1, "fields": 0, "all": False}, wait=wait)
        process, main = self.start_service("wait", "1")
        text = self.read(main, until=" 90% 100 stamps/s 0:01 left")
        go.set()
        text += self.read(main)
        self.assertEqual(process.wait(120), DONE)
        self.assertRegex(text, r"job 1 \[#+\.+\]")
        self.assertEqual(service.named("subscribe"), [{"jobs": [1], "progress": True}])

    def test_wait_polls_where_it_may_not_subscribe(self):
        left = [3]

        def wait(_params, _connection):
            left[0] -= 1
            time.sleep(0.15)
            return {"jobs": [job(1, "running" if left[0] else "done")], "timed_out": left[0] > 0}

        def refuse(_params, _connection):
            raise Refusal("too_many_subscriptions")
        service = self.serve(subscribe=refuse, wait=wait)
        process, main = self.start_service("wait", "1")
        text = self.read(main)
        self.assertEqual(process.wait(120), DONE)
        self.assertIn(" 25% 500 stamps/s 0:01 left", text)
        self.assertEqual([p["timeout_s"] for p in service.named("wait")], [1, 1, 1])

    def watched(self, **other):
        return self.serve(**{"status": status(), "jobs": lambda p, c: {"jobs": [job(1, "running")], "cursor": None},
                             "fields": {"fields": [summary()], "cursor": None}, **other})

    def test_watch_and_q(self):
        self.watched()
        process, main = self.start_service("watch", "--interval", "100ms")
        text = self.read(main, until="q ends")
        self.assertIn("\x1b[?1049h", text)
        os.write(main, b"q")
        text = self.read(main)
        self.assertEqual(process.wait(120), DONE)
        self.assertTrue(text.rstrip().endswith("\x1b[?1049l"), text[-40:])

    def test_watch_and_signals(self):
        self.watched()
        for number in (signal.SIGINT, signal.SIGTERM):
            process, main = self.start_service("watch", "--interval", "1h")
            self.read(main, until="q ends")
            process.send_signal(number)
            self.assertIn("\x1b[?1049l", self.read(main))
            self.assertEqual(process.wait(120), DONE)

    def test_watch_resizes(self):
        self.watched()
        process, main = self.start_service("watch", "--interval", "1h", columns=200)
        wide = self.read(main, until="\x1b[J")  # the end of a picture
        subprocess.run(["stty", "cols", "40", "rows", "10"], stdin=main, check=True)
        process.send_signal(signal.SIGWINCH)
        text = self.read(main, until="\x1b[J")
        os.write(main, b"q")
        process.wait(120)
        plain = [re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", line) for line in text.split("\r\n")]
        self.assertLessEqual(max(map(len, plain)), 40)
        self.assertLessEqual(len(plain), 10)
        self.assertGreater(len(wide), len(text))

    def test_watch_waits_for_a_service_that_went_away(self):
        service = self.watched()
        process, main = self.start_service("watch", "--interval", "100ms")
        self.read(main, until="q ends")
        service.close()
        self.read(main, until="no socket")
        self.watched()
        self.read(main, until="3 of 4 busy")
        os.write(main, b"q")
        self.assertEqual(process.wait(120), DONE)

    def test_watch_ends_while_the_service_is_silent(self):
        stop = threading.Event()
        self.addCleanup(stop.set)
        asked = threading.Event()
        self.watched(status=lambda p, c: asked.set() or stop.wait(60))
        process, _ = self.start_service("watch")
        self.assertTrue(asked.wait(120))
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(120), DONE)


if __name__ == "__main__":
    unittest.main()
