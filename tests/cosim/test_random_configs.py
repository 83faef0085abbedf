"""Configurations that nobody named: built and tested as the named ones are."""

import re
import subprocess
import sys

import pytest


def start(root, *arguments):
    return subprocess.run([sys.executable, root / "tools/random_configs.py", *arguments], capture_output=True, text=True,
                          timeout=1800)


def test_a_handful_of_random_configurations(root, build, long):
    """One that truncates and flushes, with 44 contexts (eight); `tools/random_configs.py --count 200` for more."""
    first, count = (0, 8) if long else (56, 1)
    done = start(root, "--first", str(first), "--count", str(count), "--seed", "7", "--jobs", "1", "--instructions", "20000",
                 "--build", build)
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(re.findall(r"^\d+: .*\d+ instructions agree", done.stdout, re.M)) == count
    assert done.stdout.endswith(f"\n{count} configurations, 0 failed\n")


@pytest.mark.smoke
def test_draws_are_repeated_by_their_seed(root, monkeypatch):
    monkeypatch.syspath_prepend(root / "tools")
    import random_configs

    rows = [random_configs.random_config(1, number) for number in range(200)]
    assert rows == [random_configs.random_config(1, number) for number in range(200)]
    assert rows[0] != random_configs.random_config(2, 0) | {"doc": rows[0]["doc"]}
    for key, values in {"multiply_add": {"none", "chain", "fused", "dual"}, "sleep": {0, 1}, "exceptions": {"none", "run", "object"},
                        "arithmetic": {"ieee", "truncated", "flushed", "truncated_flushed"}, "writeback": {"bypass", "slot", "stall"},
                        "select": {0, 1}, "reciprocal": {"none", "estimate"}}.items():
        assert {row[key] for row in rows if key in row} == values, key
    assert {1, 64} <= {row.get("contexts", 1) for row in rows}
    assert max(row.get("lanes", 1) for row in rows) > 4 and max(row.get("schedulers", 1) for row in rows) > 3
