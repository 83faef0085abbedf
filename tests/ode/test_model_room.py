"""Models of many states: which programs fit, as docs/compiler_results.md says, and what the compiler does where one does not fit at once."""

import re
import subprocess

import pytest
from runs import FP3, fp3

pytestmark = pytest.mark.smoke
INTEGRATORS = ["euler", "heun", "rk4", "leapfrog", "verlet", "yoshida6"]
ROWS = [("vectors/hires", 8), ("vectors/toda", 16), ("vectors/five_bodies", 20), ("large/front", 20),
        *(("vectors/rod", n) for n in (48, 60, 64)), *(("large/twelve_masses", 2 * n) for n in (12, 24, 30, 32)),
        ("large/twelve_masses", 64, True)]


def resized(root, folder, name, states, is_shared=False):
    """A model, or one of the two whose n is free with as many states. (The closed form of a long rod has too many operations.)
    is_shared: all objects have the same params."""
    text = (root / "tests/ode" / f"{name}.ode").read_text()
    model = name.split("/")[1]
    n = {"rod": states, "twelve_masses": states // 2}.get(model)
    if n:
        text = re.sub(r"^n = \d+", f"n = {n}", re.sub(r"^for .*exact.*\n", "", text, flags=re.M), flags=re.M)
    path = folder / f"{model}_{states}.ode"
    path.write_text(re.sub("^param", "shared", text, flags=re.M) if is_shared else text)
    return path, f"`{model}`" + (f", n = {n}" if n else "") + (", its params `shared`" if is_shared else "")


def cell(path, integrator, *more):
    done = subprocess.run([FP3, "compile", path, "-c", "many_full", "-i", integrator, "--report", *more], capture_output=True, text=True)
    if done.returncode:
        needs = re.search(r"needs (\d+) (object registers|words)", done.stderr)
        return f"{needs[1]} {needs[2].split()[-1]}" if needs else ""
    again = " *again*" if "pass carry" not in done.stdout else ""
    spills = re.search(r"^loads and stores +(\d+)", done.stdout, re.M)
    return re.search(r"cycles per object-step +(\S+)", done.stdout)[1] + again + (f", {spills[1]} *spills*" if spills else "")


def table(root, folder):
    rows = ["| model | states | " + " | ".join(f"`{i}`" for i in INTEGRATORS) + " |", "|---|---|" + "---|" * len(INTEGRATORS)]
    for name, states, *is_shared in ROWS:
        path, shown = resized(root, folder, name, states, *is_shared)
        rows.append(f"| {shown} | {states} | " + " | ".join(cell(path, i) for i in INTEGRATORS) + " |")
    return "\n".join(rows)


def test_the_page_says_what_fits(root, tmp_path):
    page = (root / "docs/compiler_results.md").read_text().split("## Models of many states", 1)[1]
    assert "\n".join(line for line in page.split("\n##", 1)[0].split("\n") if line.startswith("|")) == table(root, tmp_path)


def test_what_does_not_fit_with_carried_values_is_made_without(root, tmp_path):
    """48 states by verlet: with 24 accelerations from the step before the program needs more than 64 registers."""
    path, _ = resized(root, tmp_path, "large/twelve_masses", 48)
    own, asked = (fp3("compile", path, "-c", "many_full", "-i", "verlet", *more).stdout for more in ((), ("--without", "carry")))
    assert own == asked and "carry" not in re.search(r"^# Passes: (.*)$", own, re.M)[1].split()
    small, _ = resized(root, tmp_path, "large/twelve_masses", 24)
    assert "carry" in re.search(r"^# Passes: (.*)$", fp3("compile", small, "-c", "many_full", "-i", "verlet").stdout, re.M)[1].split()
    large, _ = resized(root, tmp_path, "large/twelve_masses", 64)
    assert "needs 67 object registers" in fp3("compile", large, "-c", "many_full", "-i", "verlet", status=2).stderr, "those without"
