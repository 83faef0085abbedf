"""Exact cycles: any change, better or worse, fails until tests/programs/cycles.txt is changed on purpose."""

import json
import re
import subprocess

import pytest


def rows(runs):
    """One line per run: cycles first and next, then stalls by cause in 1 + 100 integrations, or 1 + 20 of many objects."""
    for run in runs:
        stalls = " ".join(f"{cause}={count}" for cause, count in run["stalls"].items())
        yield f"{run['program']} {run['config']} first={run['first_cycles']} next={run['next_cycles']} {stalls}"


def test_ship_takes_the_cycles_it_took(fp3, root, tmp_path):
    path = tmp_path / "sim.json"
    subprocess.run([fp3, "bench", "--steps", "100", "--json", path], cwd=root, check=True, capture_output=True)
    now = sorted(rows(json.loads(path.read_text())["runs"]))
    lines = (root / "tests/programs/cycles.txt").read_text().splitlines()
    then = sorted(line for line in lines if line and not line.startswith("#"))
    assert now == then, "\n".join(["now:", *sorted({*now} - {*then}), "then:", *sorted({*then} - {*now})])


# A program, its configuration, and what 10 steps of it must stall for, and how often in each step.
CAUSES = [
    # the sum wants the adder in the cycle in which the product of word 0 reaches it
    ("single", "madd r0, r1, r2, r3\nmul r4, r5, r5\nadd r6, r7, r7\n", {"unit": 1}),
    # a chain's result is four cycles away
    ("single", "madd r0, r1, r2, r3\nmul r4, r0, r0\nmul r5, r6, r6\n", {"dependency": 3}),
    # a sum or a product two
    ("single", "add r0, r1, r1\nmul r2, r0, r0\nadd r3, r2, r2\n", {"dependency": 2}),
    # what is made beside the multiplier is as late as a chain
    ("single_full", "rcp r0, r1\nmul r4, r0, r0\nmul r5, r6, r6\n", {"dependency": 3}),
    # ... and takes the adder from a sum
    ("single_full", "max r0, r1, r2\nmul r4, r5, r5\nadd r6, r7, r7\n", {"unit": 1}),
    # rounded once, it takes three cycles, and so does a sum; a product and what is made beside it take two
    ("single_fused", "fmadd r0, r1, r2, r3\nadd r4, r0, r0\nmul r5, r4, r4\nmin r6, r5, r5\nmul r7, r6, r6\n", {"dependency": 6}),
    # a product that ends with the sum before it
    ("single_fused", "add r0, r1, r1\nmul r2, r3, r3\n", {"writeback": 1}),
    # a product does not wait for register 0, which its unused field names; a sum waits for a alone
    ("single_fused", "fmadd r0, r1, r2, r3\nmul r4, r5, r5\n", {"writeback": 1}),
    # nobody waits for an operand that an instruction does not have: r0
    ("single_full", "mul r0, r4, r4\nabs r1, r5\nmul r0, r4, r4\nmul r2, r4, r4\nmul r3, r4, r4\n", {"writeback": 1}),
    # sixteen contexts hide what their cores take
    ("sixteen", "rsqrt r0, r1\nsel r1, r0, r1, r0\nmadd r1, r0, r0, r1\n", {}),
    # no bypass: an addition issues when the one before has been written to the register file
    ("paper", "add r0, r0, r1\n", {"dependency": 15}),
    # two schedulers, 24 contexts each, want one multiplier: one's sweep is the other's stall (of the second one here)
    ("shared", "mul r0, r0, r1\n", {"unit": 48}),
    # 24 contexts hide the latency, and that of the program memory
    ("many", "add r0, r0, r1\n", {}),
]


@pytest.mark.parametrize("config, source, causes", CAUSES)
def test_a_stall_has_its_cause(fp3, tmp_path, config, source, causes):
    (tmp_path / "x.s").write_text("step:\n" + source)
    subprocess.run([fp3, "asm", "x.s", "-o", "x.fp3"], cwd=tmp_path, check=True)
    out = {}
    for steps in (1, 11):
        text = subprocess.run([fp3, "run", "x.fp3", "--config", *config.split(), "--steps", str(steps)], cwd=tmp_path,
                              check=True, capture_output=True, text=True).stdout
        out[steps] = dict(re.findall(r"^(\w+) +(\w+)", text, re.M))  # not the rows of units, which begin with a space
    per_step = {key.removeprefix("stall_"): (int(out[11][key]) - int(out[1][key])) / 10
                for key in out[1] if key.startswith("stall_")}
    assert {key: count for key, count in per_step.items() if count} == causes


def test_a_product_and_its_sum_take_less_when_they_are_rounded_once(fp3, root, tmp_path):
    """The compiled ship, its steps on the hardware as predicted."""
    cycles = {}
    for config in ("single_full", "single_fused"):
        model = ("programs/ship.ode", "-i", "rk4", "-c", config)
        report = subprocess.run([fp3, "compile", *model, "--report"], cwd=root, check=True, capture_output=True, text=True).stdout
        runs = [subprocess.run([fp3, "run", *model, "-e", "rtl", "-n", str(n)], cwd=root, check=True, capture_output=True, text=True).stdout
                for n in (10, 110)]
        first, last = (int(re.search(r"^cycles +(\d+)$", out, re.M)[1]) for out in runs)
        cycles[config] = (last - first) / 100
        assert cycles[config] == float(re.search(r"cycles per object-step +([\d.]+)", report)[1])
    assert cycles["single_fused"] <= 0.9 * cycles["single_full"]
