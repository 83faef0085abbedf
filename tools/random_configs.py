#!/usr/bin/env python3
"""Builds random configurations and tests each as the named ones are: random programs against the isa engine at every
retirement, every address of the host port, schedulers with programs of their own.

    tools/random_configs.py --count 200 --seed 1 --jobs 2
    tools/random_configs.py --seed 1 --only 17 --keep DIR     that one again; what was built stays in DIR

Needs what `make all` has built: only what knows which configurations there are is compiled anew. Ends with 1 if one
configuration failed.
"""

import argparse
import concurrent.futures
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time

from fp3fpga import one_config
from fp3gen import configs
from fp3gen.check import Bad
from fp3gen.read import load
from fp3fpga.one_config import LIBS, Failed, run

ROOT = pathlib.Path(__file__).resolve().parents[1]
KNOWN = load(ROOT).keys
TESTS = ("random_stream", "host_port", "different_programs", "chosen_values", "mix")


# ---- chance -------------------------------------------------------------------------------------

def organisation(rng):
    """Tiles, schedulers, lanes: lanes and schedulers exclude each other."""
    tiles, schedulers, lanes = rng.choice(
        [(1, 1, 1)] * 3 + [(rng.randint(2, 4), 1, 1), (1, rng.randint(2, 5), 1), (1, 1, rng.randint(2, 8)),
                           (2, rng.randint(2, 3), 1), (2, 1, rng.randint(2, 3))])
    return {"tiles": tiles, "schedulers": schedulers, "lanes": lanes}


def latencies(rng):
    row = {}
    for unit, cuts in (("add", 7), ("mul", 7)):
        row[f"{unit}_cuts"] = mask = rng.choice([0, rng.getrandbits(cuts), rng.getrandbits(cuts) & rng.getrandbits(cuts)])
        row[f"{unit}_latency"] = mask.bit_count() + 1 + rng.choice([0, 0, 0, 1, rng.randint(0, 12)])
    return row


def interleaved(rng):
    row = organisation(rng)
    row["registers"] = rng.choice([2, 4, 8, 16, 32, 64])
    row["contexts"] = rng.choice([1, 2, 3, rng.randint(1, 16), rng.randint(1, 64), rng.randint(1, 64), 64])
    # Objects for all contexts, of the smallest records at least; sometimes exactly.
    least = max(8 << max(row["contexts"] - 1, 1).bit_length(), row["registers"])
    row["store_words"] = least << rng.choice([0, 0, 1, 2, 3, rng.randint(0, 6)])
    row["sleep"] = rng.choice([0, 1, 1])
    row["flags"] = rng.choice([0, 1, 1, 1])
    row["status"] = row["flags"] and rng.choice([0, 1, 1])
    row["bypass"] = 0
    return row


def one_object(rng):
    return {"registers": rng.choice([2, 4, 8, 16, 32, 64]), "bypass": rng.randint(0, 1), "flags": 1,
            "writeback_stall": rng.randint(0, 1)}


def draw(rng):
    return said(drawn(rng))


def said(row):
    """What was drawn, in the keys of isa/configs.toml."""
    row = dict(row)
    chain, fused, both, gradual, nearest, flags, status, estimate, bypass, stall = (
        row.pop(name, 0) for name in ("chain", "fused", "dual", "subnormal", "nearest", "flags", "status", "estimate", "bypass", "writeback_stall"))
    row["multiply_add"] = "dual" if both else "fused" if fused else "chain" if chain else "none"
    row["arithmetic"] = {(1, 1): "ieee", (1, 0): "truncated", (0, 1): "flushed", (0, 0): "truncated_flushed"}[gradual, nearest]
    row["exceptions"] = "object" if status else "run" if flags else "none"
    row["reciprocal"] = "estimate" if estimate else "none"
    if "store_words" not in row:
        row["writeback"] = "stall" if stall else "bypass" if bypass else "slot"
    return row


def drawn(rng):
    row = interleaved(rng) if rng.random() < 0.85 else one_object(rng)
    row |= latencies(rng)
    row |= {key: rng.choice([0, 1, 1, 1]) for key in ("chain", "subnormal", "nearest")}
    row |= {"select": row["chain"] and rng.choice([0, 1, 1]), "estimate": rng.choice([0, 1, 1])}
    # Whatever else makes instructions.
    row |= {name: rng.choice([0, 1, 1]) for name, key in KNOWN.items() if "lack" in key and "is" not in key and name not in row and name != "fused"
            and all(row.get(other) for other in key.get("needs", []))}
    row["program_words"] = rng.choice([64, 128, 256, 512, 1024, 2048, 8192])
    chance = random.Random(repr(row))          # of its own: the draws above stay as they are
    kind = chance.random()
    fraction = random.Random(repr(row) + "fraction").choice([23, 23, 7, 15, 18, 22])
    if row.get("schedulers") == 1 and kind < 0.2:
        return dual(row)
    row |= {"fraction": fraction}
    if row.get("schedulers", 1) == 1 and kind > 0.8:
        row |= {"fused": 1, "chain": 0}
    row |= {"counters": random.Random(repr(row) + "counters").choice([0, 1, 1])}
    halves = row | {"storage": random.Random(repr(row) + "storage").choice([0, 1, 2])}
    row, halves = (one | {"master": random.Random(repr(one) + "master").choice([0, 0, 1])} for one in (row, halves))
    return halves if is_possible({"name": "halves", "doc": "Halves."} | said(halves)) else row


