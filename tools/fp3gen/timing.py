"""isa/timing.toml: its checks, and the constants that it gives the RTL and the software."""

from .c import c_header, defines
from .check import keys, need
from .text import MARK, columns

FILE = "timing.toml"
NAMES = ("share", "early", "reach", "grant", "operands", "told", "end", "dual_end", "write", "gap", "access", "mix", "narrow", "widen", "list", "copy", "settle", "round", "decoded", "run",
         "reset", "bus", "solo_access", "solo_operands", "solo_read", "solo_fused", "solo_around")
MOST = 255


def check_timing(timing):
    keys(timing, FILE, "top level", {name: dict for name in NAMES})
    for name, row in timing.items():
        keys(row, FILE, f"[{name}]", {"cycles": int, "rtl": bool, "meaning": str})
        need(0 <= row["cycles"] <= MOST, FILE, f"[{name}]: cycles = {row['cycles']} is not in 0 .. {MOST}")


def timing_verilog(timing):
    """Part of config.vh's list of parameters."""
    rows = [(f"parameter integer TIMING_{name.upper()} ", f"= {row['cycles']}, ", f"// {row['meaning']}")
            for name, row in timing.items() if row["rtl"]]
    return [f"// {MARK.format(source='isa/timing.toml')}", "// Included by rtl/config/derived.vh. In cycles.", *columns(rows)]


def timing_c(timing):
    lines = columns([(f"{define} ", f"/* {row['meaning']} */") for define, row in zip(
        defines([(f"FP3_TIMING_{name.upper()}", f"{row['cycles']}u") for name, row in timing.items()]), timing.values())])
    return c_header("timing", "isa/timing.toml", ["/* In cycles. */", *lines])
