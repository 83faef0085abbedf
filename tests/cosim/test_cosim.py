"""The hardware under Verilator: its host port, against the isa engine, and what the engines promise."""

import os
import re
import subprocess

import pytest


def start(binary, *arguments, cwd, timeout=600):
    done = subprocess.run([binary, *arguments], cwd=cwd, capture_output=True, text=True, timeout=timeout)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.smoke
def test_engines_keep_their_promises(build, tmp_path):
    assert " 0 failed" in start(build / "tests/engine_promises", cwd=tmp_path)


# Of each organisation one: without and with a store, neighbours, 16-bit records, lanes, two streams, schedulers, tiles.
PORTS = ["paper", "single_full", "world", "fabric", "many_half", "dual", "shared_full", "array"]


@pytest.mark.smoke
@pytest.mark.parametrize("config", PORTS)
def test_the_host_port_answers_everything(build, tmp_path, config):
    transfers, said = start(build / "tests/host_port", config, cwd=tmp_path).split(maxsplit=1)
    assert said == "transfers, 0 failed\n" and int(transfers) > 10_000


@pytest.mark.long
def test_every_host_port_answers_everything(build, tmp_path):
    transfers, said = start(build / "tests/host_port", cwd=tmp_path).split(maxsplit=1)
    assert said == "transfers, 0 failed\n" and int(transfers) > 1_000_000


@pytest.mark.smoke
def test_schedulers_run_programs_of_their_own(build, tmp_path):
    assert ", 0 failed" in start(build / "tests/different_programs", "1", "10", cwd=tmp_path)
    # A batch begins whose contexts are not among those that were awake in the one before, and a program without a last part.
    assert ", 0 failed" in start(build / "tests/different_programs", "307", "1", cwd=tmp_path)


@pytest.mark.smoke
@pytest.mark.parametrize("config, objects", [("world", 30), ("world_keep", 25), ("pairs", 12), ("world_log", 12), ("world_bfloat", 12)])
def test_objects_see_each_other_as_on_the_isa_engine(build, tmp_path, long, config, objects):
    """Lists and starts by chance, of up to 30 objects, which are two batches, once (53, as many as three batches take, ten times); of 12 in other arithmetic.
    With `keep` all share the list of all."""
    objects = 53 if long and config == "world" else objects
    for seed in range(1, 11 if long else 2):
        out = start(build / "tests/neighbours", str(seed), config, str(objects), cwd=tmp_path)
        assert re.fullmatch(r"\d{3,} runs, 0 failed\n", out), out


@pytest.mark.smoke
@pytest.mark.parametrize("config, objects", [("world", 30), ("pairs", 24), ("world_log", 24), ("world_bfloat", 24), ("fabric", 12)])
def test_what_neighbours_read_after_an_early_end_is_of_one_phase(build, tmp_path, long, config, objects):
    """Stops at 22 moments of programs of one phase and of two, and an illegal word behind a store, which reaches its whole batch; by links and by who is near."""
    objects = 25 if long and config == "fabric" else objects
    assert re.fullmatch(r"\d+ runs, 0 failed\n", start(build / "tests/early_ends", "1", config, str(objects), cwd=tmp_path))


@pytest.mark.smoke
@pytest.mark.parametrize("config, objects", [("world", 64), ("world_log", 40), ("world_bfloat", 40), pytest.param("fabric", 40, marks=pytest.mark.long)])
def test_what_a_neighbour_gives_is_an_operand_on_all_engines(build, tmp_path, long, config, objects):
    """Programs by chance, 150 of them or, where native code is compiled, 60; of the fast engine both native code and the interpreter have some."""
    is_native = config not in ("world_log", "world_bfloat")
    programs = 60 if is_native and not long else 150
    for seed in range(1, 11 if long else 2):
        out = start(build / "tests/given", str(seed), config, str(programs), str(objects), cwd=tmp_path)
        runs, native = map(int, re.fullmatch(r"(\d+) runs, (\d+) of native code, 0 failed\n", out).groups())
        assert runs == 3 * programs and (native > 15) == is_native, out


@pytest.mark.smoke
@pytest.mark.parametrize("config", ["world_keep", "world_memory"])
def test_the_hardware_makes_lists_as_a_model_does(build, tmp_path, long, config):
    """Programs by chance, against a model of the store: each word of it, flags, the half with the published words, the outcome and the cycles.
    With a port to memory a list of transfers starts each run, and goes on by its outcome and whether an object has raised."""
    for seed in range(1, 11 if long else 2):
        out = start(build / "tests/kept", str(seed), "60", config, cwd=tmp_path)
        said = r"60 programs, (\d+) lists made, (\d+) without room, (\d+) left out, (\d+) raised, 0 failed\n"
        made, full, left_out, told = map(int, re.fullmatch(said, out).groups())
        assert made > 60 and full > 3 and left_out > 10 and 10 < told < 60, out


def build_own(root, build, tree, base, keys, test):
    """A configuration of its own, `some`, and a test that is linked with it."""
    from fp3fpga import one_config
    from fp3gen.read import load
    row = next(row for row in load(root).configs if row["name"] == base) | {"name": "some"} | keys
    one_config.build(row, tree, build)
    sanitize = ["-fsanitize=address,undefined"] if build.name.endswith("-san") else []
    one_config.run("gcc", *sanitize, "-o", tree / test, build / f"obj/tests/cosim/{test}.o", tree / "own.o", build / "lib/libfp3.a", *one_config.LIBS)


