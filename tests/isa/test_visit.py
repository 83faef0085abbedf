"""What a visit of an object loads and stores."""

import subprocess

import pytest

pytestmark = pytest.mark.smoke


@pytest.fixture
def visit(build):
    def visit(*arguments):
        got = subprocess.run(
            [build / "tests" / "visit", *map(str, arguments)], text=True, capture_output=True, timeout=300
        )
        assert got.returncode == 0, got.stdout + got.stderr
        return got.stdout.splitlines()

    return visit


def test_no_visit_can_be_told_from_an_object_that_keeps_its_registers(visit):
    words = visit("--seed", 1)[-1].split()
    programs, visits, slept = int(words[0]), int(words[2]), int(words[4])
    assert programs >= 20_000 and visits > 5 * programs and slept > visits // 10, words


def test_the_ship_sleeps_with_the_bits_of_the_one_that_does_not(visit, root):
    lines = visit("--ship", root / "programs")
    asleep = {line.split(",")[0]: set() for line in lines}
    for line in lines:
        asleep[line.split(",")[0]].add(line.split()[-1])
    assert len(lines) == 20 and len(asleep) == 4
    assert all(len(steps) == 1 for steps in asleep.values()), "however many steps a visit makes"
