"""Flags and rounding by software, which WebAssembly needs (sw/base/fpu_soft.h), beside those of the processor."""

import subprocess

import pytest


@pytest.mark.parametrize("by_chance", ["60000", pytest.param("1000000", marks=pytest.mark.long)])
def test_software_has_the_processors_results_and_flags(build, by_chance):
    """Every operation in every arithmetic, on 54,872 operands that are hard to get right and on as many by chance."""
    said = [subprocess.run([build / f"tests/{name}", by_chance], capture_output=True, text=True, check=True).stdout for name in ("operations", "operations_soft")]
    assert len(said[0].splitlines()) == 88 and said[0] == said[1]
