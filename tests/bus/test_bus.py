"""The bus under an independent master: cocotbext-axi drives the processor in Icarus."""

import json
import re
import subprocess

import pytest

import simulate

STEPS = 3


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
    registers, store, lanes, space_bit = reads[0x04] & 0xff, reads[0x34], reads[0x30] >> 16 & 0xff, reads[0x30] >> 24
    assert writes[-1] == (0x10, 1)                         # the start
    (at / "run.json").write_text(json.dumps({
        "config": request.param, "registers": registers, "memory": reads[0x08], "store": store, "words": store * lanes or registers,
        "space_bit": space_bit, "setup": writes[:-1], "end": [(at, bits) for at, bits in reads.items() if at >> space_bit == 2]}))
    return at / "run.json"


def test_every_transfer_is_answered_as_it_must_be(root, run_file, tmp_path, long):
    transfers, config = 20_000 if long else 90, json.loads(run_file.read_text())["config"]
    bench = simulate.compiled(root, tmp_path, f"fp3_{config}", simulate.top(config), "-DFP3_CHECK")
    done = simulate.cocotb(root, tmp_path, bench, root / "tests/bus/attack.py", FP3_TRANSFERS=transfers, FP3_SEED=1,
                           FP3_MAP=root / "isa/registers.toml", FP3_RUN=run_file)
    assert done.passed, done.said[-3000:]
    assert int(re.search(r"(\d+) transfers answered", done.said)[1]) >= transfers
