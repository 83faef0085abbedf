#!/usr/bin/env python3
"""An LFE5U-85F full of lanes: `make chip`, and the same array in simulation: `make chip-run`.

    tools/chip.py --lanes 36 --grade 6 --seeds 1       synthesis, floorplan, place and route, timing
    tools/chip.py --lanes 36 --run                     its cycles and its answers, against the engine isa
    tools/chip.py --config dual ...                    lanes that add and multiply at once
    tools/chip.py --set sleep=0 --set arithmetic=flushed ...  without what these keys of isa/configs.toml stand for

The design is configuration `lanes` or `dual` with another number of lanes, and perhaps other keys. A group of lanes and their arithmetic are each synthesised once;
each lane's multipliers and block RAMs are pinned (tools/fp3gen/floorplan.py). Place and route takes half an hour and more.
Ends with 1 where the clock is below --mhz, or a word differs.

Results go to build/results/synth.json as rows of the top `chip`, as tools/synth.py has them, and the cycles of --run to
build/results/chip.json; the rest goes to build/synth/.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

from fp3fpga import flow
import measured
import synth
from fp3fpga.families import FAMILIES
from fp3gen import floorplan, fusesoc, verilog
from fp3gen.check import Bad
from fp3gen.configs import check_configs, settable
from fp3gen.read import load
from fp3fpga.one_config import LIBS, Failed, build, run

ROOT, WORK, DEVICE = synth.ROOT, synth.WORK, "LFE5U-85F"
ONCE = "*lane_group* *unit"     # modules that are synthesised once
ALONE = 1.25                           # the clock wanted of the scheduler alone: routed among lanes it will be slower
TRIES = 16                             # placements of it, of which the fastest is taken
FIXED = ("name", "doc", "take", "tiles", "schedulers", "lanes", "multiply_add")  # what --set may not change
PROGRAMS = {"lanes": "ship_madd", "dual": "ship_dual"}


def array(args):
    """The configuration."""
    machine = load(ROOT)
    base = next(row for row in machine.configs if row["name"] == args.config)
    given = dict(sorted(args.set))
    name = f"{args.config}{args.lanes}" + "".join(f"_{key}_{value}" for key, value in given.items())
    row = {**settable(base, machine.keys), "lanes": args.lanes, **given, "name": name, "doc": f"{args.lanes} lanes under one scheduler."}
    return check_configs([row], machine.keys)[0]


def netlist(tools, row):
    """Synthesises it and pins it. The name of the netlist, and its figures."""
    name = f"chip-{row['name']}"
    _, wrapper, _ = synth.processor(row, synth.registered)
    source = "\n".join(verilog.config_verilog(row, load(ROOT), ROOT)) + "\n" + wrapper
    (ROOT / WORK / f"{name}.v").write_text(source, encoding="utf-8")
    sources = [*flow.sources("ecp5", flow.has_own("ecp5", row)), str(WORK / f"{name}.v")]
    script = (f"read_verilog -Irtl -Irtl/gen {' '.join(sources)}; hierarchy -top top; setattr -mod -set keep_hierarchy 1 {ONCE}; "
              f"synth_ecp5 -abc9 -top top; setattr -mod -unset keep_hierarchy {ONCE}; flatten; opt_merge; opt_clean; "
              f"write_json {WORK / name}.json")
    synth.run(flow.tool(tools, "yosys"), ["-p", script], WORK / f"{name}.yosys.log",
              {*sources, *(f"rtl/{header}" for header in fusesoc.headers(ROOT))})
    design = json.loads((ROOT / WORK / f"{name}.json").read_text(encoding="utf-8"))
    for module in design["modules"].values():                       # places in the sources are most of the file
        for part in (*module["cells"].values(), *module["netnames"].values()):
            part["attributes"].pop("src", None)
    print(f"  {floorplan.trim(design)} carries that nobody reads, {floorplan.pin(design, row['lanes'])} cells pinned, "
          f"{floorplan.ground(design)} zeros from the lane itself", flush=True)
    (ROOT / WORK / f"{name}-pinned.json").write_text(json.dumps(design), encoding="utf-8")
    return name, synth.figures(name, FAMILIES["ecp5"])


def place(args, name, seed):
    """Cells and MHz of one placement: of the scheduler alone, then of all around it."""
    stem, pinned = WORK / f"{name}-{args.grade}-{seed}", f"{WORK / name}-pinned.json"
    design = json.loads((ROOT / pinned).read_text(encoding="utf-8"))
    (ROOT / f"{stem}-alone.json").write_text(json.dumps(floorplan.control(design)), encoding="utf-8")

    def started(what, netlist, *more, mhz, seed=seed):
        words = flow.place(DEVICE, args.grade, seed=seed, mhz=mhz, json=f"{stem}-{netlist}.json", report=f"{stem}-{what}.report.json")
        synth.run(flow.tool(args.tools, "nextpnr-ecp5"), [*words, *more], f"{stem}-{what}.nextpnr.log", {f"{stem}-{netlist}.json"})

    def alone(n):
        """MHz that nextpnr expects of the scheduler's n-th placement; it tells them in its log alone where it does not route."""
        started(f"alone{n}", "alone", "--no-route", "--write", f"{stem}-alone{n}-placed.json", mhz=ALONE * args.mhz, seed=TRIES * seed + n)
        return float(re.findall(r"Max frequency for clock +'clk_i': ([0-9.]+) MHz", (ROOT / f"{stem}-alone{n}.nextpnr.log").read_text())[-1])

    expected, best = max((alone(n), n) for n in range(TRIES))
    placed = json.loads((ROOT / f"{stem}-alone{best}-placed.json").read_text(encoding="utf-8"))
    print(f"  the scheduler: {expected} MHz expected, {floorplan.settle(design, placed)} cells pinned", flush=True)
    (ROOT / f"{stem}-chip.json").write_text(json.dumps(design), encoding="utf-8")
    started("chip", "chip", mhz=args.mhz)
    report = json.loads((ROOT / f"{stem}-chip.report.json").read_text(encoding="utf-8"))
    mhz = min(clock["achieved"] for clock in report["fmax"].values())
    print(f"  grade {args.grade}, seed {seed}: {mhz:.1f} MHz", flush=True)
    return report["utilization"]["TRELLIS_COMB"]["used"], mhz


