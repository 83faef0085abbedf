#!/usr/bin/env python3
"""Area and clock on FPGAs, by yosys and nextpnr: `make synth`, `make sizes`.

    tools/synth.py                                     cores, processors, a lane alone: every configuration
    tools/synth.py --top fp_add --config single --grades 8 --seeds 1
    tools/synth.py --top group --config lanes          four lanes that share their control
    tools/synth.py --top trim                          what a feature costs: synthesis only
    tools/synth.py --top lns_add --grades 6            a unit of logarithmic arithmetic; only where it is named
    tools/synth.py --device GW2AR-18 --top fp3 --config single --seeds 1      another device

A core is placed with the cuts of each configuration, and with the best places found for each number of
cuts (DEPTHS, as configurations cuts0, cuts1, ...). Where contexts are interleaved, processor and lane use
the registers inside the device's multipliers and block RAM (rtl/fpga/ecp5/, the same modules on the device's primitives);
a lane is also placed without them (configuration NAME-inferred). What has no registers (mux4 there) is always used.

The devices are in tools/fp3fpga/families.py; without --device it is an LFE5U-85F. What cannot fit is not placed, and its row
says so. Where a device has fewer pins than a top has ports, inputs are shifted in by one pin and the outputs leave as
their parity; on the others the ports are registers. A family that has no open placer is only synthesised.

Results go to build/results/synth.json, an object with an array `rows`; a run replaces the rows of the same top, config, device and grade and keeps the
others. With --unplaced it says which rows of docs/synth.json have other cells now; where they are the same, what was placed holds. The pages of docs/ come from docs/synth.json (tools/measured.py). Netlists and logs go to build/synth/, and are made again if files or command change.

  lut4          LUTs of the netlist, logic alone: of 4 inputs, on 7-series of at most 6, on Cyclone V ALUTs
  carry         carry cells of the netlist
  comb          cells that nextpnr places for logic; on ECP5: logic, two for each carry cell, distributed RAM
  ff, dsp, ebr  flip-flops, multipliers, block RAMs: which cells, families.py says. ff includes the registers put around
                the top: operands and result of a core, host port of a processor
  over          of each figure that a device has less of: per cent of what it has; empty for what fits
  untimed       whether place and route would not see how slow its multipliers are; then it is not placed
  tools         yosys and the placer, with versions
  goal          MHz that the placer was asked for
  fmax_all      MHz from register to register, one for each seed; fmax_median, fmax_best of these
  cuts          registers inside a core; null for a processor
  object_steps_per_second   of the ship at fmax_best; null for a core (a chip's cycles are those of `make chip-run`)
  latency_ns    at fmax_best: from operands to result of a core, (cuts + 1) periods; for a processor
                cycles per object-step of the ship, the fewest in build/results/sim.json (`fp3 bench`),
                null while that is not there
"""

import argparse
import collections
import hashlib
import json
import math
import pathlib
import re
import statistics
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

from fp3fpga import flow
import measured
import tops
from fp3fpga.families import DEVICES, FAMILIES
from fp3gen import fusesoc, parameters, verilog
from fp3gen.check import Bad
from fp3gen.configs import by_number, derive
from fp3gen.read import load
from fp3gen.text import columns

ROOT = pathlib.Path(__file__).resolve().parents[1]
WORK = pathlib.Path("build/synth")  # relative: the tools run in ROOT and see no more than that
CORES = ("fp_add", "fp_mul", "fp_fma")
LANES = {"lane": 1, "group": 4}
TOPS = (*CORES, *LANES, "fp3", "trim")
# Units of logarithmic arithmetic, which no configuration changes: parameters, inputs of one bit, operands, registers inside. Without a
# clock where there are none. No machine has a converter of floats.
LOGS = {"lns_add": ("", ["sub_i"], ["a_i", "b_i"], 9), "lns_mul": ("#(.CUT(1)) ", ["divide_i"], ["a_i", "b_i"], 1), "lns_root": ("", ["inverse_i"], ["a_i"], 0),
        "lns_from_float": ("", [], ["a_i"], 6), "lns_to_float": ("", [], ["a_i"], 5)}
