# SPDX-License-Identifier: GPL-3.0-or-later
"""The progress bar on a (pseudo) terminal, and a clean stop when the user interrupts."""
import os
import shlex
import shutil
import signal
import subprocess
import time
import unittest

from fake_service import job, status, summary
from fitsfile import Field
from service_test import ServiceTest
from terminal_test import WAIT, TerminalTest
from tool import DONE, OTHER, SANITIZERS, SHEARCTL


class Terminal(TerminalTest):
    def finish(self, process):
        out = process.stdout.read()
        return process.wait(WAIT), out.decode("utf-8")

    def field(self):
        return Field(n=300, nx=16, ny=16, size=1.0, r_psf=0.8).write(self.path("a.fits"))

    def test_bar_fits_the_terminal_and_is_cleared(self):
        path = self.field()
        for columns in (80, 60, 30):
            with self.subTest(columns=columns):
                process, main = self.start("measure", path, columns=columns)
                text = self.read(main)
                code, out = self.finish(process)
                self.assertEqual(code, DONE)
                self.assertIn("300 of 300 used", out)
                self.assertNotRegex(out, r"\d%|:\d\d left")
                drawn = [line.replace("\x1b[K", "") for line in text.split("\r")]
                self.assertTrue(any("%" in line and "stamps/s" in line for line in drawn), text)
                self.assertLess(max(map(len, drawn)), columns)
                self.assertTrue(text.endswith("\r\x1b[K"), repr(text[-40:]))
                self.assertNotIn("\n", text)

    def test_no_bar_when_quiet_or_on_a_dumb_terminal(self):
        path = self.field()
        for args, term in ((("--quiet",), "xterm"), ((), "dumb")):
            with self.subTest(args=args, term=term):
                process, main = self.start("measure", path, *args, term=term)
                self.assertEqual(self.read(main), "")
                self.assertEqual(self.finish(process)[0], DONE)

    def test_interrupt_leaves_nothing_behind(self):
        # Work for some seconds on any machine: 6000 times a fine grid of 512 x 512.
        slow = Field(n=6000, nx=16, ny=16, size=1.0, r_psf=0.8).write(self.path("a.fits"))
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=number):
                process, main = self.start("measure", slow, "--interpolation", "spline",
                                           "--oversample", "32", "--catalog",
                                           self.path("out.fits"))
                self.read(main, until="%")
                process.send_signal(number)
                code, out = self.finish(process)
                self.assertEqual((code, out), (OTHER, ""))
                self.assertIn("shearctl: error:", self.read(main))
                self.assertEqual(os.listdir(self.directory), ["a.fits"])


@unittest.skipUnless(shutil.which("tmux"), "no tmux")
class InTmux(ServiceTest):
    """`shearctl watch` as a terminal shows it, not as bytes."""

    def tmux(self, *args):
        return subprocess.run(["tmux", "-S", self.path("tmux"), "-f", "/dev/null", *args], check=True,
                              capture_output=True, encoding="utf-8").stdout

    def screen(self):
        return self.tmux("capture-pane", "-p", "-t", "w")

    def until(self, true, what):
        end = time.monotonic() + WAIT
        while not true(text := self.screen()):
            if time.monotonic() > end:
                raise AssertionError(f"{what}:\n{text}")
            time.sleep(0.02)
        return text

    def test_watch(self):
        self.serve(status=status(), fields={"fields": [summary()], "cursor": None},
                   jobs=lambda params, _: {"jobs": [job(7, "running")] if "running" in params["states"] else [job(5)],
                                           "cursor": None})
        environment = {**SANITIZERS, "LC_ALL": "C.UTF-8", "SHEARD_SOCKET": self.socket}
        settings = " ".join(f"{name}={shlex.quote(value)}" for name, value in environment.items())
        self.tmux("new-session", "-d", "-s", "w", "-x", "90", "-y", "30",
                  f"echo before; {settings} {shlex.quote(SHEARCTL)} watch --interval 100ms; echo ended $?; cat")
        self.addCleanup(self.tmux, "kill-server")
        text = self.until(lambda t: "q ends" in t, "the picture")
        for words in ("sheard 0.1.0  running  pid 4711", "\nrunning\n", "7  deep   [#####",
                      "\nfinished\n", "\nfields\n", "3 of 4 busy"):
            self.assertIn(words, text)
        self.assertNotIn("before", text)
        self.assertEqual(text.count("q ends"), 1, "the picture is drawn over the last one")
        self.tmux("resize-window", "-t", "w", "-x", "50", "-y", "12")
        small = self.until(lambda t: len(t.splitlines()) <= 12 and "sheard 0.1.0" in t.splitlines()[0],
                           "the picture of a small window")
        self.assertLessEqual(max(map(len, small.splitlines())), 50)
        self.tmux("resize-window", "-t", "w", "-x", "90", "-y", "30")
        self.until(lambda t: "q ends" in t and "\nfields\n" in t, "the large picture again")
        self.tmux("send-keys", "-t", "w", "q")
        text = self.until(lambda t: "ended 0" in t, "the end")
        self.assertEqual(text.split(), ["before", "ended", "0"], "what was there before is back")


if __name__ == "__main__":
    unittest.main()
