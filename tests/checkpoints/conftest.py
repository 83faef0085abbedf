"""Runs that write checkpoints, are cut off, and go on."""

import os
import re
import shutil
import subprocess

import pytest

MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


class Done:
    """What a command said."""

    def __init__(self, done):
        self.code, self.stdout, self.stderr = done.returncode, done.stdout, done.stderr
        self.hash, self.chain = (re.findall(rf"^{name} +([0-9a-f]{{64}})$", done.stdout, re.M) or [None] for name in ("hash", "chain"))
        self.hash, self.chain = self.hash[0], self.chain[0]


def ranks_of(build):
    """1, and where runs can be divided 2 and 3."""
    return [1, 2, 3] if shutil.which("mpirun") and (build / "lib/fp3/fp3_mpi.so").exists() else [1]


@pytest.fixture(scope="session")
def ranks(build):
    return ranks_of(build)


@pytest.fixture(scope="session")
def command(fp3):
    """The words that start a command on so many ranks, and its environment."""
    def command(*arguments, on=1):
        start = ["mpirun", "--oversubscribe", "-n", str(on)] if on > 1 else []
        return [*start, str(fp3), *map(str, arguments)], {**os.environ, **MPI}
    return command


@pytest.fixture
def start(command, tmp_path):
    def start(*arguments, on=1, code=0):
        words, environment = command(*arguments, on=on)
        done = Done(subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120))
        assert done.code == code, done.stdout[-2000:] + done.stderr
        return done
    return start


@pytest.fixture
def world(root):
    """A scene of programs/world, as options."""
    return lambda name: ("--scene", root / f"programs/world/{name}.scene")