# What a user chooses between, from the cheapest.
SIZES = ("small", "uncut", "single", "many", "paper", "single_full", "many_full", "lanes", "dual", "array")

# Of a configuration, with a store of 1,024 words: the base, and against it what is left out, one at a time, and what is
# put in.
TRIMS = {
    "many": {
        "base": {},
        "no chained multiply-add": {"multiply_add": "none"},
        "no sleep": {"sleep": 0},
        "no status of objects": {"exceptions": "run"},
        "no flags at all": {"exceptions": "none"},
        "no gradual underflow": {"arithmetic": "flushed"},
        "truncation": {"arithmetic": "truncated"},
        "all of these": {"multiply_add": "none", "sleep": 0, "exceptions": "none", "arithmetic": "truncated_flushed"},
        "16 registers": {"registers": 16},
        "16 contexts": {"contexts": 16},
        "64 contexts": {"contexts": 64},
        "8,192 words of store": {"store_words": 8192},
        "two schedulers share": {"schedulers": 2},
        "two lanes": {"lanes": 2},
        "two tiles": {"tiles": 2},
    },
    "many_full": {
        "every instruction, 64 registers, 2,048 words of program": {},
        "no selection": {"select": 0},
        "no estimates": {"reciprocal": "none"},
        "neither": {"select": 0, "reciprocal": "none"},
    },
}

# Where to cut a core for each number of cuts: the best of the places tried, post-route.
DEPTHS = {
    "fp_add": (0x00, 0x04, 0x0a, 0x2a, 0x56, 0x6e, 0x7f),
    "fp_mul": (0x00, 0x04, 0x12, 0x2a, 0x2b, 0x3b, 0x7f),
    "fp_fma": (0x000, 0x7ff),  # the ends alone
}
GOAL = 200  # MHz; nextpnr weighs paths against the slowest, so that it gets the same with any goal


def narrow(name, inputs, outputs, instance, clock="clk_i"):
    """A top of three pins, for a device with few: inputs are shifted in, the outputs' parity goes out."""
    def slices(bus, ports):
        at = 0
        for port, width in ports:
            yield f".{port}({bus}[{at} +: {width}])"
            at += width
    width, result = sum(w for _, w in inputs), sum(w for _, w in outputs)
    pins = [f".{clock}(clk_i)", *slices("in_q", inputs), *slices("out_d", outputs)]
    return "\n".join([f"module {name} (input wire clk_i, input wire in_i, output reg out_o);",
                      f"    reg [{width - 1}:0] in_q;", f"    reg [{result - 1}:0] out_q;", f"    wire [{result - 1}:0] out_d;",
                      f"    always @(posedge clk_i) {{in_q, out_q, out_o}} <= {{in_q[{width - 2}:0], in_i, out_d, ^out_q}};",
                      f"    {instance} ({', '.join(pins)});", "endmodule", ""])


def registered(name, inputs, outputs, instance, clock="clk_i"):
    """A top whose ports are registers, so that what is measured starts and ends in one."""
    ports = [f"input wire [{w - 1}:0] {n}" for n, w in inputs] + \
            [f"output reg [{w - 1}:0] {n}" for n, w in outputs]
    body = [f"reg [{w - 1}:0] {n}_q; always @(posedge clk_i) {n}_q <= {n};" for n, w in inputs] + \
           [f"wire [{w - 1}:0] {n}_d; always @(posedge clk_i) {n} <= {n}_d;" for n, w in outputs]
    pins = [f".{clock}(clk_i)"] + [f".{n}({n}_q)" for n, _ in inputs] + [f".{n}({n}_d)" for n, _ in outputs]
    return "\n".join([f"module {name} (input wire clk_i, {', '.join(ports)});", *body,
                      f"    {instance} ({', '.join(pins)});", "endmodule", ""])


def depths(top):
    """The core by number of cuts, each as if it were a configuration."""
    mode = {"subnormal": 1, "nearest": 1, "finite": 0, "fraction": 23, "interleave": int(top == "fp_fma")}
    return [{"name": f"cuts{cuts.bit_count()}", **split(top, cuts), **mode} for cuts in DEPTHS[top]]


