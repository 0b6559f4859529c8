# SPDX-License-Identifier: GPL-3.0-or-later
"""A log that nobody reads: the service works, stops in time, and reports how much was lost."""
import contextlib
import os
import re
import signal
import subprocess
import time
import unittest

from daemon import LIMIT, Client, DaemonTest, until

LINES = 4000  # more than a pipe and the service's buffer hold


class LogTest(DaemonTest):
    def piped(self):
        """A service whose standard error is a pipe, and the end to read from."""
        d = self.daemon({"spool.settle_time": "0s"}, start=False)
        reading, writing = os.pipe()
        self.addCleanup(os.close, reading)
        d.process = subprocess.Popen([d.program, "--config", d.config], env=d.env,
                                     stdin=subprocess.DEVNULL, stdout=writing, stderr=writing)
        os.close(writing)
        open(d.log, "ab").close()
        until(d.ready, "the service answers")
        return d, reading

    def chatter(self, d):
        """Produce thousands of lines: one per file with a wrong name."""
        for i in range(LINES):
            with open(d.folder("incoming", f"{'n' * 150}{i:05d}.txt"), "wb"):
                pass

    def read(self, reading, wanted):
        """What comes out of the pipe, until it matches."""
        os.set_blocking(reading, False)
        text = b""

        def more():
            nonlocal text
            with contextlib.suppress(BlockingIOError):
                while data := os.read(reading, 1 << 16):
                    text += data
            return re.search(wanted, text)
        until(more, f"the log says {wanted}")
        return text.decode()

    def test_nobody_reads(self):
        d, reading = self.piped()
        self.chatter(d)
        with Client(d.socket) as client:
            until(lambda: client.call("status")["log"]["lost"] > 0, "lines are lost")
            longest = 0.0
            for _ in range(50):
                begun = time.monotonic()
                client.call("hello")
                longest = max(longest, time.monotonic() - begun)
            self.assertLess(longest, LIMIT / 10)
            status = client.call("status")
            self.assertGreater(status["log"]["waiting_bytes"], 0)
            problem = [p for p in status["problem_details"] if p["code"] == "log_stalled"]
            self.assertEqual(len(problem), 1, status["problem_details"])
            self.assertIsNotNone(problem[0]["since"])
        text = self.read(reading, rb"lines of the log were lost here")
        lines = [line for line in text.split("\n") if "ignored" in line]
        lost = sum(int(n) for n in re.findall(r"(\d+) lines of the log were lost", text))
        self.assertEqual(len(lines) + lost, LINES)
        self.assertEqual(lost, d.call("status")["log"]["lost"])
        self.assertEqual(d.stop(), 0)

    def test_it_stops_all_the_same(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            with self.subTest(number):
                d, _ = self.piped()
                self.chatter(d)
                until(lambda: d.call("status")["log"]["lost"] > 0, "lines are lost")
                d.signal(number)
                self.assertEqual(d.ended(30), 0)
                for name in os.listdir(d.folder("incoming")):
                    os.unlink(d.folder("incoming", name))

    def test_the_last_line_arrives(self):
        d, reading = self.piped()
        d.signal(signal.SIGTERM)
        self.assertEqual(d.ended(), 0)
        self.assertTrue(self.read(reading, rb"sheard stopped").endswith("sheard stopped\n"))

    def test_its_reader_is_gone(self):
        d = self.daemon(start=False)
        reading, writing = os.pipe()
        os.close(reading)
        d.process = subprocess.Popen([d.program, "--config", d.config], env=d.env,
                                     stdin=subprocess.DEVNULL, stdout=writing, stderr=writing)
        os.close(writing)
        open(d.log, "ab").close()
        until(d.ready, "the service answers")
        self.assertEqual(d.stop(), 0)


if __name__ == "__main__":
    unittest.main()
