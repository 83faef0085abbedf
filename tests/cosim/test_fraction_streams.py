"""Numbers with fewer fraction bits, and lanes that sleep, in configurations without a name: hardware and engine fast against engine isa."""

import re
import subprocess

import pytest

ROWS = {"odd": ("many_full", {"fraction": 18, "arithmetic": "truncated_flushed", "lanes": 3, "store_words": 2048}), "fused": ("many_full", {"fraction": 11, "multiply_add": "fused"}),
        "alone": ("single_fused", {"fraction": 18, "arithmetic": "truncated_flushed"})}


pytestmark = pytest.mark.xdist_group("fraction_streams")    # each configuration is built once


@pytest.fixture(scope="module", params=["odd", *(pytest.param(name, marks=pytest.mark.long) for name in ("fused", "alone"))])
def tree(request, root, build, tmp_path_factory):
    """A named configuration with these numbers, uncut."""
    name, keys = ROWS[request.param]
    tree = tmp_path_factory.mktemp("fraction") / "tree"
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(root / "tools")
        import random_configs
        from fp3gen.read import load
        from fp3gen.configs import settable
        machine = load(root)
        row = settable(next(row for row in machine.configs if row["name"] == name), machine.keys)
        row |= {"name": request.param, "mul_cuts": 0, "add_cuts": 0, "mul_latency": 2, "add_latency": 2} | keys
        random_configs.build(row, tree, build)
    return tree


@pytest.mark.parametrize("engine", ["rtl", "fast"])
def test_random_streams_agree(tree, engine):
    """At every retirement; of the engine fast, what each run leaves."""
    done = subprocess.run([tree / "random_stream", "--engine", engine, "--instructions", "15000", "--seed", "3"], env={"FP3_RTL_DIR": str(tree)},
                          capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"^\w+: (1[5-9]|[2-9]\d)\d{3} instructions .* agree", done.stdout, re.M), done.stdout


def test_comparisons_selections_and_estimates_have_their_bits(tree):
    """Of words whose low bits are not 0, too."""
    done = subprocess.run([tree / "chosen_values", "17"], env={"FP3_RTL_DIR": str(tree)}, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0 and re.search(r"operands, \d{4,} results, .* 0 wrong", done.stdout), done.stdout + done.stderr


def test_the_host_port_answers_everything(tree):
    """Lists of several lanes, too: no named configuration has those and sleep."""
    done = subprocess.run([tree / "host_port"], env={"FP3_RTL_DIR": str(tree)}, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0 and re.fullmatch(r"\d{5,} transfers, 0 failed\n", done.stdout), done.stdout + done.stderr
