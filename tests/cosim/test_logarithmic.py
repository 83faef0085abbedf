"""A configuration whose words are logarithms: the hardware and the fast engine against the isa engine, and who says that it does not compute so."""

import re
import subprocess

import pytest


@pytest.fixture(scope="module")
def tree(root, build, tmp_path_factory):
    """`many_full` with this arithmetic, at the least latencies."""
    tree = tmp_path_factory.mktemp("logs") / "tree"
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(root / "tools")
        import random_configs
        from fp3gen.read import load
        row = next(row for row in load(root).configs if row["name"] == "many_full")
        row |= {"name": "logs", "logarithmic": 1, "round": 0, "mul_cuts": 0, "add_cuts": 0, "mul_latency": 2, "add_latency": 10}
        random_configs.build(row, tree, build)
    return tree


@pytest.mark.parametrize("engine", ["rtl", "fast"])
def test_random_streams_agree(tree, engine):
    """At every retirement; of the engine fast, what each run leaves."""
    done = subprocess.run([tree / "random_stream", "--engine", engine, "--instructions", "60000", "--seed", "9"], env={"FP3_RTL_DIR": str(tree)},
                          capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"^logs: [6-9]\d{4} instructions .* agree", done.stdout, re.M), done.stdout


def test_verilator_has_no_warning(tree):
    rooms = [word for room in sorted((tree / "rtl").iterdir()) if room.is_dir() and room.name != "gen" for word in ("-y", room)]
    done = subprocess.run(["verilator", "--lint-only", "-Wall", "-DFP3_CHECK", f"+incdir+{tree}/rtl", f"+incdir+{tree}/rtl/gen", "-y", tree / "rtl", *rooms,
                           "+libext+.v", "--top-module", "fp3_logs", tree / "rtl/gen/fp3_logs.v"], capture_output=True, text=True)
    assert done.returncode == 0 and not done.stderr, done.stderr


def test_the_compiler_says_that_it_does_not_know_them(root, build, tree):
    objects = sorted((build / "obj/sw/cli").glob("*.o"))
    done = subprocess.run(["gcc", "-o", tree / "fp3", tree / "own.o", *objects, build / "obj/measure.a", build / "lib/libfp3.a",
                           *"-lgsl -lgslcblas -lconfig -lz -ldl -ljansson -lm".split()], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    done = subprocess.run([tree / "fp3", "run", root / "programs/ship.ode", "-c", "logs"], capture_output=True, text=True)
    assert done.returncode and "configuration 'logs' is logarithmic: models are compiled for binary32" in done.stderr, done.stderr
