# SPDX-License-Identifier: GPL-3.0-or-later
"""Names from outside: no control character and no invisible one reaches a terminal or the log,
whichever program prints it."""
import json
import os
import shutil
import subprocess
import unicodedata
import unittest

from daemon import DaemonTest, mock, until
from tool import SHEARCTL

# What a name may hold that a terminal must not see.
BAD = ["\u202e", "\u2066", "\u200f", "\u061c", "\u200b", "\u2028", "\x1b[31m", "\x07", "\u009b31m",
       "\u00ad", "\ufeff", "\udcff"]
UTF8 = {"LC_ALL": "C.UTF-8", "COLUMNS": "300"}


class Names(DaemonTest):
    def assertClean(self, data, where):
        text = data.decode("utf-8")  # and no broken UTF-8
        for c in text:
            self.assertFalse(c != "\n" and unicodedata.category(c) in ("Cc", "Cf", "Zl", "Zp", "Cs"),
                             f"U+{ord(c):04X} in {where}: {text!r}")

    def run_tool(self, *arguments):
        """Both streams must be clean; the exit code and standard output."""
        run = subprocess.run([SHEARCTL, *arguments], capture_output=True, timeout=120,
                             stdin=subprocess.DEVNULL, env={**os.environ, **UTF8})
        self.assertClean(run.stdout, f"output of {arguments[0]}")
        self.assertClean(run.stderr, f"errors of {arguments[0]}")
        return run.returncode, run.stdout.decode()

    def names(self):
        return [f"a{c}b\u00e4{i}.fits" for i, c in enumerate(BAD)]

    def files(self, directory):
        good = mock(os.path.join(self.directory, "good.fits"), 4, 24)
        for name in self.names():
            path = os.path.join(directory, name)
            shutil.copyfile(good, os.fsencode(path))
            yield path

    def test_commands_without_service(self):
        for path in self.files(self.directory):
            self.assertEqual(self.run_tool("measure", "--field", "x", path)[0], 0)
            self.run_tool("measure", path)
            self.run_tool("measure", "--json", "--field", "x", path)
            self.run_tool("measure", path + "-none")
            self.run_tool("measure", "--galaxy", path + ":9", "--noise", path, "--psf", path)
            self.run_tool("measure", "--catalog", path, "--field", "x", path)
            self.run_tool("validate", path)
            self.run_tool("validate", "--json", path)
            self.run_tool("plot", "--output", path + ".pdf", path)
            self.run_tool("plot", path + "-none")
            self.run_tool("mock", "--stamps", "2", "--size", "16", path + ".mock.fits")
            self.run_tool("mock", "--stamps", "2", path + "/none/x.fits")
            self.run_tool("measure", "--beta", path, path)
            self.run_tool("submit", "--socket", path, path)
            self.run_tool("jobs", "--socket", path)
            self.run_tool("doctor", "--config", path)
            self.run_tool(path)

    def test_service(self):
        d = self.daemon()
        socket = ("--socket", d.socket)
        paths = list(self.files(d.data))
        for i, path in enumerate(paths):
            spool_name = os.path.basename(path)
            with open(os.fsencode(d.folder("incoming", "." + spool_name)), "wb") as f:
                f.write(b"no FITS")
            os.rename(os.fsencode(d.folder("incoming", "." + spool_name)),
                      os.fsencode(d.folder("incoming", spool_name)))
            self.run_tool("submit", *socket, "--force", path)
            self.run_tool("submit", *socket, "--force", "--json", "--field", f"f{i}", path)
            self.run_tool("submit", *socket, path + "-none")
        until(lambda: not any(d.call("status")["states"][s] for s in ("queued", "running", "waiting")),
              "the jobs have ended")
        for job in d.jobs():
            self.run_tool("show", *socket, str(job["id"]))
            self.run_tool("show", *socket, "--json", str(job["id"]))
        for command in (["jobs"], ["jobs", "--json"], ["status"], ["status", "--json"], ["fields"],
                        ["metrics"], ["doctor"], ["watch", "--count", "1", "--interval", "100ms"],
                        ["watch", "--count", "1", "--interval", "100ms", "--json"], ["field", "f0"],
                        ["wait", "1", "2"], ["retry", "1"], ["cancel", "1"],
                        ["jobs", "--field", BAD[0]], ["field", BAD[0]]):
            self.run_tool(command[0], *socket, *command[1:])
        with open(d.log, "rb") as f:
            self.assertClean(f.read(), "the log")
        for folder in ("failed", "done", "incoming"):
            for name in os.listdir(os.fsencode(d.folder(folder))):
                if name.endswith(b".json"):
                    with open(os.path.join(os.fsencode(d.folder(folder)), name), "rb") as f:
                        content = f.read()
                    self.assertClean(content, "a side file")
                    json.loads(content)

    def test_rate_counts_stamps(self):
        """A turn is 16 stamps; a file may have fewer."""
        d = self.daemon()
        job = d.submit(mock(os.path.join(d.data, "few.fits"), 3, 24))["id"]
        d.wait_state(job, "done")
        seen = until(lambda: d.call("status")["rates"]["stamps_per_s"], "a rate")
        self.assertLessEqual(seen, 3.0)  # of seconds that are whole


if __name__ == "__main__":
    unittest.main()
