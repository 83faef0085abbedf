"""What loops over neighbours would take of a lane that adds and multiplies at once: docs/neighbours.md has the table."""

import re
import subprocess

import pytest

MODEL = """model m "a loop"
state x = 0
state y = 0
state v = 0
all others
step 1
x' = v
y' = v
v' = sum(o in others: {term})
"""


def ran(build, *arguments):
    return subprocess.run([build / "tests/two_streams", *arguments], capture_output=True, text=True, timeout=60)


def loops(build, *arguments):
    """Of each loop: cycles on world, sums, products; and by each rule operations of the busier unit, and cycles of a turn."""
    done = ran(build, *arguments)
    assert done.returncode == 0, done.stdout + done.stderr
    form = r"loop \d+: world (\d+), sums (\d+), products (\d+), banks (\d+) (\S+), squares (\d+) (\S+), free (\d+) (\S+)"
    return [[float(word) for word in re.fullmatch(form, line).groups()] for line in done.stdout.splitlines()]


# A sweep takes 30 cycles and begins 15 or more after the one before, and a turn is told in 30 cycles. S is a sweep of sums, P of products, N is
# `next`, which takes both units.
TURNS = [
    # S at 0, S at 30, N at 60; the next turn at 90.
    ("o.x - x", 3, 2, 0, (2, 3), (2, 3), (2, 3)),
    # S at 0, P at 15 to move the difference, P at 45, S at 60, N at 90; without the move P at 15, S at 30, N at 60.
    ("(o.x - x)*(o.x - x)", 3, 2, 1, (2, 4), (2, 3), (2, 3)),
    # S at 0, P at 15 to move the difference, S at 30, P at 45, S at 60, N at 90; a product of two differences is no square.
    ("(o.x - x)*(o.y - y)", 4, 3, 1, (3, 4), (3, 4), (3, 4)),
]


@pytest.mark.parametrize("term, world, sums, products, banks, squares, free", TURNS)
def test_turns_counted_by_hand(build, tmp_path, term, world, sums, products, banks, squares, free):
    (tmp_path / "m.ode").write_text(MODEL.format(term=term))
    assert loops(build, tmp_path / "m.ode", "euler") == [[world, sums, products, *banks, *squares, *free]]


def test_what_such_a_lane_has_not_is_named(root, build):
    done = ran(build, root / "programs/world/balls.ode", "semi_implicit_euler")
    assert done.returncode == 1 and re.fullmatch(r"FAIL: a loop has 'm(in|ax)'\n", done.stdout)


def test_the_page_has_these_figures(root, build):
    table = re.search(r"<!-- streams -->\n(.*?)<!-- streams end -->", (root / "docs/neighbours.md").read_text(), re.DOTALL)[1]
    rows = [[cell.strip(" `") for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]
    assert len(rows) == 4
    for what, *figures in rows:
        model, integrator = what.split()
        world, sums, products, *rules = loops(build, root / f"programs/world/{model}.ode", integrator)[0]
        told = [world, f"{sums:g}, {products:g}", *(figure for at in (0, 2, 4) for figure in (rules[at + 1], rules[at]))]
        assert figures == [cell if isinstance(cell, str) else f"{cell:g}" for cell in told], what
