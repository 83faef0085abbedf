"""A run with snapshots, and its rows."""

import csv
import re
import signal
import subprocess
import time

import pytest


class Done:
    """What a run printed, and the rows of its file by name."""

    def __init__(self, done, path):
        self.code, self.stdout, self.stderr = done.returncode, done.stdout, done.stderr
        self.path = path
        self.rows = []
        if path.exists():
            with open(path, newline="", encoding="ascii") as file:
                header, *rows = csv.reader(file)
            self.header = header
            self.names = [name.split(" ")[0] for name in header]
            self.rows = [dict(zip(self.names, row)) for row in rows]

    def of(self, step, object=0):
        return next(row for row in self.rows if row["step"] == str(step) and row["object"] == str(object))

    def printed(self):
        """Words of the final states by name and object."""
        return {(name, int(number)): (value, word) for name, value, word, number in
                re.findall(r"^(\w+) +(\S+) +(0x\w+) +object (\d+)$", self.stdout, re.M)}

    def counter(self, name):
        return int(re.search(rf"^{name} +(\d+)$", self.stdout, re.M)[1])


@pytest.fixture
def start(fp3, root, tmp_path):
    """fp3 run in an empty folder; `code` is the exit code that it should have."""
    def start(program, *arguments, code=0, output="out.csv", **options):
        path = root / "programs" / program
        (tmp_path / "out.csv").unlink(missing_ok=True)
        done = subprocess.run([str(part) for part in [fp3, "run", path if path.exists() else program, *arguments,
                               *(["--output", output] if output else [])]],
                              cwd=tmp_path, capture_output=True, text=True, timeout=300, **options)
        assert done.returncode == code, done.stdout + done.stderr
        return Done(done, tmp_path / "out.csv")
    return start


@pytest.fixture
def killed_while_it_writes(fp3, root, tmp_path):
    """A run that is killed after it has written some rows, and long before its end."""
    def kill(output):
        run = subprocess.Popen([fp3, "run", root / "programs/ship.ode", "-e", "isa", "-n", "4000000000", "--every", "1", "--output", output],
                               cwd=tmp_path, stdout=subprocess.DEVNULL)
        try:
            while run.poll() is None and not any(path.stat().st_size for path in tmp_path.glob(".fp3-*/new")):
                time.sleep(0.02)
        finally:
            run.kill()
        assert run.wait() == -signal.SIGKILL and any(path.stat().st_size for path in tmp_path.glob(".fp3-*/new")), "the run ended before it wrote"
    return kill
