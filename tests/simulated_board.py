"""A board that fp3 board simulates, for what drives boards."""

import contextlib
import subprocess


@contextlib.contextmanager
def board(fp3, *arguments):
    """A simulated board: the process, and the name of its port."""
    process = subprocess.Popen([fp3, "board", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        yield process, process.stdout.readline().strip()
    finally:
        process.kill()
        process.communicate()
