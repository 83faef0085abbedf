"""Bugs put into the cores on purpose: proofs that do not find them would prove nothing."""

from typing import NamedTuple

from aig import Unbalanced
from equal import Add, Different, Fma, Mul, cut
from product import Lemma


class Bug(NamedTuple):
    core: str
    name: str
    file: str
    right: str                           # must be in the file once
    wrong: str
    mask: int | None = None              # for a bug in a pipeline

    def patch(self, files):
        text = files[self.file]
        if text.count(self.right) != 1:
            raise RuntimeError(f"{self.file} has this {text.count(self.right)} times, expected once: "
                               f"{self.right!r}; see BUGS in tests/formal/mutants.py")
        return {**files, self.file: text.replace(self.right, self.wrong)}


BUGS = [
    Bug("add", "sticky dropped", "fp3_fp_add.v", "(lost2 || more2 ||", "(more2 ||"),
    Bug("add", "ties away from zero", "fp3_fp_add_round.v", "s[2] && (s[3] ||", "s[2] && (1'b1 ||"),
    Bug("add", "overflow at rounding missed", "fp3_fp_add_round.v", "over1 || rounded_over, tiny1", "over1, tiny1"),
    Bug("add", "sign of an exact zero", "fp3_fp_add_swap.v", "&& !(nought && (FINITE != 0 || differ0))", ""),
    Bug("add", "inf - inf is valid", "fp3_fp_add_swap.v", "|| (clash && !a_some0 && !b_some0)", ""),
    Bug("add", "distance to a subnormal", "fp3_fp_add_swap.v", "odd = a_zero0 ^ b_zero0", "odd = 1'b0"),
    Bug("mul", "sticky dropped", "fp3_fp_mul.v", "stick = lost_4 ||", "stick ="),
    Bug("mul", "ties away from zero", "fp3_fp_mul.v", "lo[1] && !lo_tie", "lo[1]"),
    Bug("mul", "tininess before rounding", "fp3_fp_mul.v", "near ? {1'b1, top || place_low} : ALL_1", "ALL_1"),
    Bug("mul", "overflow at rounding missed", "fp3_fp_mul.v", "beyond[i] ? ALL_1 : brink[i] ? rounded : ALL_0", "beyond[i] ? ALL_1 : ALL_0"),
    Bug("mul", "0 * inf is valid", "fp3_fp_mul.v", "|| (a_top_0 && b_zero && a_empty_0)", ""),
    Bug("mul", "a tile forgotten", "fp3_fp_mul_product.v", "{1'b0, lh_c} + {1'b0, hl_c}", "{1'b0, lh_c}"),
    Bug("mul", "a carry between tiles lost", "fp3_fp_mul_product.v", "{1'b0, lh_c} + {1'b0, hl_c}", "{1'b0, lh_c + hl_c}"),
    Bug("fma", "fused, bits of z lost unseen", "fp3_fp_fma.v", "more_9 || lost_9", "more_9"),
    Bug("fma", "fused, a product of zero moves z", "fp3_fp_fma.v", "px_zero || distance", "distance"),
    Bug("fma", "fused, the exponent of a subnormal factor", "fp3_fp_fma_product.v", "ey_0[0] || y_low", "ey_0[0]"),
    Bug("fma", "fused, a window one bit short", "fp3_fp_fma.v", "{1'b0, z_5[W-2:2], 1'b1}", "{1'b0, 1'b0, z_5[W-3:2], 1'b1}"),
    Bug("fma", "fused, shifted beyond the exponent", "fp3_fp_fma_normalize.v", "(!known_tight || limit != 2'd0)", "1'b1"),
    Bug("fma", "fused, ties of a negative sum", "fp3_fp_fma_round.v", "(tie && t[0])", "tie"),
    Bug("fma", "fused, tininess before rounding", "fp3_fp_fma_round.v", "negative_i ? !g && !(r && more_i) : g && r", "1'b0"),
    Bug("fma", "fused, inf - inf is valid", "fp3_fp_fma.v", "|| (z_nan && !fz[FRAC-1]) || clash;", "|| (z_nan && !fz[FRAC-1]);"),
    Bug("fma", "fused, a register left out on one path", "fp3_fp_fma.v", ".ON(CUTS[8])", ".ON(0)", 0x7ff),
    Bug("mul", "a tie forgotten where one adder rounds", "fp3_fp_mul.v", "lower ? lo_tie : ", "", 0x20),
    Bug("add", "a register left out on one path", "fp3_fp_add_round.v", "over = last1 &&", "over = last0 &&", 0x40),
    Bug("add", "a register with an enable", "fp3_cut.v", "d_q <= d_i;", "if (d_i[0]) d_q <= d_i;", 0x40),
    Bug("mul", "a register that inverts a bit", "fp3_cut.v", "d_q <= d_i;", "d_q <= d_i ^ 1'b1;", 0x20),
]


def find(yosys, files, fmt, bug):
    """The counterexample; raises if the proof goes through in spite of the bug."""
    files = bug.patch(files)
    try:
        if bug.mask is not None:
            cut(yosys, files, fmt, bug.core, bug.mask)
        elif bug.core == "add":
            Add(yosys, files, fmt).equal()
        elif bug.core == "fma":
            Fma(yosys, files, fmt).equal()
        elif bug.file == "fp3_fp_mul_product.v":
            Mul(yosys, files, fmt).tiles()
        else:
            Mul(yosys, files, fmt).equal()
    except (Different, Lemma, Unbalanced) as found:
        return f"found: {found}"
    raise RuntimeError("the bug was not found")
