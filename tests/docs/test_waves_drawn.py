"""What docs/drawings/*.wave shows is what simulations do: the bus under Icarus, instructions in the pipeline's log of the hardware.

A source has the levels of each signal as WaveDrom writes them: a letter for each cycle, a dot for what stays, a bar for cycles that
are left out. `shown` takes that apart again; the simulation says what should be there.
"""

import json
import re
import subprocess
import sys

import pytest

import simulate

from tests.kanata import check

FIELDS = "awvalid awready awaddr wvalid wready wdata bvalid bready bresp arvalid arready araddr rvalid rready rdata rresp".split()
VALID = {"awaddr": "awvalid", "wdata": "wvalid", "bresp": "bvalid", "araddr": "arvalid", "rdata": "rvalid", "rresp": "rvalid"}


@pytest.fixture(scope="module")
def waves(root):
    """The sources, with their facts, by name."""
    code = ("import json, pathlib, sys; sys.path.insert(0, 'tools'); import draw; facts = draw.Facts(draw.ROOT); "
            "print(json.dumps({path.stem: json.loads(draw.filled(path, facts)) for path in draw.sources(draw.ROOT) if path.suffix == '.wave'}))")
    done = subprocess.run([sys.executable, "-B", "-c", code], cwd=root, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def shown(source, name):
    """Of a signal what each cycle shows: a level, the text of a value, None for a cycle that is left out."""
    signal = next(one for one in source["signal"] if one.get("name") == name)
    texts, out, last = iter(signal.get("data", [])), [], None
    for letter in signal["wave"]:
        if letter == "|":
            out.append(None)
            continue
        if letter != ".":
            last = letter if letter in "01xzp" else next(texts)
        out.append(last)
    assert next(texts, None) is None, f"{name} has more values than places"
    return out


# ---- the bus ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def bus(root, tmp_path_factory):
    """The cycles of each part, as tests/docs/axi_drawn.v prints them: a signal's value by its name."""
    bench = tmp_path_factory.mktemp("axi") / "axi.vvp"
    for line in (["iverilog", "-g2012", "-s", "axi_drawn", "-c", "rtl/fp3.f", "-o", bench, "tests/docs/axi_drawn.v", simulate.top("single")], ["vvp", "-n", bench]):
        done = subprocess.run(line, cwd=root, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stdout + done.stderr
    parts = {}
    for line in done.stdout.splitlines():
        part, *values = line.split()
        if part in ("write", "read") and len(values) == len(FIELDS):
            parts.setdefault(part, []).append(dict(zip(FIELDS, values)))
    return parts


def value(cycle, name):
    """A level; or what is said, in short, while it counts."""
    if name not in VALID:
        return cycle[name]
    if cycle[VALID[name]] != "1":
        return "x"
    return {"0": "OKAY", "2": "SLVERR"}[cycle[name]] if name.endswith("resp") else format(int(cycle[name], 16), "x")


@pytest.mark.parametrize("part", ["write", "read"])
def test_transfers_are_those_of_the_hardware(waves, bus, part):
    source = waves[f"axi_{part}"]
    names = [one["name"] for one in source["signal"] if one and one["name"] != "aclk"]
    assert len(names) >= 7
    for name in names:
        short = source["names"] if name.endswith(("addr", "resp")) else {}
        texts = [value(cycle, name) for cycle in bus[part]]
        assert shown(source, name) == [short.get(text, text) for text in texts], name


# ---- instructions -----------------------------------------------------------------------------------


def log(fp3, root, folder, *line):
    path = folder / "log"
    done = subprocess.run([fp3, "run", *line, "--kanata", path], cwd=root, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return check.read(path.read_text())


def assembled(fp3, root, folder, name):
    done = subprocess.run([fp3, "asm", f"programs/{name}.s", "-o", folder / "image.fp3"], cwd=root, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return folder / "image.fp3"


def words(one):
    """Where an instruction is in the program, and its text."""
    number, text = one.label.split(":", 1)
    return int(number), re.sub(" +", " ", text.strip())


def test_stages_of_one_object(waves, fp3, root, tmp_path):
    source = waves["issue"]
    run = log(fp3, root, tmp_path, assembled(fp3, root, tmp_path, "ship"), "-c", "single", "-n", "2", "--params", "programs/ship.cfg")
    rows = [one["name"] for one in source["signal"] if one and one["name"] != "clk"]
    begin = run[2].issued - 1
    assert rows == [words(one)[1] for one in run[2:2 + len(rows)]] and len(rows) >= 4
    for row, one in zip(rows, run[2:]):
        stage = {cycle - begin: name for _, name, first, after in one.stages for cycle in range(first, after)}
        cycles = shown(source, row)
        assert cycles == [stage.get(cycle, "z") for cycle in range(len(cycles))], row
        assert max(stage) < len(cycles), "the drawing ends before the write"


def test_a_sweep(waves, fp3, root, tmp_path):
    source = waves["sweep"]
    run = log(fp3, root, tmp_path, assembled(fp3, root, tmp_path, "ship_madd"), "-c", "many", "-N", "24", "-n", "2", "--visit", "1", "--params", "programs/ship.cfg")
    first = next(one.issued for one in run if words(one)[0] == 7)
    times = shown(source, "cycle")
    issues = {one.issued - first: one for one in run}
    written = {one.ended - 1 - first: one for one in run}
    for column, time in enumerate(times):
        if time in (None, "x"):
            continue
        issued, ended = issues[int(time)], written[int(time)]
        for name, there in (("issues: word", words(issued)[1]), ("issues: context", str(issued.thread)), ("writes: context", str(ended.thread)),
                            ("writes: word", words(ended)[1])):
            assert shown(source, name)[column] == there, (name, time)


def test_a_loop_over_neighbours(waves, fp3, root, tmp_path):
    source = waves["neighbours"]
    (tmp_path / "links.csv").write_text("a,b\n0,1\n1,2\n1,3\n")
    run = log(fp3, root, tmp_path, "programs/world/chain.ode", "-c", "world", "-e", "rtl", "-i", "semi_implicit_euler", "-n", "1", "--links",
              f"springs={tmp_path}/links.csv", "--set", "u=0.1")
    names = [words(one)[1].split()[0] for one in run]
    begin = names.index("each")
    sweeps = [run[i:i + 4] for i in range(begin, len(run), 4)]
    shown_words = shown(source, "word")[1:]                       # before the first column nothing is shown
    assert shown_words == [words(sweep[0])[1].split()[0] for sweep in sweeps[:len(shown_words)]] and "mul" in shown_words
    for row, thread in (("object 0: 1 link", 0), ("object 1: 3 links", 1)):
        writes = ["1" if not sweep[thread].flushed and "no change" not in sweep[thread].detail else "0" for sweep in sweeps[:len(shown_words)]]
        assert shown(source, row)[1:] == writes, row
    lengths = [after[0].issued - before[0].issued for before, after in zip(sweeps, sweeps[1:len(shown_words)])]
    told = [int(number) for number in re.findall(r"\d+", source["foot"]["text"])]
    assert told == [lengths[1], lengths[0]] and set(lengths[1:]) == {lengths[1]}
