"""isa/configs.toml: the keys of a configuration, and the checks of every row."""

import re

from .check import Bad, keys, named, need

MASK_BITS = 7  # positions in a cut mask, as the parameters of rtl/fp3.v count them
# A configuration's keys in the order of FP3_CONFIGS, each with its permitted range. The upper bounds
# of the sizes are what the register map has room for, those of the masks the cuts that a core has;
# check_configs() fills them in.
CONFIG_KEYS = {
    "interleave": (0, 1), "tiles": (1, 64), "schedulers": (1, 8), "lanes": (1, 64),
    "registers": (2, 64), "contexts": (1, 64), "program_words": (2, None), "store_words": (0, None),
    "bypass": (0, 1), "writeback_stall": (0, 1), "chain": (0, 1), "scale": (0, 1), "select": (0, 1), "estimate": (0, 1),
    "sleep": (0, 1), "flags": (0, 1), "status": (0, 1), "subnormal": (0, 1), "nearest": (0, 1), "add_latency": (1, 255),
    "mul_latency": (1, 255), "add_cuts": (0, None), "mul_cuts": (0, None),
}
POWERS_OF_TWO = ("registers", "program_words")
CONFIG_MEANING = {
    "interleave": "0: one object, busy flags, results as early as can be; 1: contexts take turns, all results equally late",
    "tiles": "schedulers or groups of schedulers with an arithmetic unit of their own",
    "schedulers": "schedulers of a tile, which share its arithmetic unit",
    "lanes": "register files and arithmetic units that one scheduler drives",
    "registers": "object registers per context, and as many shared constants",
    "contexts": "objects that a scheduler holds at once, in each lane",
    "program_words": "words of instruction memory",
    "store_words": "words of object store in each lane; 0 where the objects are the contexts",
    "bypass": "1: a result goes straight to an operand that waits for it",
    "writeback_stall": "1: nothing is issued in a cycle in which a result is written",
    "chain": "1: `madd` and `msub` exist",
    "scale": "1: `addh`, `subh`, `addt`, `subt` exist",
    "select": "1: `min`, `max`, `abs`, `lt`, `le`, `sel` exist",
    "estimate": "1: `rcp` and `rsqrt` exist",
    "sleep": "1: `sleep` and `lds` exist",
    "flags": "1: exceptions are flagged",
    "status": "1: for each object, too, with the step of the first invalid or overflow",
    "subnormal": "1: gradual underflow; 0: subnormal numbers are flushed to zero",
    "nearest": "1: rounds to nearest, ties to even; 0: truncates",
    "add_latency": "cycles from operands to result, adder",
    "mul_latency": "cycles from operands to result, multiplier",
    "add_cuts": "where the adder is cut by registers, one bit per position",
    "mul_cuts": "where the multiplier is cut by registers, one bit per position",
}


def cut_positions(root, core):
    """How many cuts a core has, as its source says."""
    try:
        found = re.search(r"parameter *\[(\d+):0\] *CUTS\b", (root / f"rtl/fp/{core}.v").read_text(encoding="utf-8"))
    except OSError as error:
        raise Bad(f"rtl/fp/{core}.v: {error.strerror}") from None
    if not found:
        raise Bad(f"rtl/fp/{core}.v: there is no 'parameter [N:0] CUTS'")
    return int(found[1]) + 1


def check_configs(data, regs, positions):
    file = "configs.toml"
    room = {row["name"]: row["words"] for row in regs["window"]}
    hi, lo = regs["address"]["word"]
    limits = dict(CONFIG_KEYS, program_words=(2, room["program"]), store_words=(0, 2 << hi - lo),
                  **{f"{unit}_cuts": (0, (1 << n) - 1) for unit, n in positions.items()})
    keys(data, file, "top level", {"default": dict, "config": list})
    keys(data["default"], file, "[default]", {}, {key: int for key in CONFIG_KEYS})
    rows = []
    for given in data["config"]:
        where = f"config '{given.get('name', '?')}'"
        keys(given, file, where, {"name": str, "doc": str}, {key: int for key in CONFIG_KEYS})
        row = {**data["default"], **given}
        for unit in ("add", "mul"):
            cuts = f"{unit}_cuts"
            need(cuts in row, file, f"{where}: '{cuts}' is missing, here and in [default]")
            least = row[cuts].bit_count() + 1
            row.setdefault(f"{unit}_latency", least)
            need(row[f"{unit}_latency"] >= least, file,
                 f"{where}: {unit}_latency {row[f'{unit}_latency']} is less than the {least} of its cuts")
        for key, (low, high) in limits.items():
            need(key in row, file, f"{where}: '{key}' is missing, here and in [default]")
            need(low <= row[key] <= high, file, f"{where}: {key} = {config_value(key, row[key])} is not in "
                 f"{config_value(key, low)} .. {config_value(key, high)}")
        for key in POWERS_OF_TWO if not row["interleave"] else (*POWERS_OF_TWO, "store_words"):
            need(row[key] & (row[key] - 1) == 0, file, f"{where}: {key} = {row[key]} is not a power of two")
        check_organisation(row, file, where, limits["store_words"][1])
        rows.append(row)
    named(rows, file, "config")
    return rows


def check_organisation(row, file, where, words):
    """What goes with what; rtl/config_rules.v checks the same."""
    need(row["chain"] or not row["select"], file, f"{where}: select needs chain: `sel` has three operands")
    if row["interleave"]:
        need(row["lanes"] == 1 or row["schedulers"] == 1, file,
             f"{where}: lanes share one scheduler, or schedulers share one arithmetic unit, not both")
        need(row["tiles"] * row["schedulers"] <= 64, file, f"{where}: at most 64 schedulers have an address")
        need(row["store_words"] >= max(16, row["registers"]), file,
             f"{where}: store_words = {row['store_words']} holds no object of {row['registers']} registers, or less than two")
        need(row["add_latency"] + row["mul_latency"] >= 3, file,
             f"{where}: add_latency + mul_latency must be at least 3 where contexts are interleaved")
        need(row["store_words"] >= 8 * row["contexts"], file,
             f"{where}: store_words = {row['store_words']} has no room for an object in each of {row['contexts']} contexts")
        need(row["store_words"] * row["lanes"] <= words, file,
             f"{where}: store_words * lanes = {row['store_words'] * row['lanes']} is more than the {words} that have an address")
        need(not row["bypass"] and not row["writeback_stall"], file,
             f"{where}: interleaved contexts have neither bypass nor writeback_stall")
        need(row["flags"] or not row["status"], file, f"{where}: status needs flags")
    else:
        for key in ("tiles", "schedulers", "lanes", "contexts"):
            need(row[key] == 1, file, f"{where}: {key} = {row[key]} needs interleave = 1")
        for key in ("store_words", "scale", "sleep", "status"):
            need(row[key] == 0, file, f"{where}: {key} = {row[key]} needs interleave = 1")


def config_value(key, value):
    return f"0x{value:04x}" if key.endswith("_cuts") else str(value)