def split(top, cuts):
    """The keys that say where a core is cut. A fused multiply-add has the multiplier's first four cuts, and then the adder's."""
    return {"fp_add": {"add_cuts": cuts}, "fp_mul": {"mul_cuts": cuts}, "fp_fma": {"add_cuts": cuts >> 4, "mul_cuts": cuts & 15}}[top]


def core(top, row, around):
    cuts = {"fp_add": row.get("add_cuts"), "fp_mul": row.get("mul_cuts"),
            "fp_fma": row.get("add_cuts", 0) << 4 | row.get("mul_cuts", 0) & 15}[top]
    width = 9 + row["fraction"]
    inputs = {"fp_add": [("sub_i", 1), ("a_i", width), ("b_i", width)], "fp_mul": [("a_i", width), ("b_i", width)],
              "fp_fma": [("x_i", width), ("y_i", width), ("no_product_i", 1), ("subtract_i", 1), ("z_i", width)]}[top]
    own = f".CUTS(11'd{cuts})" if top == "fp_fma" else f".FINITE({row['finite']}), .CUTS(7'd{cuts})"
    parameters = f".FRAC({row['fraction']}), .SUBNORMAL({row['subnormal']}), .NEAREST({row['nearest']}), {own}"
    wrapper = around("top", inputs, [("z_o", width), ("flags_o", 5)], f"fp3_{top} #({parameters}) u_{top}")
    return cuts.bit_count(), wrapper, []


def log_unit(top, around):
    parameters, bits, words, cuts = LOGS[top]
    wrapper = around("top", [(name, 1) for name in bits] + [(name, 32) for name in words], [("z_o", 32), ("flags_o", 5)], f"fp3_{top} {parameters}u_{top}")
    return cuts, wrapper if cuts else wrapper.replace(f"u_{top} (.clk_i(clk_i), ", f"u_{top} (")


# Lanes of a group and their arithmetic between registers; the headers know how wide the bundles are.
GROUP = """`include "lane/bundles.vh"
module top #(
{parameters}) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    input  wire [`FP3_REACH_W-1:0]  reach_i,
    input  wire [`FP3_LANE_ISSUE_W-1:0]  issue_i,
    input  wire [`FP3_LANE_RETIRE_W-1:0] retire_i,
    input  wire [`FP3_ACCESS_W-1:0] access_i,
    input  wire [`FP3_REPORT_W-1:0] report_i,
    input  wire [31:0]          data_i,
    input  wire [DRAW_W-1:0]    draw_i,
    output reg  [`FP3_REACH_W-1:0]  reach_o,
    output reg  [`FP3_LANE_ISSUE_W-1:0]  issue_o,
    output reg  [`FP3_LANE_RETIRE_W-1:0] retire_o,
    output reg  [`FP3_ACCESS_W-1:0] access_o,
    output reg  [`FP3_REPORT_W-1:0] report_o,
    output reg  [31:0]          data_o,
    output reg  [DRAW_W-1:0]    draw_o
);
    reg                  rst_q;
    reg  [`FP3_REACH_W-1:0]  reach_q;
    reg  [`FP3_LANE_ISSUE_W-1:0]  issue_q;
    reg  [`FP3_LANE_RETIRE_W-1:0] retire_q;
    reg  [`FP3_ACCESS_W-1:0] access_q;
    reg  [`FP3_REPORT_W-1:0] report_q;
    reg  [31:0]          data_q;
    reg  [DRAW_W-1:0]    draw_q;
    wire [`FP3_REACH_W-1:0]  reach_d;
    wire [`FP3_LANE_ISSUE_W-1:0]  issue_d;
    wire [`FP3_LANE_RETIRE_W-1:0] retire_d;
    wire [`FP3_ACCESS_W-1:0] access_d;
    wire [`FP3_REPORT_W-1:0] report_d;
    wire [31:0]          data_d;
    wire [DRAW_W-1:0]    draw_d;
    wire [`FP3_OPERANDS_W*{n}*STREAMS-1:0] operands;
    wire [`FP3_RESULT_W*{n}*STREAMS-1:0]   results;
    always @(posedge clk_i) begin
        {{reach_q, reach_o}} <= {{2*`FP3_REACH_W{{NEIGHBOURS != 0}}}} & {{reach_i, reach_d}};     // else it is 0, and costs nothing
        {{draw_q, draw_o}}   <= {{2*DRAW_W{{STORAGE != 0}}}} & {{draw_i, draw_d}};
        {{rst_q, issue_q, retire_q, access_q, report_q, data_q}} <= {{rst_i, issue_i, retire_i, access_i, report_i, data_i}};
        {{issue_o, retire_o, access_o, report_o, data_o}} <= {{issue_d, retire_d, access_d, report_d, data_d}};
    end
    fp3_lane_group #(.CONFIG(CONFIG), .N({n})) u_group (.clk_i(clk_i), .first_i({{LANE_W{{1'b0}}}}), .rst_i(rst_q), .rst_o(),
        .reach_i(reach_q), .issue_i(issue_q), .retire_i(retire_q), .access_i(access_q), .report_i(report_q), .data_i(data_q), .draw_i(draw_q),
        .reach_o(reach_d), .issue_o(issue_d), .retire_o(retire_d), .access_o(access_d), .report_o(report_d), .data_o(data_d), .draw_o(draw_d),
        .operands_o(operands), .result_i(results), .written_o());
    genvar s;
    generate
        for (s = 0; s < {n} * STREAMS; s = s + 1) begin : g_socket
            fp3_unit #(.STREAM(s % STREAMS), .CONFIG(CONFIG)) u_unit (.clk_i(clk_i),
                .operands_i(operands[`FP3_OPERANDS_W*s +: `FP3_OPERANDS_W]), .result_o(results[`FP3_RESULT_W*s +: `FP3_RESULT_W]));
        end
    endgenerate
endmodule
"""


