"""mpirun on one machine: more ranks than processors, started as any user, root in a container too."""

import os
import re
import shutil
import subprocess

import pytest

# Where a rank ends with an error, the others are killed at once: a second of grace, once or twice, is all the time that a refusal takes.
OPEN_MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_mpi_yield_when_idle": "1",
            "OMPI_MCA_odls_base_sigkill_timeout": "0"}


@pytest.fixture(scope="session")
def mpi_environment():
    return os.environ | OPEN_MPI


@pytest.fixture(scope="session")
def mpirun(build, mpi_environment):
    if not shutil.which("mpirun") or not (build / "lib/fp3/fp3_mpi.so").exists():
        pytest.skip("no MPI: make setup-cluster all")
    said = subprocess.run(["mpirun", "--version"], capture_output=True, text=True).stdout
    more = ["--oversubscribe"] if "Open MPI" in said or "OpenRTE" in said else []

    def run(ranks, *command, timeout=120, **more_env):
        return subprocess.run(["mpirun", *more, "-n", str(ranks), *map(str, command)], capture_output=True, text=True, timeout=timeout,
                              env=mpi_environment | more_env)

    return run


@pytest.fixture
def hash_of(mpirun, fp3, tmp_path):
    """What a scene leaves, whatever computes it: the recording, byte for byte, and what is printed of states and flags."""

    def run(scene, ranks, engine, steps, *more):
        out = tmp_path / f"{scene.stem}-{ranks}-{engine}.csv"
        done = mpirun(ranks, fp3, "run", "--scene", scene, "-e", engine, "--steps", steps, "--output", out, *more)
        assert done.returncode == 0, done.stdout + done.stderr
        return out.read_bytes(), re.findall(r"^(?:.* 0x[0-9a-f]{8}.*|flags .*)$", done.stdout, re.M)

    return run
