# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of shearctl on a (pseudo) terminal share."""
import os
import pty
import select
import subprocess
import time

from tool import SANITIZERS, SHEARCTL, ToolTest

WAIT = 120  # seconds, for what takes less than one


class TerminalTest(ToolTest):
    def start(self, *args, columns=80, rows=24, term="xterm", streams=("stderr",), env=None):
        """shearctl with these of its streams on a terminal of this many columns; (process, the terminal's other end)."""
        main, other = pty.openpty()
        self.addCleanup(os.close, main)
        subprocess.run(["stty", "cols", str(columns), "rows", str(rows)], stdin=other, check=True)
        ends = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, **{name: other for name in streams}}
        process = subprocess.Popen([SHEARCTL, *args], **ends, start_new_session=len(streams) == 3,
                                   env={**os.environ, **SANITIZERS, "TERM": term, **(env or {})})
        if process.stdout:
            self.addCleanup(process.stdout.close)
        os.close(other)
        return process, main

    def read(self, main, until=None):
        """What the terminal was sent, up to the end, or up to `until`, which must come."""
        text, end = b"", time.monotonic() + WAIT
        while time.monotonic() < end and (until is None or until.encode() not in text):
            if not select.select([main], [], [], 0.1)[0]:
                continue
            try:
                piece = os.read(main, 65536)
            except OSError:  # Linux's end of a pseudo terminal
                break
            if not piece:
                break
            text += piece
        shown = text.decode("utf-8", "replace")
        if until is not None:
            self.assertIn(until, shown)
        return shown