def lanes(row, n):
    """A group of n lanes and their arithmetic. The parameters are those of config.vh, with this row's CONFIG."""
    keys = "\n".join(parameters.config_keys_verilog(row, load(ROOT).keys))
    widths = (ROOT / "rtl/config/config.vh").read_text(encoding="utf-8").replace('`include "gen/parameters.vh"', keys)
    return None, GROUP.format(parameters=widths, n=n), []


def processor(row, around):
    ports = [p for p in verilog.ports(row, load(ROOT).registers) if p and p[2] != "s_axi_aclk"]
    inputs = [(name, width) for direction, width, name in ports if direction == "input"]
    outputs = [(name, width) for direction, width, name in ports if direction == "output"]
    made = tops.write(row, load(ROOT), ROOT / WORK).relative_to(ROOT)
    return None, around("top", inputs, outputs, f"{made.stem} u_{made.stem}", "s_axi_aclk"), [made.as_posix()]


def cells(path):
    """How many cells of each type a netlist has, modules that were kept included."""
    modules = json.loads(path.read_text(encoding="utf-8"))["modules"]

    def inside(name):
        found = collections.Counter()
        for cell in modules[name]["cells"].values():
            inner = modules.get(cell["type"], {"attributes": {"blackbox": 1}})
            found += collections.Counter([cell["type"]]) if "blackbox" in inner.get("attributes", {}) else inside(cell["type"])
        return found
    return inside("top")


def figures(name, family):
    found = cells(ROOT / WORK / f"{name}.json")
    return {figure: math.ceil(sum(n * weight for kind, weight in kinds.items() for cell, n in found.items() if re.fullmatch(kind, cell)))
            for figure, kinds in family.kinds.items()}


def run(tool, arguments, log, files):
    """Runs a tool, unless its log is of the same command on the same files, and it ended well."""
    told = hashlib.sha256(json.dumps([flow.version(tool), *map(str, arguments)]).encode())
    for file in sorted(files):
        told.update((ROOT / file).read_bytes())
    done = (ROOT / log).with_suffix(".done")
    if done.exists() and done.read_text() == told.hexdigest():
        return
    done.unlink(missing_ok=True)
    with open(ROOT / log, "w", encoding="utf-8") as out:
        ended = subprocess.run([tool, *map(str, arguments)], cwd=ROOT, stdout=out, stderr=subprocess.STDOUT)
    if ended.returncode:
        tail = (ROOT / log).read_text(encoding="utf-8", errors="replace").splitlines()[-5:]
        raise RuntimeError(f"{log}: " + " / ".join(tail))
    done.write_text(told.hexdigest())


