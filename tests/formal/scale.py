"""fp_scale gives the bits and flags of fp_mul with 2 and 1/2, or the number itself, for every number: by SAT."""

from pathlib import Path

from mutants import Bug

MODES = [(1, 1, 0), (1, 0, 0), (0, 1, 0), (0, 0, 0), (0, 0, 1)]  # subnormal, nearest, finite
CASES = Path(__file__).with_name("scale_cases.v")

BUGS = [
    Bug("scale", "a tie goes up", "fp3_fp_scale.v", "&d_i[1:0]", "d_i[0]"),
    Bug("scale", "an exact half underflows", "fp3_fp_scale.v", "kind_1 == MOVED && f[0]", "kind_1 == MOVED"),
    Bug("scale", "halved unless doubled", "fp3_fp_scale.v", "down    = halve_i &&", "down    = !twice_i &&"),
    Bug("scale", "infinity is halved", "fp3_fp_scale.v", "top     = FINITE == 0 && &e;", "top     = &e && |d_i[FRAC-1:0];"),
    Bug("scale", "a NaN is counted up", "fp3_fp_scale.v", "ones ? {EXP{1'b1}} : low_1", "low_1"),
    Bug("scale", "a fraction's top bit lost", "fp3_fp_scale.v", "{y, x} + {{EXP{1'b0}}, more}", "{y, x + more}"),
    Bug("scale", "a rounded half loses its top bit", "fp3_fp_scale.v", "{{EXP-1{1'b0}}, tiny}", "{{EXP{1'b0}}, tiny[FRAC-1:0]}"),
    Bug("scale", "a NaN is counted up, too", "fp3_fp_scale.v", "next = top ? e : twice_i", "next = twice_i"),
    Bug("scale", "the least normal number keeps its exponent", "fp3_fp_scale.v", "(low || e == ONE)", "low"),
    Bug("scale", "overflow is not inexact", "fp3_fp_scale.v", "is_over, uf, is_over || uf", "is_over, uf, uf"),
]


def prove(yosys, files, mode):
    subnormal, nearest, finite = mode
    names = " ".join(sorted(name for name in files if name.startswith(("fp3_fp_mul", "fp3_fp_scale", "fp3_cut.v", "fp3_lzc.v", "fp3_mux4.v"))))
    # A proof that fails makes yosys fail.
    yosys.run(f"read_verilog {names} scale_cases.v; "
              f"chparam -set SUBNORMAL {subnormal} -set NEAREST {nearest} -set FINITE {finite} scale_cases; "
              "hierarchy -top scale_cases; setattr -mod -unset keep_hierarchy *; prep -flatten; opt -full; "
              "sat -verify -prove wrong_o 0 scale_cases; write_json done.json",
              {**files, "scale_cases.v": CASES.read_text()}, "done.json")
    return "proved"


def sum_last(files):
    """With SUM_LAST, as a lane of `dual` has it."""
    before, mark, behind = files["fp3_fp_scale.v"].partition("parameter SUM_LAST   = 0")
    if not mark:
        raise RuntimeError("fp3_fp_scale.v does not begin without SUM_LAST")
    return {**files, "fp3_fp_scale.v": before + "parameter SUM_LAST   = 1" + behind}


def find(yosys, files, bug):
    try:
        prove(yosys, bug.patch(files), MODES[0])
    except RuntimeError as failed:
        if "proof did fail" not in str(failed):
            raise
        return "found: the proof fails"
    raise RuntimeError("the bug was not found")


def cases():
    """(name, action of yosys and files) for every proof and every seeded bug."""
    for mode in MODES:
        name = f"scale{'' if mode[0] else ', flushed'}{'' if mode[1] else ', truncated'}{', finite' if mode[2] else ''}"
        yield name, lambda yosys, files, mode=mode: prove(yosys, files, mode)
    for bug in BUGS:
        yield f"seeded: {bug.name}", lambda yosys, files, bug=bug: find(yosys, files, bug)
