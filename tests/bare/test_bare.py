"""The C driver (sw/bare) and the example examples/ships.c, on the simulated hardware over AXI4-Lite."""

import json
import pathlib
import re
import shutil
import struct
import subprocess
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples/litex"))

import scenes_data  # noqa: E402

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
             root / "sw/include", "-I", root / "sim", "-I", folder, "-I", root / "examples/litex", root / f"tests/bare/{name}.c",
             *sorted((root / "sw/bare").glob("*.c")), "-ldl", "-o", folder / name)
    return folder / name


@pytest.fixture(scope="module")
def simulated(root, build, folder):
    return compiled(root, build, folder, "simulated")


@pytest.mark.parametrize("options", [["-O0"], ["-Os", "-m32", "-fno-pic"]], ids=" ".join)
def test_it_needs_nothing(root, folder, options):
    """Freestanding, on 64 and 32 bits: no symbol of anybody else's, and the example only the driver's."""
    for source in (*sorted((root / "sw/bare").glob("*.c")), folder / "ships.c"):
        succeeds("gcc", *WARN, *options, "-ffreestanding", "-nostdlib", "-nostdinc", "-isystem",
                 succeeds("gcc", "-print-file-name=include").strip(), "-I", root / "sw", "-I", root / "sw/bare", "-I",
                 root / "sw/include", "-c", source, "-o", folder / "x.o")
        names = re.findall(r"U (\w+)", succeeds("nm", "-u", folder / "x.o"))
        assert [name for name in names if not name.startswith("fp3_bare_") or source.name == "fp3_bare.c"] == [], names


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


@pytest.fixture(scope="module")
def around(root, build, fp3, tmp_path_factory):
    """The three scenes of examples/litex on `world`, by the driver alone; the balls by this integrator."""
    made = {}

    def start(integrator, *arguments):
        if integrator not in made:
            made[integrator] = tmp_path_factory.mktemp(integrator)
            scenes_data.make(fp3, made[integrator], {"balls": integrator})
            compiled(root, build, made[integrator], "neighbours")
        folder = made[integrator]
        return folder, succeeds(folder / "neighbours", build / "lib/fp3/fp3_world.so", *arguments)
    return start


# Seeds for waits of the bus; cells of the grid, and how often lists are made, at least and at most. A step of leapfrog has two phases.
@pytest.mark.parametrize("integrator, seed, skin, cells, least, most", [
    ("semi_implicit_euler", 0, 0.01, 300, 3, 9), ("semi_implicit_euler", 0, 0.05, 4, 1, 2), ("leapfrog", 5, 0.0, 20, 20, 20)])
def test_neighbours_have_the_words_of_the_engine_fast(fp3, around, integrator, seed, skin, cells, least, most):
    """Links, all, near: every word of every state; whatever the skin and the grid are."""
    folder, text = around(integrator, seed, "words", f"{scenes_data.bits(skin):x}", cells)
    for name in scenes_data.SCENES:
        assert re.findall(rf"^{name} (\w+)$", text, re.M) == [f"{word:08x}" for word in scenes_data.expected(fp3, folder, name)], name
    assert least <= int(re.search(r"^lists (\d+)$", text, re.M)[1]) <= most


def test_the_scenes_of_the_soc_print_what_the_engine_fast_has(fp3, around):
    folder, text = around("semi_implicit_euler", 5, "program")
    assert text.splitlines() == [f"{name} {scenes_data.hash_of(scenes_data.expected(fp3, folder, name))}" for name in scenes_data.SCENES] + ["done"]


@pytest.mark.parametrize("mode", ["ends", "broken"])
def test_neighbours_are_refused_beyond_the_ends(around, mode):
    """tests/bare/neighbours.c has each range, and lets each transfer fail once."""
    around("semi_implicit_euler", 0, mode)


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


def test_a_header_of_what_the_driver_cannot_run_is_refused(fp3, tmp_path):
    """A word of all objects is compared between phases: nobody would do it."""
    (tmp_path / "w.s").write_text(".state x\n.worst w\nstep:\n  ld x\n  add w, x, x\n  st w\n  phase\n  ld x\n  st x\n")
    succeeds(fp3, "asm", tmp_path / "w.s", "-o", tmp_path / "w.fp3")
    done = subprocess.run([fp3, "dis", tmp_path / "w.fp3", "--header", tmp_path / "w.h"], capture_output=True, text=True)
    assert done.returncode == 2 and "compares a word of all objects between phases" in done.stderr and not (tmp_path / "w.h").exists()


@pytest.mark.parametrize("line, said", [("rest when abs(x) < 0.05 for 0.125", "objects may rest"), ("when x > 1: remove", "removes objects that others see")])
def test_a_header_of_what_the_host_decides_after_each_step_is_refused(fp3, tmp_path, line, said):
    (tmp_path / "p.ode").write_text(f"state x = 0\nlinks ties\nstep 0.125\nx' = sum(o in ties: o.x - x)\n{line}\n")
    succeeds(fp3, "compile", tmp_path / "p.ode", "-c", "world", "--image", tmp_path / "p.fp3")
    done = subprocess.run([fp3, "dis", tmp_path / "p.fp3", "--header", tmp_path / "p.h"], capture_output=True, text=True)
    assert done.returncode == 2 and said in done.stderr and not (tmp_path / "p.h").exists(), done.stderr


def test_alone_measures_loads_and_chunks(root, build, tmp_path):
    """The quick form of `make alone`: words moved once, and the words of the engine fast from chunks; else it fails."""
    succeeds(sys.executable, root / "tools/alone.py", "--quick", "--output", tmp_path / "alone.json")
    rows = json.loads((tmp_path / "alone.json").read_text())["rows"]
    assert all(row["cycles_per_word"] < 1.1 * max(1, 1 / row["memory"]) for row in rows if row["scene"] == "load")
    assert len({row["hash"] for row in rows if row["scene"] == "kepler rk4"}) == 1 and len(rows) == 11
    flags = [row for row in rows if row["scene"] == "flag.scene"]
    assert len({row["hash"] for row in flags}) == 1 and all(row["chunks"] > 1 and row["host_accesses_between_steps"] == 0 for row in flags)
    slower = {(row["config"], row["memory"]): row["cycles_per_object_step"] / row["in_store"] for row in flags}
    assert max(slower["world_overlap", 0.4], slower["world_overlap", 3]) < 1.08 < 1.15 < min(slower["world_memory", 0.4], slower["world_memory", 3])
