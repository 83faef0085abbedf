"""The bus under an independent master: cocotbext-axi drives the processor in Icarus."""

import json
import os
import re
import subprocess
import sys

import pytest

STEPS = 3


@pytest.fixture(scope="module")
def python(root):
    """The Python that has cocotb."""
    path = root / ".venv/bin/python"
    assert path.exists(), "make setup makes .venv"
    return path


@pytest.fixture(scope="module", params=["single", "many"])
def run_file(request, root, fp3, tmp_path_factory):
    """A run of the ship as the hardware has it elsewhere: what is written before, and the words that it ends with."""
    at = tmp_path_factory.mktemp("run")
    image, session = at / "x.fp3", at / "x.session"
    subprocess.run([fp3, "asm", root / "programs/ship.s", "-o", image], check=True)
    objects = ["--objects", "4"] if request.param == "many" else []
    subprocess.run([fp3, "run", image, "-c", request.param, *objects, "--steps", str(STEPS), "--params", root / "programs/ship.cfg",
                    "--bus-log", session], check=True, capture_output=True)
    rows = [line.split() for line in session.read_text().splitlines()]
    writes = [(int(at, 16), int(data, 16)) for kind, at, data in rows if kind == "w"]
    reads = {int(at, 16): int(data, 16) for kind, at, data in rows if kind == "r"}
    registers, store, lanes = reads[0x04] & 0xff, reads[0x34], reads[0x30] >> 16
    assert writes[-1] == (0x10, 1)                         # the start
    (at / "run.json").write_text(json.dumps({
        "config": request.param, "registers": registers, "memory": reads[0x08], "store": store, "words": store * lanes or registers,
        "setup": writes[:-1], "end": [(at, bits) for at, bits in reads.items() if at >= 0x800000]}))
    return at / "run.json"


def attack(root, python, run_file, tmp_path, transfers, seed, tree=None):
    tree = tree or root
    bench, clock, top = tmp_path / "bus.vvp", tmp_path / "clock.f", f"fp3_{json.loads(run_file.read_text())['config']}"
    clock.write_text("+timescale+1ns/1ps\n")
    built = subprocess.run(["iverilog", "-g2012", "-DFP3_CHECK", "-s", top, "-c", "rtl/fp3.f", "-c", clock, "-o", bench, f"rtl/gen/{top}.v"],
                           cwd=tree, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    libs = subprocess.run([python, "-m", "cocotb.config", "--lib-dir"], capture_output=True, text=True, check=True).stdout.strip()
    name = subprocess.run([python, "-m", "cocotb.config", "--lib-name", "vpi", "icarus"], capture_output=True, text=True, check=True).stdout.strip()
    libpython = subprocess.run([python, "-m", "cocotb.config", "--libpython"], capture_output=True, text=True, check=True).stdout.strip()
    results = tmp_path / "results.xml"
    env = {**os.environ, "MODULE": "attack", "TOPLEVEL": top, "TOPLEVEL_LANG": "verilog", "PYTHONPATH": str(root / "tests/bus"),
           "LIBPYTHON_LOC": libpython, "VIRTUAL_ENV": str(python.parents[1]), "COCOTB_RESULTS_FILE": str(results), "FP3_TRANSFERS": str(transfers),
           "FP3_SEED": str(seed), "FP3_MAP": str(root / "isa/registers.toml"), "FP3_RUN": str(run_file), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(["vvp", "-n", "-M", libs, "-m", name, bench], cwd=tmp_path, env=env, capture_output=True, text=True)
    return done, results.read_text() if results.exists() else ""


def test_every_transfer_is_answered_as_it_must_be(root, python, run_file, tmp_path, long):
    transfers = 20_000 if long else 600
    done, results = attack(root, python, run_file, tmp_path, transfers, 1)
    assert done.returncode == 0 and "<failure" not in results, (done.stdout + done.stderr)[-3000:]
    told = re.search(r"(\d+) transfers answered", done.stdout)
    assert told and int(told[1]) >= transfers, (done.stdout + done.stderr)[-3000:]
