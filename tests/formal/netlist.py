"""Circuits for the proofs: yosys reads the cores, makes the IEEE 754 model, and maps both to ANDs."""

import json
import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import NamedTuple

from aig import Netlist

# An undefined bit becomes an $anyseq here: an input without a name.
MAP = "opt_expr; opt_clean; techmap; opt_expr; opt_clean; setundef -anyseq; aigmap; opt_clean"
STATE = ("dff", "ff", "latch", "mem", "sr", "assert", "assume", "check", "any", "initstate", "fsm")


class Format(NamedTuple):
    exp: int = 8
    frac: int = 23
    nearest: bool = True
    subnormal: bool = True
    finite: bool = False


def sources(rtl):
    """The hardware, file name -> text; what is included has its folder in the name."""
    modules = {path.name: path.read_text() for path in rtl.glob("**/*.v") if "fpga" not in path.parts}
    return modules | {path.relative_to(rtl).as_posix(): path.read_text() for path in rtl.glob("*/*.vh")}


class Yosys:
    def __init__(self, path):
        self.path = str(path)

    def run(self, script, files, result):
        """Run a script in a folder of these files; the text of the file that it leaves."""
        with tempfile.TemporaryDirectory(prefix="fp3-prove-") as folder:
            for name, text in files.items():
                (Path(folder) / name).parent.mkdir(exist_ok=True)
                (Path(folder) / name).write_text(text)
            run = subprocess.run([self.path, "-q", "-p", script], cwd=folder, capture_output=True, text=True)
            if run.returncode:
                raise RuntimeError(f"yosys failed: {(run.stderr or run.stdout).strip()[-800:]}")
            return (Path(folder) / result).read_text()

    def design(self, script, files):
        """The JSON design that a yosys script leaves."""
        return json.loads(self.run(f"{script}; write_json out.json", files, "out.json"))

    def map(self, design, top, flatten=False):
        """The and-inverter netlist of one module of a yosys JSON design."""
        flat = "setattr -mod -unset keep_hierarchy *; flatten; " if flatten else ""
        script = f"read_json in.json; hierarchy -top {top}; {flat}{MAP}; write_aiger -ascii -symbols out.aag"
        return Netlist(self.run(script, {"in.json": json.dumps(design)}, "out.aag"), top)


def module(yosys, files, name, **parameters):
    """One module of ours as JSON, flattened down to the multiplier's product, if it has one."""
    chosen = "".join(f" -chparam {key} {value}" for key, value in parameters.items())
    return yosys.design(f"read_verilog {name}.v; hierarchy -check -libdir . -top {name}{chosen}; "
                        f"rename -top {name}; setattr -mod -unset keep_hierarchy *; "
                        f"setattr -mod -set keep_hierarchy 1 *fp_mul_product*; "
                        f"proc; flatten -noscopeinfo; opt_clean", files)


def core(yosys, files, name, fmt, cuts):
    """A core as JSON; refuses any state but plain registers. FINITE is 0 where it is not said: fp_fma has no such parameter."""
    design = module(yosys, files, name, EXP=fmt.exp, FRAC=fmt.frac, SUBNORMAL=int(fmt.subnormal), NEAREST=int(fmt.nearest), CUTS=cuts,
                    **({"FINITE": 1} if fmt.finite else {}))
    check_plain(design)
    return design


@cache
def model(yosys, operation, fmt):
    """symfpu's netlist of one operation, less its own assertions; of mul, the multiplication taken out."""
    design = yosys.design(f"symfpu -eb {fmt.exp} -sb {fmt.frac + 1} -op {operation} "
                          f"-rm {'RNE' if fmt.nearest else 'RTZ'}; delete t:$assert; opt_clean", {})
    if operation in ("mul", "muladd"):
        take_out(design, "symfpu", "$mul")
    return defined(yosys.map(design, "symfpu"))


@cache
def facts(yosys, name, fmt, **parameters):
    """What add_cases, mul_facts or fma_cases, beside this file, says about operands."""
    files = {f"{name}.v": Path(__file__).with_name(f"{name}.v").read_text()}
    return defined(yosys.map(module(yosys, files, name, EXP=fmt.exp, FRAC=fmt.frac, **parameters), name))


def defined(netlist):
    if netlist.undefined:
        raise ValueError(f"{netlist.label} has undefined bits")
    return netlist


def take_out(design, top, cell_type):
    """Turn the one cell of this type inside out: product.A, .B become outputs, product.Y an input.

    The cell may be yosys's $mul or an instance of ours: two input words, one output word,
    and perhaps a clock. Returns the module that the instance names, or None.
    """
    module = design["modules"][top]
    names = [n for n, c in module["cells"].items() if cell_type in c["type"]]
    if len(names) != 1:
        raise ValueError(f"{top}: {len(names)} cells of type {cell_type}, expected one")
    cell = module["cells"].pop(names[0])
    inner = design["modules"].get(cell["type"])
    directions = ({n: p["direction"] for n, p in inner["ports"].items()} if inner
                  else cell["port_directions"])
    words = {n: b for n, b in cell["connections"].items() if len(b) > 1}
    sources = [n for n in directions if n in words and directions[n] == "input"]
    results = [n for n in directions if n in words and directions[n] == "output"]
    if len(sources) != 2 or len(results) != 1:
        raise ValueError(f"{top}: {cell_type} has not two operand words and one result word")
    for label, port, direction in zip("ABY", sources + results, ("output", "output", "input")):
        module["ports"][f"product.{label}"] = {"direction": direction, "bits": words[port]}
        module["netnames"][f"product.{label}"] = {"hide_name": 0, "bits": words[port],
                                                  "attributes": {}}
    if inner:
        design["modules"] = {top: module}
    return inner and (inner, sources, results[0])


def check_plain(design):
    """Refuse any state but registers on the one clock: no enable, no reset, no initial value."""
    for name, module in design["modules"].items():
        clock = module["ports"].get("clk_i", {"bits": []})["bits"]
        for net, wire in module["netnames"].items():
            if "init" in wire["attributes"]:
                raise ValueError(f"{name}: {net} has an initial value")
        for cell_name, cell in module["cells"].items():
            kind = cell["type"]
            if kind in design["modules"]:
                if cell["connections"].get("clk_i", clock) != clock:
                    raise ValueError(f"{name}: {cell_name} has another clock")
            elif kind == "$dff":
                if cell["connections"]["CLK"] != clock or int(cell["parameters"]["CLK_POLARITY"], 2) != 1:
                    raise ValueError(f"{name}: {cell_name} is not clocked by clk_i's rising edge")
            elif kind.startswith("$") and any(word in kind for word in STATE):
                raise ValueError(f"{name}: {cell_name} is a {kind}, not a plain register")
