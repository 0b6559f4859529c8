# SPDX-License-Identifier: GPL-3.0-or-later
"""The completions in the shells that use them: an interactive zsh on a pseudo terminal, and bash.
COMPLETIONS in the environment is the directory that they were made in."""
import os
import pty
import select
import shutil
import subprocess
import time
import unittest

from fake_service import job, summary
from service_test import ServiceTest
from tool import SANITIZERS, SHEARCTL, ToolTest

COMPLETIONS = os.path.abspath(os.environ["COMPLETIONS"])
WAIT = 120  # seconds, for what takes less than one

# What compadd is given goes to the file $HITS, a line each; ^X^E writes the line that is edited.
ZSHRC = r"""
fpath=($COMPLETIONS $fpath)
PS1='ready> '
zstyle ':completion:*' list-prompt ''
LISTMAX=100000
autoload -Uz compinit && compinit -u -D
compadd() {
    local -a hits
    if [[ ${@[1,(i)(-|--)]} != *-(O|A|D)\ * ]]; then
        builtin compadd -A hits "$@"
        print -rl -- $hits >> $HITS
    fi
    builtin compadd "$@"
}
tell() { print -r -- "line:$BUFFER" >> $HITS }
zle -N tell
bindkey '^X^E' tell
"""


class Zsh:
    """An interactive zsh that has loaded the completion."""

    def __init__(self, directory, env):
        self.hits = os.path.join(directory, "hits")
        with open(os.path.join(directory, ".zshrc"), "w", encoding="utf-8") as f:
            f.write(ZSHRC)
        os.makedirs(os.path.join(directory, "bin"))
        os.symlink(SHEARCTL, os.path.join(directory, "bin", "shearctl"))
        self.main, other = pty.openpty()
        subprocess.run(["stty", "cols", "200", "rows", "50"], stdin=other, check=True)
        self.process = subprocess.Popen(
            ["zsh", "-i"], stdin=other, stdout=other, stderr=other, cwd=directory, start_new_session=True,
            env={**os.environ, **SANITIZERS, "ZDOTDIR": directory, "TERM": "xterm", "HITS": self.hits,
                 "COMPLETIONS": COMPLETIONS, "PATH": directory + "/bin:" + os.environ["PATH"], **env})
        os.close(other)
        self.read(b"ready> ")

    def read(self, until):
        """What it shows, up to `until`."""
        text, end = b"", time.monotonic() + WAIT
        while until not in text:
            if time.monotonic() > end:
                raise AssertionError(f"zsh does not show {until}: {text}")
            if select.select([self.main], [], [], 0.1)[0]:
                text += os.read(self.main, 65536)
        return text

    def drain(self):
        while select.select([self.main], [], [], 0)[0]:
            os.read(self.main, 65536)

    def complete(self, line):
        """(candidates, the line afterwards) of `line` and the tabulator."""
        open(self.hits, "w", encoding="utf-8").close()
        os.write(self.main, line.encode() + b"\t\x18\x05")
        end = time.monotonic() + WAIT
        while True:
            self.drain()
            with open(self.hits, encoding="utf-8") as f:
                lines = f.read().splitlines()
            if lines and lines[-1].startswith("line:"):
                break
            if time.monotonic() > end:
                raise AssertionError(f"zsh does not answer: {lines}")
            time.sleep(0.01)
        os.write(self.main, b"\x15")  # kill the line
        return sorted(set(h for h in lines[:-1] if h)), lines[-1][5:]

    def close(self):
        os.write(self.main, b"\x15exit\n")
        end = time.monotonic() + WAIT
        while self.process.poll() is None and time.monotonic() < end:
            try:
                self.drain()
            except OSError:  # Linux's end of a pseudo terminal
                pass
            time.sleep(0.01)
        self.process.kill()
        self.process.wait()
        os.close(self.main)


@unittest.skipUnless(shutil.which("zsh"), "no zsh")
class ZshCompletion(ServiceTest):
    def setUp(self):
        super().setUp()
        self.serve(jobs={"jobs": [job(7), job(12)], "cursor": None},
                   fields={"fields": [summary("deep"), summary("wide")], "cursor": None})
        for name in ("a.fits", "b.fits"):
            self.touch(name)
        self.zsh = Zsh(self.directory, {"SHEARD_SOCKET": self.socket})
        self.addCleanup(self.zsh.close)

    def names(self, kind, command=None):
        """What the tool says of itself: names of commands, or options of one."""
        out = subprocess.run([SHEARCTL, "help", "--completion-data"], check=True, capture_output=True,
                             encoding="utf-8").stdout
        rows = [line.split("|") for line in out.splitlines()]
        return sorted({row[2 if command else 1] for row in rows
                       if row[0] == kind and command in (None, row[1])})

    def test_subcommands(self):
        found, _ = self.zsh.complete("shearctl ")
        self.assertEqual(found, self.names("command"))
        self.assertIn("measure", found)
        self.assertEqual(self.zsh.complete("shearctl measu")[1], "shearctl measure ")

    def test_options(self):
        for command in ("measure", "submit", "watch"):
            with self.subTest(command=command):
                found, _ = self.zsh.complete(f"shearctl {command} --")
                self.assertEqual([name.rstrip("=") for name in found],
                                 self.names("option", command))
        self.assertEqual(self.zsh.complete("shearctl measure --inter")[1],
                         "shearctl measure --interpolation=")

    def test_values(self):
        found, _ = self.zsh.complete("shearctl measure --filter=")
        self.assertEqual(found, ["auto", "edge", "none", "paper", "r-gal"])
        self.assertEqual(self.zsh.complete("shearctl measure --zeros sk")[1],
                         "shearctl measure --zeros skip ")
        found, _ = self.zsh.complete("shearctl jobs --state=")
        self.assertEqual(found, ["cancelled", "done", "failed", "queued", "retracted",
                                 "running", "waiting"])

    def test_files(self):
        found, _ = self.zsh.complete("shearctl measure ")
        self.assertTrue({"a.fits", "b.fits"} <= set(found), found)
        self.assertEqual(self.zsh.complete("shearctl measure a")[1], "shearctl measure a.fits ")

    def test_what_the_service_knows(self):
        self.assertEqual(self.zsh.complete("shearctl show ")[0], ["12", "7"])
        self.assertEqual(self.zsh.complete("shearctl field de")[1], "shearctl field deep ")


class BashCompletion(ToolTest):
    def complete(self, *words):
        """Candidates of bash for these words, the last one unfinished."""
        script = ('. "$COMPLETIONS/shearctl"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
                  'COMP_LINE="$*"; COMP_POINT=${#COMP_LINE}; '
                  'name=$(complete -p shearctl | sed "s/.*-F \\([^ ]*\\).*/\\1/"); '
                  '"$name" shearctl "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD-1]}"; '
                  'printf "%s\\n" "${COMPREPLY[@]}"')
        out = subprocess.run(["bash", "-c", script, "bash", "shearctl", *words], check=True,
                             capture_output=True, encoding="utf-8", cwd=self.directory,
                             env={**os.environ, **SANITIZERS, "COMPLETIONS": COMPLETIONS}).stdout
        return sorted(word.strip() for word in out.splitlines() if word.strip())

    def test_subcommands_options_and_values(self):
        self.assertEqual(self.complete("measu"), ["measure"])
        self.assertIn("submit", self.complete(""))
        self.assertIn("--interpolation", [w.rstrip("=") for w in self.complete("measure", "--inter")])
        self.assertEqual(self.complete("measure", "--zeros", "sk"), ["skip"])


if __name__ == "__main__":
    unittest.main()
