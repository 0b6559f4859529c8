# SPDX-License-Identifier: GPL-3.0-or-later
"""An installation of the build directory BUILD by CMAKE, beneath a prefix that was not known when it was built."""
import os
import subprocess

BUILD, CMAKE = os.environ["BUILD"], os.environ["CMAKE"]
CPACK = os.path.join(os.path.dirname(CMAKE), "cpack")


def run(*command, code=0, **more):
    process = subprocess.run(command, capture_output=True, encoding="utf-8", check=False, **more)
    if process.returncode != code:
        raise AssertionError(f"{command} gave {process.returncode}:\n{process.stdout}\n{process.stderr}")
    return process.stdout + process.stderr


def files_of(root):
    return {os.path.relpath(os.path.join(folder, name), root) for folder, _, names in os.walk(root) for name in names}


def installed_and_moved(directory):
    """The prefix, which is not the one that it was installed to."""
    first, prefix = os.path.join(directory, "first"), os.path.join(directory, "prefix")
    run(CMAKE, "--install", BUILD, "--prefix", first)
    os.rename(first, prefix)
    return prefix
