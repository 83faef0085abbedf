#!/usr/bin/env python3
"""Turns isa/*.toml into Verilog and C headers, reference pages, rtl/gen/fp3.rdl and fp3.core,
programs/integrators/ into C headers, and sw/include/fp3/*.h into declarations for Python.

    tools/generate.py           writes what has changed
    tools/generate.py --check   writes nothing; fails and names each file that is stale

rtl/gen/ and sw/gen/ belong to this program: a file in them that it does not write is removed
(with --check: reported), and so is one in sw/include/fp3/ or docs/ that says it is generated.
Python's standard library (3.11) is all it needs.

fp3gen/ does the work: it reads and checks (isa, registers, configs, timing), then writes (verilog, host, parameters, decode, timing, c, rdl, pages,
fusesoc, python).
"""

import argparse
import pathlib
import sys

sys.dont_write_bytecode = True  # nothing but what it generates appears in the tree

from fp3gen import c, decode, families, fusesoc, host, pages, parameters, python, rdl, registers, timing, verilog
from fp3gen.check import Bad
from fp3gen.read import load, version
from fp3gen.text import MARK, licensed


def outputs(root):
    isa, regs, known, configs, cycles = load(root)
    families.families(root)  # of pictures: only checked
    files = {
        "rtl/gen/isa.vh": verilog.isa_verilog(isa),
        "rtl/gen/mnemonic.vh": verilog.mnemonic_verilog(isa),
        "rtl/gen/registers.vh": verilog.registers_verilog(regs),
        "rtl/gen/configs.vh": verilog.configs_verilog(configs),
        "rtl/gen/operands.vh": decode.operands_verilog(isa),
        "rtl/gen/choices.vh": decode.choices_verilog(isa),
        "rtl/gen/config_values.vh": decode.config_values_verilog(isa),
        "rtl/gen/choice_of.vh": decode.choice_of_verilog(isa),
        "rtl/gen/parameters.vh": parameters.parameters_verilog(known, regs),
        "rtl/gen/config_rules.vh": parameters.config_rules_verilog(known),
        "rtl/gen/timing.vh": timing.timing_verilog(cycles),
        "rtl/gen/host_map.vh": host.host_map_verilog(regs, isa["revision"]),
        "rtl/gen/settings.vh": host.settings_verilog(regs),
        "rtl/gen/events.vh": host.events_verilog(regs),
        "rtl/gen/fp3.rdl": rdl.rdl_file(isa, regs, known, configs, parameters.default_row(known)),
        "rtl/gen/files.f": fusesoc.file_list(root),
        "fp3.core": fusesoc.core_file(root, version(root), configs),
        "sw/include/fp3/isa.h": c.isa_c(isa, regs),
        "sw/gen/operations.h": c.operations_c(isa, registers.exceptions(regs)),
        "rtl/gen/estimates.vh": verilog.estimates_verilog(),
        "sw/gen/estimates.h": c.estimates_c(),
        "rtl/gen/lns_sums.vh": verilog.sums_verilog(),
        "rtl/gen/lns_curves.vh": verilog.curves_verilog(),
        "sw/gen/logarithms.h": c.logarithms_c(),
        "sw/gen/registers.h": c.registers_c(regs, isa["revision"]),
        "sw/gen/configs.h": c.configs_c(known, configs),
        "sw/gen/timing.h": timing.timing_c(cycles),
        "sw/gen/integrators.h": c.integrators_c(root),
        "docs/isa.md": pages.isa_page(isa, known),
        "docs/registers.md": pages.registers_page(regs),
        "docs/configurations.md": pages.configs_page(known, configs),
    }
    files["python/fp3/_declarations.py"] = python.declarations_python(root, files["sw/include/fp3/isa.h"])
    return {name: "\n".join(licensed(name, lines)) + "\n" for name, lines in files.items()}


def orphans(root, files):
    """What was generated once and is not any more: all of two directories, and what bears the mark in two others."""
    for pattern, is_ours in (("rtl/gen/*", True), ("sw/gen/*", True), ("sw/include/fp3/*.h", False), ("docs/*.md", False)):
        for path in sorted(root.glob(pattern)):
            marked = is_ours or MARK.partition("{")[0] in path.read_text(encoding="utf-8")[:200]
            if marked and path.relative_to(root).as_posix() not in files:
                yield path


def main():
    parser = argparse.ArgumentParser(description="isa/*.toml to Verilog, C and reference pages")
    parser.add_argument("--check", action="store_true", help="write nothing; fail if a file is stale")
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[1],
                        help="the project's directory")
    args = parser.parse_args()
    try:
        files = outputs(args.root)
    except Bad as bad:
        sys.exit(f"generate.py: {bad}")
    stale = []
    for name, text in files.items():
        path = args.root / name
        old = path.read_text(encoding="utf-8") if path.exists() else None
        if old == text:
            continue
        stale.append(f"{name}: {'stale' if old is not None else 'missing'}")
        if not args.check:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
            print(f"wrote {name}")
    for path in orphans(args.root, files):
        name = path.relative_to(args.root).as_posix()
        stale.append(f"{name}: not generated any more")
        if not args.check:
            path.unlink()
            print(f"removed {name}")
    if args.check and stale:
        sys.exit("\n".join(f"generate.py: {line}" for line in stale) + "\nRun tools/generate.py.")


if __name__ == "__main__":
    main()