def loosen(path, cell, port, driver, output):
    """Takes a port's connection away from cells where the port's driver is the constant cell."""
    netlist = json.loads(path.read_text(encoding="utf-8"))
    for module in netlist["modules"].values():
        constants = {bit for c in module["cells"].values() if c["type"] == driver for bit in c["connections"][output]}
        for c in module["cells"].values():
            if c["type"] == cell and constants & set(c["connections"].get(port, [])):
                del c["connections"][port], c["port_directions"][port]
    path.write_text(json.dumps(netlist), encoding="utf-8")


def synthesise(tools, name, wrapper, files, family, own):
    path, netlist = WORK / f"{name}.v", ROOT / WORK / f"{name}.json"
    (ROOT / path).write_text(wrapper, encoding="utf-8")
    sources = [*flow.sources(family, own), *files, str(path)]
    script = f"read_verilog -Irtl -Irtl/gen {' '.join(sources)}; " + FAMILIES[family].synth.format(top="top", json=WORK / f"{name}.json")
    run(flow.tool(tools, "yosys"), ["-p", script], WORK / f"{name}.yosys.log", {*sources, *(f"rtl/{header}" for header in fusesoc.headers(ROOT))})
    if FAMILIES[family].loose:
        loosen(netlist, *FAMILIES[family].loose)


def place(tools, name, device, grade, seed):
    """Logic cells, and MHz, of one placement."""
    family, stem = FAMILIES[DEVICES[device].family], WORK / f"{name}-{device}-{grade}-{seed}"
    if family.pin:
        pins = zip(("clk_i", "in_i", "out_o"), DEVICES[device].sites)
        (ROOT / f"{stem}.pins").write_text("".join(family.pin.format(port=port, site=site) + "\n" for port, site in pins))
    words = flow.place(device, grade, f"{stem}.pins" if family.pin else None, seed=seed, mhz=GOAL, json=WORK / f"{name}.json",
                       report=f"{stem}.report.json")
    run(flow.tool(tools, family.tool), words, f"{stem}.nextpnr.log", {WORK / f"{name}.json"})
    report = json.loads((ROOT / f"{stem}.report.json").read_text(encoding="utf-8"))
    if not report["fmax"]:
        raise RuntimeError(f"{stem}.report.json: no clock was timed")
    mhz = min(clock["achieved"] for clock in report["fmax"].values())
    print(f"  {name}  {device}  grade {grade}  seed {seed}  {mhz:.1f} MHz", flush=True)
    return report["utilization"].get(family.placed, {"used": 0})["used"], mhz


def too_much(used, device):
    """Per cent of what a device has, of each figure that it has less of."""
    return {figure: round(100 * used[figure] / has, 1) for figure, has in (DEVICES[device].has or {}).items() if used[figure] > has}


def result(top, config, device, grade, seeds, cuts, used, placements, tools, goal, untimed=False):
    """A row. Without placements, its clock is unknown."""
    mhz = [m for _, m in placements]
    return measured.timed({
        "top": top, "config": config, "device": device, "grade": grade, "seeds": seeds if mhz else [],
        **used, "comb": placements[0][0] if mhz else None, "over": too_much(used, device), "cuts": cuts,
        "fmax_median": round(statistics.median(mhz), 2) if mhz else None, "fmax_best": round(max(mhz), 2) if mhz else None,
        "fmax_all": [round(m, 2) for m in mhz], "goal": goal, "untimed": untimed, "tools": tools,
    }, cuts + 1 if cuts is not None else measured.cycles_per_step(config) if top in ("fp3", "chip") else None)


def numbers(text):
    if not re.fullmatch(r"\d+(,\d+)*", text):
        raise argparse.ArgumentTypeError(f"'{text}' is not a list such as 1,2,3")
    return [int(word) for word in text.split(",")]


def variants(top, row, family):
    """A configuration's designs: its name, and whether they use the family's own versions of modules."""
    if not flow.has_own(family, row) or (family == "ecp5" and top in ("fp_add", "fp_mul")):
        return [(row["name"], False)]
    return [(row["name"], True)] + [(f"{row['name']}-inferred", False)] * (top == "lane")