def make(args):
    row = array(args)
    flow.require(args.tools, ("yosys", "nextpnr-ecp5"))
    (ROOT / WORK).mkdir(parents=True, exist_ok=True)
    name, used = netlist(args.tools, row)
    placed = [place(args, name, seed) for seed in args.seeds]
    tools = [flow.version(flow.tool(args.tools, name)) for name in ("yosys", "nextpnr-ecp5")]
    result = synth.result("chip", row["name"], DEVICE, args.grade, args.seeds, None, used, placed, tools, args.mhz)
    measured.add([result])
    print(json.dumps(result, indent=2))
    if result["fmax_best"] < args.mhz:
        sys.exit(f"chip.py: {result['fmax_best']} MHz, wanted {args.mhz}")


def simulate(args):
    """The ship on the array: the engine rtl against the engine isa, word by word, and its cycles."""
    made, row = args.build.resolve(), array(args)
    with tempfile.TemporaryDirectory(prefix="fp3-chip-") as scratch:
        tree = pathlib.Path(scratch) / "tree"
        build(row, tree, made)
        objects = [made / f"obj/sw/cli/{path.stem}.o" for path in sorted((ROOT / "sw/cli").glob("*.c"))]
        run("gcc", "-o", tree / "fp3", *objects, made / "obj/measure.a", tree / "own.o", made / "lib/libfp3_lab.a", "-ljansson", *LIBS)
        is_file = args.program.endswith(".s")
        source = pathlib.Path(args.program).resolve() if is_file else ROOT / f"programs/{args.program}.s"
        params = source.with_suffix(".cfg") if is_file else ROOT / "programs/ship.cfg"
        run(tree / "fp3", "asm", source, "-o", tree / "x.fp3")
        count = args.lanes * row["contexts"]

        def ran(engine, steps):
            """What a run printed, and all states at its end."""
            told = run("env", f"FP3_RTL_DIR={tree}", tree / "fp3", "run", tree / "x.fp3", "-c", row["name"], "--engine", engine, "-N", count,
                       "--steps", steps, "--params", params, "--spread", "T=1e6:2e6", "--every", steps,
                       "--output", tree / f"{engine}.csv", timeout=3600)
            return told, (tree / f"{engine}.csv").read_text().splitlines()

        rtl, isa = ran("rtl", args.steps), ran("isa", args.steps)
        longer, _ = ran("rtl", 2 * args.steps)
        wrong = sum(a != b for a, b in zip(rtl[1], isa[1], strict=True))
        first, second = (int(re.search(r"^cycles +([0-9]+)", text, re.M)[1]) for text in (rtl[0], longer))
        per_step = (second - first) / count / args.steps
        print(f"{row['name']}, {args.program}: {count} objects, {args.steps} steps, {first} cycles; {per_step:.4f} cycles per object-step; "
              f"{wrong} of {len(rtl[1])} lines of states differ from those of isa")
        if wrong:
            sys.exit(1)
        if not is_file:
            keep({"config": row["name"], "program": args.program, "objects": count, "next_cycles": (second - first) / args.steps})


