"""Runs that are killed at random moments, again and again, and end with the hash of an undisturbed one."""

import contextlib
import os
import pathlib
import random
import signal
import subprocess
import time

import h5py
import pytest

KILLS = {False: 6, True: 100}
STEPS = {1: 3000, 2: 3000, 3: 5000}  # divided they take longer: all processes make hashes


def begin(command, tmp_path, run, on):
    more = ("--restart", "a.ck") if (tmp_path / "a.ck").exists() else ()
    words, environment = command("run", *run, "--checkpoint", "a.ck", "--checkpoint-every", 10, *more, on=on)
    return subprocess.Popen(words, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def children_of(pid):
    return list(map(int, pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii").split()))


def wait_for_change(path, going):
    """mpirun takes a while to begin."""
    def now():
        return path.stat().st_mtime_ns if path.exists() else 0
    before, end = now(), time.monotonic() + 30
    while now() == before and going.poll() is None and time.monotonic() < end:
        time.sleep(0.01)


def step_of(path):
    """0: there is no checkpoint yet."""
    if not path.exists():
        return 0
    with h5py.File(path) as file:
        return int(file.attrs["step"])


def kill(going, chance, on):
    """Of several processes the first or the last."""
    pids = children_of(going.pid) if on > 1 and going.poll() is None else [going.pid]
    for pid in chance.sample(pids[:1] + pids[1:][-1:], 1) if pids else []:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL if on > 1 else chance.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT]))


@pytest.mark.parametrize("on", [1, 2, pytest.param(3, marks=pytest.mark.long)])
def test_kills(command, start, world, ranks, tmp_path, long, on):
    """Of a divided run one process, which makes mpirun end the others."""
    if on not in ranks:
        pytest.skip("no mpirun, or no fp3_mpi.so: make setup-cluster all")
    chance = random.Random(on)
    run = (*world("cloth"), "--steps", STEPS[on], "-e")
    whole = start("run", *run, "fast", "--checkpoint", "whole.ck", "--checkpoint-every", 10)
    kills, restarts, attempts = 0, 0, 0
    ended = False
    while kills < KILLS[long] // on or not ended:
        attempts += 1
        assert attempts < 20 * KILLS[long], kills
        before, had_before = step_of(tmp_path / "a.ck"), (tmp_path / "a.ck.1").exists()
        engine = "isa" if on == 1 and chance.random() < 0.2 else "fast"
        going = begin(command, tmp_path, (*run, engine), on)
        if kills < KILLS[long] // on:
            if on > 1:
                wait_for_change(tmp_path / "a.ck", going)
            time.sleep(chance.uniform(0.02, 0.3))
            kill(going, chance, on)
        said = going.communicate(timeout=100)
        ended = going.returncode == 0
        assert ended or kills < KILLS[long] // on, said[1]
        kills += not ended
        restarts += not ended and 0 < before < STEPS[on]
        left = {path.name for path in tmp_path.iterdir()} - {"whole.ck", "whole.ck.1"}
        assert left <= {"a.ck", "a.ck.1", *([] if ended else [".fp3-a.ck.tmp"])} and "a.ck:" not in said[1], said[1]
        assert had_before <= ("a.ck.1" in left), "the checkpoint before is gone"
        assert before <= step_of(tmp_path / "a.ck")
        if ended:
            assert f"hash             {whole.hash}\nchain            {whole.chain}\n" in said[0]
            for name in left:
                (tmp_path / name).unlink()
    assert restarts, "nobody was killed after a restart"


def test_killed_between_the_names(command, start, world, tmp_path):
    """Whatever call is the last one that a run makes, a whole checkpoint has its name, and so has the one before."""
    run = (*world("cloth"), "--steps", 20, "-e", "fast")
    source = "".join(f'int {name}({types}) {{ if (--left < 1) _exit(9); return (int)syscall({number}, {values}); }}\n' for name, types, number, values in (
        ("link", "const char *a, const char *b", "SYS_link", "a, b"), ("rename", "const char *a, const char *b", "SYS_rename", "a, b"),
        ("unlink", "const char *a", "SYS_unlink", "a"), ("fsync", "int a", "SYS_fsync", "a")))
    (tmp_path / "stop.c").write_text('#define _GNU_SOURCE\n#include <stdlib.h>\n#include <sys/syscall.h>\n#include <unistd.h>\nstatic int left;\n'
                                     '__attribute__((constructor)) static void begin(void) { left = atoi(getenv("LEFT")); }\n' + source)
    subprocess.run(["gcc", "-shared", "-fPIC", "stop.c", "-o", "stop.so"], cwd=tmp_path, check=True)
    whole = start("run", *run, "--checkpoint", "whole.ck", "--checkpoint-every", 5)
    ends = set()
    for left in range(1, 30):
        words, environment = command("run", *run, "--checkpoint", "a.ck", "--checkpoint-every", 5)
        done = subprocess.run(words, cwd=tmp_path, env={**environment, "LD_PRELOAD": str(tmp_path / "stop.so"), "LEFT": str(left)},
                              capture_output=True, text=True, timeout=60)
        ends.add(done.returncode)
        assert step_of(tmp_path / "a.ck") <= 5 or step_of(tmp_path / "a.ck.1"), f"the checkpoint before is gone after {left} calls"
        if (tmp_path / "a.ck").exists():
            assert start("run", *run, "--restart", "a.ck", "--checkpoint", "a.ck", "--checkpoint-every", 5).chain == whole.chain, left
        else:
            assert left <= 4, f"no checkpoint is left after {left} calls"
        for path in tmp_path.glob("a.ck*"):
            os.unlink(path)
        if done.returncode == 0:
            break
    assert ends == {0, 9}