def dual(row):
    """What adds and multiplies at once, and leaves out what then cannot be."""
    left_out = KNOWN["dual"]["excludes"] + ["select"]
    return row | dict.fromkeys(left_out, 0) | {"dual": 1, "registers": max(4, row["registers"])}


def is_possible(row):
    """What goes with what, the generator knows."""
    try:
        configs.check_configs([row], KNOWN)
    except Bad:
        return False
    return True


def random_config(seed, number):
    """As a table of configs.toml has it."""
    rng = random.Random(f"{seed}/{number}")
    name = {"name": f"random_{number}", "doc": f"Seed {seed}, number {number}."}
    return next(row for row in (name | draw(rng) for _ in range(100)) if is_possible(row))


# ---- a build ------------------------------------------------------------------------------------

def build(row, tree, made):
    one_config.build(row, tree, made)
    sanitize = ["-fsanitize=address,undefined"] if made.name.endswith("-san") else []          # as what is linked was compiled
    for name in TESTS:
        run("gcc", *sanitize, "-o", tree / name, made / f"obj/tests/cosim/{name}.o", tree / "own.o", made / "lib/libfp3.a", *LIBS)


def test(row, tree, seed, instructions):
    """What the last line of the random programs says."""
    own = ("env", f"FP3_RTL_DIR={tree}")
    out = run(*own, tree / "random_stream", "--instructions", instructions, "--seed", 1 + 1000000 * seed)
    run(*own, tree / "host_port")
    if row.get("storage"):             # the others write numbers that a record of 16 bits has not
        return told(out)
    run(*own, tree / "different_programs", seed + 1, 10)
    run(*own, tree / "chosen_values", 17)
    if row["registers"] >= 4:          # as its programs have
        run(*own, tree / "mix", seed + 1, 10)
    return told(out)


def told(out):
    return re.search(r": (\d+ instructions)", out)[1]


# ---- many of them -------------------------------------------------------------------------------

def one(args, number, scratch):
    """None, or what went wrong."""
    row = random_config(args.seed, number)
    tree, begin = scratch / row["name"], time.monotonic()
    what = " ".join(f"{key}={value}" for key, value in row.items() if key not in ("name", "doc"))
    try:
        build(row, tree, args.build.resolve())
        told = test(row, tree, args.seed + number, args.instructions)
    except (Failed, Bad, subprocess.TimeoutExpired) as error:
        return f"FAIL number {number}: {what}\n{error}\n  again: tools/random_configs.py --seed {args.seed} --only {number} --keep DIR"
    if not args.keep:
        shutil.rmtree(tree)
    print(f"{number}: {what}: {told} agree, {time.monotonic() - begin:.0f} s", flush=True)
    return None


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="how many (200)")
    parser.add_argument("--seed", type=int, default=1, help="of all of them (1)")
    parser.add_argument("--jobs", type=int, default=2, help="at a time (2)")
    parser.add_argument("--instructions", type=int, default=30000, help="of random programs, at least, in each (30000)")
    parser.add_argument("--first", type=int, default=0, help="the number of the first (0)")
    parser.add_argument("--only", type=int, help="the number of one configuration")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build", help="what make has built (build)")
    parser.add_argument("--keep", type=pathlib.Path, help="an empty directory for all that is built")
    return parser.parse_args()


def main():
    args = parse()
    scratch = args.keep or pathlib.Path(tempfile.mkdtemp(prefix="fp3-random-"))
    numbers = range(args.first, args.first + args.count) if args.only is None else [args.only]
    failed = 0
    try:
        with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
            for wrong in pool.map(lambda number: one(args, number, scratch), numbers):
                if wrong:
                    failed += 1
                    print(wrong, flush=True)
    finally:
        if not args.keep:
            shutil.rmtree(scratch)
    print(f"{len(numbers)} configurations, {failed} failed")
    sys.exit(failed != 0)


if __name__ == "__main__":
    main()