def keep(ran):
    """Adds the run to build/results/chip.json, and its cycles to the rows of that chip."""
    path = ROOT / "build/results/chip.json"
    runs = json.loads(path.read_text(encoding="utf-8"))["runs"] if path.exists() else []
    runs = [old for old in runs if (old["config"], old["program"]) != (ran["config"], ran["program"])] + [ran]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"runs": runs}, indent=2) + "\n", encoding="utf-8")
    cycles = measured.cycles_per_step(ran["config"])
    measured.add([measured.timed(row, cycles) for row in measured.known()["rows"] if (row["top"], row["config"]) == ("chip", ran["config"])])


def setting(text):
    """KEY=VALUE"""
    key, _, value = text.partition("=")
    if not (key and value):
        raise argparse.ArgumentTypeError(f"'{text}' is not KEY=VALUE")
    return key, int(value, 0) if value[0].isdigit() else value


def check_settings(parser, given, why):
    """Refuses a key that is there twice, or that is not to be changed, and says why."""
    for n, (key, _) in enumerate(given):
        if key in dict(given[:n]):
            parser.error(f"--set has '{key}' twice")
        if key in FIXED:
            parser.error(f"--set does not change '{key}': {why}")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--config", choices=PROGRAMS, default="lanes", help="whose lanes (default: %(default)s)")
    parser.add_argument("--lanes", type=int, default=36,
                        help=f"1 to {floorplan.LANES}, of `dual` {floorplan.LANES_OF_5} (default: %(default)s)")
    parser.add_argument("--set", metavar="KEY=VALUE", type=setting, action="append", default=[], help="a key of isa/configs.toml; may be repeated")
    parser.add_argument("--grade", type=int, choices=(6, 7, 8), default=6, help="speed grade (default: %(default)s)")
    parser.add_argument("--seeds", type=synth.numbers, default=[1], help="of the placement (default: 1)")
    parser.add_argument("--mhz", type=float, default=120, help="the clock that is wanted (default: %(default)s)")
    parser.add_argument("--tools", type=pathlib.Path, default=flow.TOOLS, help="where yosys and nextpnr-ecp5 are (default: %(default)s)")
    parser.add_argument("--run", action="store_true", help="simulate instead")
    parser.add_argument("--program", help="for --run: of programs/ (default: ship_madd, of `dual` ship_dual), or a file.s of a ship "
                        "with its params in file.cfg beside it, whose cycles are told and not kept")
    parser.add_argument("--steps", type=int, default=100, help="for --run (default: %(default)s)")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build", help="what make has built (default: %(default)s)")
    args = parser.parse_args()
    args.program = args.program or PROGRAMS[args.config]
    most = floorplan.LANES_OF_5 if args.config == "dual" else floorplan.LANES
    check_settings(parser, args.set, "--config and --lanes say what the chip is full of")
    if not 1 <= args.lanes <= most:
        parser.error(f"an {DEVICE} has multipliers and block RAMs for 1 to {most} lanes of {args.config}")
    return args


def main():
    args = arguments()
    try:
        if args.run:
            simulate(args)
        else:
            make(args)
    except (Bad, Failed, ValueError, RuntimeError, OSError) as error:
        sys.exit(f"chip.py: {str(error)[-2000:]}")


if __name__ == "__main__":
    main()
