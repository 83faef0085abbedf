"""The example SoC (examples/litex): its program on the simulated hardware alone, and (in full) the whole SoC, whole and broken."""

import re
import subprocess
import sys

import pytest

WARN = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
STEPS = 20
SHIPS = {"single": 1, "many": 8}


def starts(*command):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=600)


def succeeds(*command):
    done = starts(*command)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def includes(root, fp3, tmp_path_factory):
    """Where headers are, the program's among them."""
    folder = tmp_path_factory.mktemp("soc")
    succeeds(fp3, "asm", root / "programs/ship.s", "-o", folder / "ship.fp3")
    succeeds(fp3, "dis", folder / "ship.fp3", "--header", folder / "ship.h")
    return [word for name in (root / "examples/litex", root / "sw", root / "sw/bare", root / "sw/include", root / "sim", folder) for word in ("-I", name)]


@pytest.fixture(scope="module")
def simulated(root, build, includes, tmp_path_factory):
    folder = tmp_path_factory.mktemp("programs")
    sanitize = ["-fsanitize=address,undefined"] if build.name.endswith("-san") else []
    for config, ships in SHIPS.items():
        succeeds("gcc", *WARN, "-D_GNU_SOURCE", "-g", *sanitize, "-ffp-contract=off", f"-DSHIPS={ships}", f"-DSTEPS={STEPS}", "-DPATIENCE=30000u", *includes,
                 root / "tests/soc/simulated.c", root / "examples/litex/ships.c", root / "sw/bare/fp3_bare.c", "-ldl", "-o", folder / config)
    return lambda config, mode: starts(folder / config, build / f"lib/fp3/fp3_{config}.so", mode)


def test_the_program_needs_its_machine_and_nothing_else(root, includes, tmp_path):
    """On 32 bits; no function of a compiler's library either, which a processor without an FPU would need for floats."""
    succeeds("gcc", *WARN, "-Os", "-m32", "-mgeneral-regs-only", "-fno-pic", "-ffreestanding", "-nostdlib", "-nostdinc", "-isystem",
             succeeds("gcc", "-print-file-name=include").strip(), *includes, "-c", root / "examples/litex/ships.c", "-o", tmp_path / "x.o")
    names = set(re.findall(r"U (\w+)", succeeds("nm", "-u", tmp_path / "x.o")))
    assert {name for name in names if not name.startswith("fp3_bare_")} == {"machine_bus", "machine_print", "machine_wait"}


@pytest.mark.parametrize("config", SHIPS)
def test_the_program_prints_the_bits_of_a_run(root, fp3, simulated, config):
    ships = SHIPS[config]
    spread = ["--spread", f"v=0:{ships - 1}"] if ships > 1 else []
    text = succeeds(fp3, "run", root / "programs/ship.s", "-e", "isa", "-c", config, "-N", ships, "-n", STEPS, "--params", root / "programs/ship.cfg",
                    "--all", *spread)
    v, s = (re.findall(rf"^{name} .* 0x([0-9a-f]{{8}}) ", text, re.M) for name in "vs")
    assert len(v) == ships
    done = simulated(config, "well")
    assert done.returncode == 0 and done.stdout.splitlines() == [f"v {a} s {b}" for a, b in zip(v, s, strict=True)] + ["done"]


@pytest.mark.parametrize("mode, says", [("gone", "open: there is no FP3 at this address, or it has another instruction set"),
                                        ("deaf", "the run has ended, but no interrupt came")])
def test_the_program_says_what_is_broken(simulated, mode, says):
    done = simulated("single", mode)
    assert done.returncode == 1 and done.stdout == f"error: {says}\n"


def test_an_error_of_the_bus_is_told(simulated):
    """Of each transfer, with its place; none of them ends in results."""
    last = int(simulated("single", "well").stderr.removesuffix(" transfers\n"))
    assert last > 40
    for broken in range(1, last + 1):
        done = simulated("single", str(broken))
        assert done.returncode == 1
        assert re.search(r"^error: (open|load|start|interrupt|status|read|flags): the bus answered with an error, at [0-9a-f]{8}$", done.stdout, re.M)
        assert "done" not in done.stdout


def test_without_litex_it_says_what_to_install(root):
    done = starts(sys.executable, "-S", root / "examples/litex/soc.py")
    assert done.returncode == 1 and done.stderr.endswith(": run make setup-soc, and this with .venv/bin/python\n")


@pytest.fixture
def python(root):
    python = root / ".venv/bin/python"
    if starts(python, "-c", "import litex, pythondata_cpu_vexriscv").returncode:
        pytest.skip("no LiteX: make setup-soc installs it")
    return python


@pytest.mark.long
@pytest.mark.parametrize("config, bus", [("single", "wishbone"), ("many", "axi-lite")])
def test_the_soc_has_the_bits_of_a_run(root, fp3, python, tmp_path, config, bus):
    text = succeeds(python, root / "examples/litex/soc.py", "--fp3", fp3, "--config", config, "--ships", SHIPS[config], "--bus", bus, "--output", tmp_path)
    assert text.endswith(f"{config} on {bus}: {SHIPS[config]} ships, 1000 steps: the bits of the engine isa\n")


@pytest.mark.long
def test_the_soc_moves_objects_that_see_each_other(root, fp3, python, tmp_path):
    text = succeeds(python, root / "examples/litex/soc.py", "--fp3", fp3, "--program", "scenes", "--output", tmp_path)
    assert text.endswith("world on wishbone: cloth, stars, balls: the bits of the engine fast\n")


# What is broken, what is said, and by whom: the program, or the comparison.
BROKEN = [("address", "error: open: there is no FP3 at this address, or it has another instruction set"),
          ("interrupt", "error: the run has ended, but no interrupt came"),
          ("hole", "error: load: the bus answered with an error, at 00020000"),
          ("program", "soc.py: the engine isa has other bits:"),
          ("silence", "no end within 2000000 cycles")]


@pytest.mark.long
@pytest.mark.parametrize("what, says", BROKEN)
def test_a_broken_soc_is_told(root, fp3, python, tmp_path, what, says):
    done = starts(python, root / "tests/soc/broken.py", what, fp3, tmp_path)
    assert done.returncode == 1 and says in done.stdout + done.stderr, done.stdout + done.stderr