def trimmed(configs, designs):
    trims = []
    for config, changes in TRIMS.items():
        base = next(row for row in configs if row["name"] == config)
        for what, change in changes.items():
            known = load(ROOT).keys
            row = derive(by_number({**base, "store_words": 1024, **change, "name": f"trim{len(trims)}"}, known, what), known)
            source = "\n".join(verilog.config_verilog(row, load(ROOT), ROOT)) + "\n" + processor(row, registered)[1]
            designs[source, "ecp5", True] = (f"trim-{len(trims)}", [])
            trims.append((what, next(iter(changes)), f"trim-{len(trims)}"))
    return trims


def too_large(top, row, device):
    """Whether the store alone has more block RAMs than an ECP5."""
    blocks = DEVICES[device].has["ebr"] if DEVICES[device].family == "ecp5" else max(d.has["ebr"] for d in DEVICES.values() if d.has)
    large = top not in CORES and row["interleave"] \
        and row["store_words"] * (LANES.get(top) or row["tiles"] * row["schedulers"] * row["lanes"]) > 512 * blocks
    if large:
        print(f"{top}, {row['name']}: left out, its store alone has more than {blocks} block RAMs", flush=True)
    return large


def plan(args, configs):
    """The designs by their source; what is wanted of them; the trimmed ones. What is the same design under
    two names is synthesised and placed once."""
    designs, wanted, trims = {}, [], []
    for top in args.top or TOPS:
        if top == "trim":
            trims = trimmed(configs, designs)
            continue
        if top in LOGS:
            for device in args.device:
                family = DEVICES[device].family
                cuts, wrapper = log_unit(top, narrow if FAMILIES[family].pin else registered)
                designs[wrapper, family, True] = (top + f"-{family}" * (family != "ecp5"), [f"tests/lns/fp3_{top}.v"] * ("float" in top))
                wanted.append((top, "any", device, cuts, designs[wrapper, family, True][0], False))
            continue
        for row in configs + (depths(top) if top in CORES else []):
            if top == "fp_fma" and not row.get("fused") and not row["name"].startswith("cuts"):
                continue
            if top in LANES and (not row["interleave"] or row["tiles"] * row["schedulers"] > 1 or row["lanes"] < LANES[top]):
                continue
            for device in args.device:
                family = DEVICES[device].family
                for name, own in variants(top, row, family):
                    if (args.config and name not in args.config) or too_large(top, row, device):
                        continue
                    around = narrow if FAMILIES[family].pin else registered
                    cuts, wrapper, files = core(top, row, around) if top in CORES else \
                        lanes(row, LANES[top]) if top in LANES else processor(row, around)
                    design, _ = designs.setdefault((wrapper, family, own), (f"{top}-{name}" + f"-{family}" * (family != "ecp5"), files))
                    wanted.append((top, name, device, cuts, design, top != "fp_add" and flow.is_untimed(family, row)))
    return designs, wanted, trims


def trim(what, base, name):
    """Cells of a netlist that is not placed, and what it is to be compared with."""
    return {"what": what, "base": base, **figures(name, FAMILIES["ecp5"])}


def arguments(configs):
    names = [name for row in configs for name, _ in variants("lane", row, "ecp5")] + sorted({row["name"] for top in CORES for row in depths(top)})
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--top", choices=(*TOPS, *LOGS), action="append", help="default: all of them but lns_...")
    parser.add_argument("--config", choices=names, action="append", help="default: all of them")
    parser.add_argument("--sizes", action="store_true", help=f"--top fp3 of {', '.join(SIZES)}")
    parser.add_argument("--device", choices=DEVICES, action="append", help="default: LFE5U-85F; with --sizes all of them")
    parser.add_argument("--grades", type=numbers, help="speed grades (default: 6,8 of an ECP5, else the fastest)")
    parser.add_argument("--seeds", type=numbers, default=[1, 2, 3], help="of the placement (default: 1,2,3)")
    parser.add_argument("--unplaced", action="store_true", help="synthesis only, for all devices")
    parser.add_argument("--jobs", type=int, default=1, help="tools at a time (default: %(default)s)")
    parser.add_argument("--tools", type=pathlib.Path, default=flow.TOOLS, help="where yosys and nextpnr are (default: %(default)s)")
    args = parser.parse_args()
    if args.sizes:
        args.top, args.config = ["fp3"], args.config or list(SIZES)
    args.device = args.device or (list(DEVICES) if args.sizes else ["LFE5U-85F"])
    for device in args.device:
        if set(args.grades or []) - set(DEVICES[device].grades):
            parser.error(f"the speed grades of {device} are {', '.join(map(str, DEVICES[device].grades))}")
        if DEVICES[device].family != "ecp5" and {*LANES, "trim"} & set(args.top or TOPS):
            parser.error(f"{device}: lane, group and trim are of ECP5")
    return args