@pytest.mark.parametrize("keys", [pytest.param({"mul_latency": 1, "add_latency": 2, "mul_cuts": 0, "add_cuts": 2}, id="the least latency"),
                                  pytest.param({"select": 0, "reciprocal": "none", "round": 0}, id="z comes late", marks=pytest.mark.long)])
def test_an_operand_is_there_in_time(root, build, tmp_path, monkeypatch, keys):
    """With the store as early before the registers, and results sooner; without fp_value z is read behind x, and so is its sign."""
    monkeypatch.syspath_prepend(root / "tools")
    tree = tmp_path / "some"
    build_own(root, build, tree, "world", keys, "given")
    done = subprocess.run([tree / "given", "1", "some", "100"], env={"FP3_RTL_DIR": str(tree)}, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0 and done.stdout.endswith(", 0 failed\n"), done.stdout + done.stderr


@pytest.mark.long
def test_each_lane_has_a_list_of_all(root, build, tmp_path, monkeypatch):
    """With `keep`: its objects share it, and ghosts of those in the other lane are in it."""
    monkeypatch.syspath_prepend(root / "tools")
    tree = tmp_path / "some"
    build_own(root, build, tree, "fabric", {"lanes": 2, "space_bit": 16, "keep": 1}, "neighbours")
    done = subprocess.run([tree / "neighbours", "1", "some", "25"], env={"FP3_RTL_DIR": str(tree)}, capture_output=True, text=True, timeout=600)
    assert re.fullmatch(r"\d{3,} runs, 0 failed\n", done.stdout), done.stdout + done.stderr


def test_a_configuration_without_counters(root, build, tmp_path, monkeypatch):
    """Its bits are those of others; an access to a counter is refused; and the command says that it has none, not a wrong number."""
    monkeypatch.syspath_prepend(root / "tools")
    from fp3fpga import one_config
    from fp3gen.read import load
    row = next(row for row in load(root).configs if row["name"] == "many") | {"name": "some", "counters": 0}
    tree = tmp_path / "some"
    one_config.build(row, tree, build)
    objects = {name: [build / f"obj/tests/cosim/{name}.o"] for name in ("random_stream", "host_port")}
    objects["fp3"] = [build / "obj" / path.relative_to(root).with_suffix(".o") for path in (root / "sw/cli").glob("*.c")]
    sanitize = ["-fsanitize=address,undefined"] if build.name.endswith("-san") else []
    for name, files in objects.items():
        one_config.run("gcc", *sanitize, "-o", tree / name, *files, tree / "own.o", build / "obj/measure.a", build / "lib/libfp3_lab.a", build / "lib/libfp3.a",
                       *one_config.LIBS, "-ljansson")

    def said(*command):
        done = subprocess.run([tree / command[0], *command[1:]], env={**os.environ, "FP3_RTL_DIR": str(tree)}, capture_output=True, text=True, timeout=300)
        return done.returncode, done.stdout + done.stderr
    code, out = said("random_stream", "--instructions", "20000")
    assert code == 0 and "instructions in" in out, out
    code, out = said("host_port")
    assert code == 0 and ", 0 failed" in out, out
    run = ["fp3", "run", root / "programs/oscillator.ode", "--config", "some", "--steps", "4", "--clock", "100MHz"]
    code, out = said(*run, "--engine", "rtl")
    assert code == 0 and "counters         none: configuration some has no counters, so the time at this clock is not known\n" in out and "cycles" not in out.replace("transfers in", ""), out
    code, out = said(*run[:-2], "--engine", "isa")
    assert code == 0 and re.search(r"^cycles +[1-9]", out, re.M), out
    code, out = said("fp3", "bench", root / "programs/oscillator.ode", "--quick", "--config", "some")
    assert code == 2 and "configuration some has no counters" in out, out


def test_comparisons_selections_and_estimates_have_their_bits(build, tmp_path, long):
    """Every 23rd operand, so that the next ones in a row differ in all three; or every one, as of the fast engine always."""
    out = start(build / "tests/chosen_values", "1" if long else "23", cwd=tmp_path)
    results, fast = map(int, re.search(r"operands, (\d+) results, (\d+) of the fast engine, 0 wrong", out).groups())
    assert results > (4_000_000 if long else 150_000) and fast > 1_000_000, out


@pytest.mark.smoke
def test_random_streams_retire_alike_in_short(build, tmp_path):
    """For `make quick`; the whole of it is the next one."""
    for config in ("single_full", "many"):
        start(build / "tests/random_stream", "--config", config, "--instructions", "20000", "--seed", "1000000", cwd=tmp_path)


def test_random_streams_retire_alike(build, tmp_path, long):
    """40,000 instructions (10^6); no two tests share a stream."""
    count = 1_000_000 if long else 40_000
    out = start(build / "tests/random_stream", "--instructions", str(count * 6 // 5), cwd=tmp_path)
    rows = [line for line in out.splitlines() if " instructions in " in line]
    assert sum(int(row.split(": ")[1].split()[0]) for row in rows) >= count, out
    assert all("agree" in row for row in rows), out
