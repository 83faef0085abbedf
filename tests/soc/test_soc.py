"""The example SoC (examples/litex): its program on the simulated hardware alone, and (in full) the whole SoC, whole and broken."""

import pathlib
import re
import subprocess
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples/litex"))

import memory_data  # noqa: E402

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


AT, BYTES = 0x1000, 1 << 20                # where a scene begins in simulated memory, and how much there is


@pytest.fixture(scope="module")
def memory(root, build, tmp_path_factory):
    """memory.c with three steps of the flag: their hashes by the engine fast, and what starts it."""
    folder = tmp_path_factory.mktemp("memory")
    row = memory_data.make(build / "bench/alone", folder, memory_data.SCENE, 3, None, AT, BYTES)
    sanitize = ["-fsanitize=address,undefined"] if build.name.endswith("-san") else []
    succeeds("gcc", *WARN, "-D_GNU_SOURCE", "-g", *sanitize, "-DTICK=30000u",
             *[word for name in (root / "examples/litex", root / "sw", root / "sw/bare", root / "sw/include", root / "sim", folder) for word in ("-I", name)],
             root / "tests/soc/simulated.c", root / "examples/litex/memory.c", root / "sw/bare/fp3_bare.c", root / "sw/bare/fp3_bare_moves.c",
             "-ldl", "-o", folder / "memory")
    return row, lambda mode: starts(folder / "memory", build / "lib/fp3/fp3_world_memory.so", mode, folder / "memory.image", AT, BYTES)


def test_objects_in_memory_have_the_hash_of_fast(memory):
    """An interrupt ends the list; addresses outside of memory are told; the list takes more cycles than the steps alone."""
    row, simulated = memory
    done = simulated("well")
    hashes = [f"flag begins {row['begins']}", f"flag ends {row['ends']}"]
    *got, load, store, end = done.stdout.splitlines()
    cycles = int(got.pop(2).removeprefix("list ").removesuffix(" cycles"))
    assert done.returncode == 0 and end == "done" and row["begins"] != row["ends"], done.stdout
    assert got == [*hashes, f"list outside {BYTES:08x}", f"store outside {BYTES:08x}"]
    assert row["in_store"] < cycles / row["objects"] / row["steps"] < 1.3 * row["in_store"]
    assert all(re.fullmatch(rf"{name} (8[2-5]\d\d) cycles", line) for name, line in (("load", load), ("store", store))), (load, store)


@pytest.mark.parametrize("mode, says", [("gone", "error: open: status "), ("9", "error: list: status 00000004, the bus of the processor answered with an error, at 00000044"),
                                        ("deaf", "error: the list has ended, but no interrupt came")])
def test_a_broken_way_to_memory_is_told(memory, mode, says):
    done = memory[1](mode)
    assert done.returncode == 1 and says in done.stdout and "done" not in done.stdout, done.stdout


def test_without_litex_it_says_what_to_install(root):
    done = starts(sys.executable, "-S", root / "examples/litex/soc.py")
    assert done.returncode == 1 and done.stderr.endswith(": run make setup-soc, and this with .venv/bin/python\n")


@pytest.fixture
def python(root):
    python = root / ".venv/bin/python"
    if starts(python, "-c", "import litedram, litex, pythondata_cpu_vexriscv").returncode:
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


@pytest.mark.long
@pytest.mark.parametrize("sdram, bus", [("MT48LC16M16", "wishbone"), ("M12L64322A", "axi-lite"), ("MT41K128M16", "wishbone")])
def test_the_soc_moves_objects_in_an_sdram(root, fp3, build, python, tmp_path, sdram, bus):
    text = succeeds(python, root / "examples/litex/soc.py", "--fp3", fp3, "--alone", build / "bench/alone", "--program", "memory", "--sdram", sdram,
                    "--bus", bus, "--steps", "4", "--output", tmp_path)
    assert text.endswith(f"world_memory on {bus}: flag.scene: the bits of the engine fast\n")


# What is broken, what is said, and by whom: the program, or the comparison.
BROKEN = [("address", "error: open: there is no FP3 at this address, or it has another instruction set"),
          ("interrupt", "error: the run has ended, but no interrupt came"),
          ("hole", "error: load: the bus answered with an error, at 00020000"),
          ("program", "soc.py: the engine isa has other bits:"),
          ("cache", "soc.py: the engine fast has other bits"),
          ("bounds", "error: memory took an address that it has not"),
          ("sdram", "soc.py: fp3 has a port to memory, and the SoC no SDRAM"),
          ("l2", "soc.py: fp3 has a port to memory, and the SDRAM a cache"),
          ("silence", "no end within 2000000 cycles")]
OF_MEMORY = {"cache", "bounds", "sdram", "l2"}


@pytest.mark.long
@pytest.mark.parametrize("what, says", BROKEN)
def test_a_broken_soc_is_told(root, fp3, build, python, tmp_path, what, says):
    options = ["--program", "memory", "--steps", "2", "--alone", build / "bench/alone"] if what in OF_MEMORY else []
    done = starts(python, root / "tests/soc/broken.py", what, fp3, tmp_path, *options)
    assert done.returncode == 1 and says in done.stdout + done.stderr, done.stdout + done.stderr
