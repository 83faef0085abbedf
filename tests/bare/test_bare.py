"""The C driver (sw/bare) and the example examples/ships.c, on the simulated hardware over AXI4-Lite."""

import json
import re
import shutil
import struct
import subprocess
import sys

import pytest

WARN = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
STEPS = 3


def succeeds(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=120, **options)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def page(root):
    return (root / "docs/integration.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def folder(root, fp3, tmp_path_factory):
    """The example, with the header of the ship's program."""
    at = tmp_path_factory.mktemp("bare")
    shutil.copy(root / "examples/ships.c", at)
    succeeds(fp3, "asm", root / "programs/ship.s", "-o", at / "ship.fp3")
    succeeds(fp3, "dis", at / "ship.fp3", "--header", at / "ship.h")
    (at / "sleeper.s").write_text(".state x slept\nstep:\nadd x, x, 1.0\nsleep slept, 0.0, 1.0\n")
    succeeds(fp3, "asm", at / "sleeper.s", "-o", at / "sleeper.fp3")
    succeeds(fp3, "dis", at / "sleeper.fp3", "--header", at / "sleeper.h")
    return at


def compiled(root, build, folder, name):
    sanitize = ["-fsanitize=address,undefined"] if build.name.endswith("-san") else []
    succeeds("gcc", *WARN, "-D_GNU_SOURCE", "-g", *sanitize, "-ffp-contract=off", "-I", root / "sw", "-I", root / "sw/bare", "-I",
             root / "sw/include", "-I", root / "sim", "-I", folder, root / f"tests/bare/{name}.c", root / "sw/bare/fp3_bare.c",
             root / "sw/bare/fp3_bare_moves.c", "-ldl", "-o", folder / name)
    return folder / name


@pytest.fixture(scope="module")
def simulated(root, build, folder):
    return compiled(root, build, folder, "simulated")


@pytest.mark.parametrize("options", [["-O0"], ["-Os", "-m32", "-fno-pic"]], ids=" ".join)
def test_it_needs_nothing(root, folder, options):
    """Freestanding, on 64 and 32 bits: no symbol of anybody else's, and the example only the driver's."""
    for source in (root / "sw/bare/fp3_bare.c", root / "sw/bare/fp3_bare_moves.c", folder / "ships.c"):
        succeeds("gcc", *WARN, *options, "-ffreestanding", "-nostdlib", "-nostdinc", "-isystem",
                 succeeds("gcc", "-print-file-name=include").strip(), "-I", root / "sw", "-I", root / "sw/bare", "-I",
                 root / "sw/include", "-c", source, "-o", folder / "x.o")
        names = re.findall(r"U (\w+)", succeeds("nm", "-u", folder / "x.o"))
        assert [name for name in names if not name.startswith("fp3_bare_") or source.parent != folder] == [], names


def hardware(root, build, config):
    """The library of a configuration, and the bits of an address of its bus."""
    ports = (build / f"rtl/fp3_{config}.v").read_text(encoding="utf-8")
    return build / f"lib/fp3/fp3_{config}.so", int(re.search(r"\[(\d+):0\] +s_axi_araddr", ports)[1]) + 1


def run_of(root, fp3, folder, config, ships):
    """The bits of v and s, ship by ship, of the engine isa."""
    out = folder / "x.csv"
    spread = ["--spread", f"v=0:{ships - 1}"] if ships > 1 else []
    succeeds(fp3, "run", root / "programs/ship.s", "-e", "isa", "-c", config, "-N", ships, "-n", STEPS, "--params",
             root / "programs/ship.cfg", *spread, "--output", out)
    head, *rows = [line.split(",") for line in out.read_text().splitlines()]
    bits = lambda text: f"{struct.unpack('<I', struct.pack('<f', float(text)))[0]:08x}"
    return [f"{bits(row['v'])} {bits(row['s'])}" for row in [dict(zip(head, row)) for row in rows][-ships:]]


# Ships, with lanes and schedulers that have one more than others; and a seed for waits of the bus.
@pytest.mark.parametrize("config, ships, seed", [("single", 1, 0), ("single", 1, 5), ("many", 25, 0), ("many", 25, 5), ("lanes", 9, 5),
                                                 ("array", 5, 5)])
def test_the_example_has_the_bits_of_a_run(root, build, fp3, simulated, tmp_path, config, ships, seed):
    """And so it has after every refusal and error that simulated.c provokes; without waits in each single transfer."""
    got = succeeds(simulated, *hardware(root, build, config), seed, ships, STEPS)
    assert got.splitlines() == run_of(root, fp3, tmp_path, config, ships)
    assert len(set(got.splitlines())) == ships


@pytest.mark.parametrize("seed", [0, 5])
def test_what_moves_has_the_bits_of_a_run(root, build, fp3, folder, tmp_path, seed):
    """Program, constants, list and ships come from memory, and the ships go back; moves.c also provokes what can go wrong."""
    got = succeeds(compiled(root, build, folder, "moves"), hardware(root, build, "many_memory")[0], seed)
    assert got.splitlines() == run_of(root, fp3, tmp_path, "many_memory", 30)


@pytest.mark.parametrize("config", ["many", "many_half"])
def test_the_step_in_which_an_object_sleeps_is_whole(root, build, simulated, config):
    """It has 17 bits. The driver finds in the program which word of a record of 16 bits must keep them."""
    assert succeeds(simulated, *hardware(root, build, config), 5, "sleep") == "70000\n"


def test_the_latencies_of_the_page_are_measured(root, build, simulated, page):
    rows = [line for line in page.split("| configuration | write, register |")[1].split("\n\n")[0].splitlines() if line.startswith("| `")]
    said = [(config, "| " + row.split("| ", 2)[2] + "\n") for row in rows for config in re.findall(r"`(\w+)`", row)]
    assert len(said) >= 7
    for config, figures in said:
        assert succeeds(simulated, *hardware(root, build, config), 0, "latency") == f"| `{config}` {figures}"


def test_the_transfers_of_a_run_are_measured(root, fp3, page):
    """They are the same for every number of steps; the last column is their share of 1,000 steps."""
    rows = page.split("| configuration | objects | transfers |")[1].split("\n\n")[0].splitlines()[2:]
    assert len(rows) == 3
    for row in rows:
        config, objects, transfers, cycles, each, _ = (cell.strip(" `").replace(",", "") for cell in row.strip("|").split("|"))
        out = succeeds(fp3, "run", root / "programs/ship.s", "--params", root / "programs/ship.cfg", "-c", config, "-N", objects, "-n", 1, "--clock", "100MHz")
        said = re.search(r"^bus .*: (\d+) transfers in (\d+) cycles", out, re.M)
        assert (said[1], said[2], f"{int(said[2]) / int(objects):.1f}") == (transfers, cycles, each), config


def test_a_header_has_all_that_a_host_gives(root, fp3, tmp_path):
    source = tmp_path / "p.s"
    source.write_text(".state x\n.param p\n.shared h\n.const k 2.0\nstep:\n  mul x, x, k\n  mul x, x, p\n  mul x, x, h\n")
    succeeds(fp3, "asm", source, "-o", tmp_path / "p.fp3")
    text = succeeds(fp3, "dis", tmp_path / "p.fp3", "--header", "-")
    assert re.findall(r"#define (program_\w+) \d+u", text) == ["program_state_x", "program_param_p", "program_shared_h"]
    assert re.search(r"\{1, 0x40000000u\}|\{0, 0x40000000u\}", text)
    succeeds(fp3, "dis", tmp_path / "p.fp3", "--header", tmp_path / "2 ships.new.h")
    assert "_program = {" in (tmp_path / "2 ships.new.h").read_text().replace("__ships", "")
    succeeds(fp3, "asm", root / "programs/ship_sleep.s", "-o", tmp_path / "s.fp3")
    text = succeeds(fp3, "dis", tmp_path / "s.fp3", "--header", "-")
    assert re.findall(r"#define program_asleep (\d+u)", text) == re.findall(r"#define program_state_slept (\d+u)", text) != []
    for name in ("step.h", "x" * 40 + ".h"):
        done = subprocess.run([fp3, "dis", tmp_path / "p.fp3", "--header", tmp_path / name], capture_output=True, text=True)
        assert (done.returncode == 2) == (name == "step.h") and (tmp_path / name).exists() == (name != "step.h"), done.stderr
    done = subprocess.run([fp3, "dis", "--word", "0x38000000", "--header", "x.h"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and "--header: expected an image" in done.stderr


def test_alone_measures_loads_and_chunks(root, build, tmp_path):
    """The quick form of `make alone`: words moved once, and the words of the engine fast from chunks; else it fails."""
    succeeds(sys.executable, root / "tools/alone.py", "--quick", "--output", tmp_path / "alone.json")
    rows = json.loads((tmp_path / "alone.json").read_text())["rows"]
    assert all(row["cycles_per_word"] < 1.1 * max(1, 1 / row["memory"]) for row in rows if row["scene"] == "load")
    assert len({row["hash"] for row in rows if row["scene"] == "kepler rk4"}) == 1 and len(rows) == 7
    flags = [row for row in rows if row["scene"] == "flag.scene"]
    assert len({row["hash"] for row in flags}) == 1 and all(row["chunks"] > 1 and row["host_accesses_between_steps"] == 0 for row in flags)
