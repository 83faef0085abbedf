"""The scheduler: the same bits as the step says, the cycles that the hardware takes, and few of them."""

import json
import re
import subprocess

import pytest

SOLO = ["paper", "walk_slot", "walk_bypass", "uncut", "single", "single_full", "single_fused"]
CONTEXTS = ["many", "many_full", "sixteen", "lanes", "array"]
COUNT = 150
STEPS = 90                               # of those whose bits are compared
# Between `paper` and `single` each feature is there once more.
ALL = [pytest.param(config, marks=[pytest.mark.long] * config.startswith("walk_")) for config in SOLO + CONTEXTS]
SLOW = ("lanes", "array")                # to simulate


def every(config, long, few=25, fewer=50):
    """Of how many steps one runs on the hardware."""
    return fewer if config in SLOW and not long else few


@pytest.fixture
def scheduler(build, tmp_path):
    def scheduler(mode, config, **options):
        arguments = [word for name, value in options.items() for word in (f"--{name}", str(value))]
        done = subprocess.run([build / "tests" / "scheduler", mode, "--config", config, *arguments], cwd=tmp_path,
                              capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return scheduler


def number(pattern, text):
    found = re.search(pattern, text)
    assert found, text
    return float(found.group(1))


def measured(out):
    return number(r"(\d+) runs measured", out)


# ---- cycles --------------------------------------------------------------------------------------

@pytest.mark.parametrize("config", SOLO)
def test_the_hardware_takes_the_cycles_predicted_for_any_instructions(scheduler, config):
    assert measured(scheduler("lines", config, count=COUNT)) == 7 * COUNT


@pytest.mark.parametrize("config", CONTEXTS)
def test_the_hardware_takes_the_cycles_predicted_for_any_number_of_objects_in_one_round_and_in_three(scheduler, config, long):
    """Of those that are slow to simulate every third number (all)."""
    step = every(config, long, 1, 3)
    assert measured(scheduler("rows", config, rtl=step)) >= 96 // step


@pytest.mark.smoke
def test_schedulers_that_share_units_are_not_predicted(scheduler):
    assert ", 0.000 cycles, bound 18.000," in scheduler("ship", "shared")


# ---- bits ----------------------------------------------------------------------------------------

@pytest.mark.parametrize("config", [*ALL, "shared"])
def test_random_steps_keep_their_bits(scheduler, config, long):
    """Executed in C: as FP32 numbers, and as numbers that depend on all that went into them."""
    out = scheduler("steps", config, count=COUNT if long else STEPS, rtl=every(config, long, 15, 30))
    assert number(r"(\d+) need more", out) <= (0.6 if config == "lanes" else 0.2) * (COUNT if long else STEPS), out
    assert config == "shared" or measured(out) >= 10, out


@pytest.mark.parametrize("config", ALL)
def test_steps_of_integrators_keep_their_bits(scheduler, config, long):
    scheduler("integrators", config, count=COUNT if long else STEPS, rtl=every(config, long), seed=10000)


# ---- how good ------------------------------------------------------------------------------------

@pytest.mark.smoke
@pytest.mark.parametrize("config, cycles, instructions", [
    ("single", 48, 20), ("single_full", 48, 20), ("uncut", 26, 20), ("walk_bypass", 321, 30),
    ("walk_slot", 369, 30), ("paper", 374, 30), ("many", 20, 20), ("lanes", 2.5, 20)])
def test_the_ship_is_as_fast_as_by_hand(scheduler, config, cycles, instructions):
    out = scheduler("ship", config)
    assert number(r": (\d+) instructions", out) == instructions, out
    assert number(r"([\d.]+) cycles", out) <= cycles, out
    assert " 0 copies" in out, out


@pytest.mark.parametrize("config, mean", [("single", 1.08), ("uncut", 1.10), ("walk_slot", 1.03),
                                          ("walk_bypass", 1.03), ("many", 1.0)])
def test_steps_of_integrators_are_near_the_bound(scheduler, config, mean):
    """With registers enough: cycles over the larger of issue slots and longest dependence."""
    out = scheduler("integrators", config, count=COUNT, registers=64)
    assert number(r"mean ([\d.]+)", out) <= mean, out
    assert number(r"(\d+) need more", out) == 0, out


@pytest.mark.parametrize("registers, mean", [(16, 1.16), (20, 1.16), (24, 1.11)])
def test_where_registers_are_few_steps_stay_near_the_bound(scheduler, registers, mean):
    """A plan with few values, filled while the rest fits (room.h): without that 1.18, 1.17, 1.12."""
    assert number(r"mean ([\d.]+)", scheduler("integrators", "single_full", count=COUNT, registers=registers)) <= mean


@pytest.mark.parametrize("name, most", [("twelve_masses", 1.02), ("three_in_space", 1.06)])
def test_models_larger_than_the_registers_stay_near_the_bound(name, most, root, build, tmp_path):
    """More values than 64 registers in the orders with the fewest cycles. Hardware, isa engine and equations agree."""
    found = tmp_path / "rows.json"
    subprocess.run([build / "fp3", "compare", root / f"tests/ode/large/{name}.ode", "-i", "rk4", "--most-steps=128",
                    "--json", found], check=True, stdout=subprocess.DEVNULL, timeout=300)
    row = json.loads(found.read_text())["rows"][0]
    single = row["single_full"]
    assert (row["arithmetic"], row["mismatches"]) == ("plain", 0) and row["compared"] > 1000
    assert single["measured"] == single["predicted"] <= most * single["bound"], single


@pytest.mark.smoke
def test_too_few_registers_are_counted(scheduler):
    assert number(r"(\d+) need more", scheduler("integrators", "single", count=20, registers=4)) == 20