def grades(args, device):
    return args.grades or DEVICES[device].grades[:2 if DEVICES[device].family == "ecp5" else 1]


def programs(args, devices):
    """The programs that rows of these devices take: yosys, and the placers."""
    placers = {FAMILIES[DEVICES[device].family].tool for device in devices} if not args.unplaced else set()
    return ["yosys", *sorted(name for name in placers if name)]


def measure(args, pool, wanted, trims):
    """Places what fits. The rows, and what went wrong: one placement that fails stops no other."""
    rows, failed, jobs = [], [], {}
    used = {(name, device): figures(name, FAMILIES[DEVICES[device].family]) for _, _, device, _, name, _ in wanted}
    untimed = {(name, device) for _, _, device, _, name, is_untimed in wanted if is_untimed}
    for name, device in used:
        over = too_much(used[name, device], device)
        if over:
            print(f"  {name}  {device}: not placed, it takes " + ", ".join(f"{p} % of {f}" for f, p in over.items()), flush=True)
        elif (name, device) in untimed:
            print(f"  {name}  {device}: not placed, there are no registers around its multipliers", flush=True)
        elif FAMILIES[DEVICES[device].family].tool and not args.unplaced:
            jobs |= {(name, device, grade, seed): pool.submit(place, args.tools, name, device, grade, seed)
                     for grade in grades(args, device) for seed in args.seeds}
    for top, config, device, cuts, name, is_untimed in wanted:
        family = FAMILIES[DEVICES[device].family]
        tools = [flow.version(flow.tool(args.tools, name)) for name in programs(args, [device])]
        for grade in grades(args, device):
            try:
                placements = [jobs[key].result() for key in [(name, device, grade, seed) for seed in args.seeds] if key in jobs]
                row = result(top, config, device, grade, args.seeds, cuts, used[name, device], placements, tools, GOAL, is_untimed)
            except RuntimeError as error:
                failed.append(str(error))
                continue
            rows.append(row)
            measured.add([row], [trim(*t) for t in trims])
    if not wanted:
        measured.add([], [trim(*t) for t in trims])
    return rows, failed


def main():
    try:
        configs = load(ROOT).configs
    except Bad as bad:
        sys.exit(f"synth.py: {bad}")
    args = arguments(configs)
    (ROOT / WORK).mkdir(parents=True, exist_ok=True)

    designs, wanted, trims = plan(args, configs)
    with ThreadPoolExecutor(args.jobs) as pool:
        try:
            flow.require(args.tools, programs(args, {device for _, _, device, *_ in wanted}))
            print(f"Synthesising {len(designs)} designs", flush=True)
            for done in [pool.submit(synthesise, args.tools, name, wrapper, files, family, own)
                         for (wrapper, family, own), (name, files) in designs.items()]:
                done.result()
            if not args.unplaced:
                print(f"Placing with {len(args.seeds)} seeds", flush=True)
            rows, failed = measure(args, pool, wanted, trims)
        except (OSError, RuntimeError) as error:
            pool.shutdown(cancel_futures=True)
            sys.exit(f"synth.py: {error}")

    heads = ["top", "config", "device", "grade", "lut4", "comb", "ff", "dsp", "ebr", "cuts", "fmax_median", "fmax_best", "latency_ns"]
    print("\n".join([*columns([heads, *(["-" if row[h] is None else str(row[h]) for h in heads] for row in rows)], 2), "Written to build/results/synth.json",
                     *(measured.compared(rows) if args.unplaced else [])]))
    if failed:
        sys.exit("\n".join(f"synth.py: {error}" for error in failed))


if __name__ == "__main__":
    main()
