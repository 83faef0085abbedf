"""Small modules alone, each against a model of its header (cocotb in Icarus); and broken ones."""

import json
from pathlib import Path
from typing import NamedTuple

import pytest

import master_bugs
import simulate
from bugs import Bug, few, source, tree

ROOT = Path(__file__).resolve().parents[2]
DUAL = {"interleave": 1, "dual": 1, "scale": 1, "estimate": 1, "registers": 8}
FULL = {"interleave": 1, "chain": 1, "scale": 1, "select": 1, "estimate": 1, "round": 1, "sleep": 1, "registers": 32}
PLAIN = {"registers": 64}


class Part(NamedTuple):
    """A module with these parameters, and its bench."""
    module: str
    bench: str
    parameters: dict
    told: dict = {}                      # the environment of the bench


def decode(keys, words):
    known = dict.fromkeys(("interleave", "dual", "chain", "fused", "scale", "select", "estimate", "round", "sleep", "neighbours", "keep"), 0)
    return Part("decode", "decode", {key.upper(): value for key, value in {**known, **keys}.items()},
                {"FP3_KEYS": json.dumps(keys), "FP3_WORDS": words})


def tile(test, **keys):
    """A small one, seen by its host."""
    config = {"CONTEXTS": 2, "STORE_WORDS": 128, "REGISTERS": 8, "PROGRAM_WORDS": 16, "MULTIPLY_ADD": 0,
              "ADD_LATENCY": 2, "MUL_LATENCY": 2, **keys}
    return Part("tile", "tile", {"CONFIG": simulate.config_word(ROOT, config)}, {"TESTCASE": test, "FP3_RTL": ROOT / "rtl"})


def storage(module, form):
    return Part(module, module, {"STORAGE": form}, {"FP3_STORAGE": form})


def memory(module, latency, forward, enable, **parameters):
    return Part(module, "memory", parameters, {"FP3_LATENCY": latency, "FP3_FORWARD": forward, "FP3_ENABLE": enable})


PARTS = {
    "decode, dual": decode(DUAL, 6000),
    "decode, everything for one object in turn": decode(FULL, 4000),
    "decode, as little as can be": decode(PLAIN, 2000),
    "decode, multiply-add rounded once": decode({**FULL, "chain": 0, "scale": 0, "fused": 1}, 3000),
    "decode, multiply-add rounded once for one object": decode({**PLAIN, "fused": 1, "select": 1, "estimate": 1, "round": 1}, 2000),
    "decode, neighbours": decode({"registers": 32, "interleave": 1, "neighbours": 1}, 3000),
    "decode, lists that are made": decode({"registers": 32, "interleave": 1, "select": 1, "neighbours": 1, "keep": 1}, 3000),
    "tile, batches": tile("tile_steps_each_object_of_each_batch", LANES=2),
    "tile, batches of sums and products": tile("tile_steps_each_object_of_each_batch", LANES=2, MULTIPLY_ADD=3),
    "tile, sums and products at once": tile("tile_steps_each_object_of_each_batch", MULTIPLY_ADD=3, CONTEXTS=9, ADD_LATENCY=1, MUL_LATENCY=1, STORE_WORDS=256),
    "tile, stopped": tile("tile_is_stopped_between_visits"),
    "tile, sums and products stopped": tile("tile_is_stopped_between_visits", MULTIPLY_ADD=3),
    "tile, record": tile("tile_refuses_a_record_out_of_range"),
    "hub": Part("hub", "hub", {"N": 3}),
    "hub, waits": Part("hub", "hub", {"N": 2, "QUIET": 3, "STREAM": 0xc00000}),
    "master": Part("master", "master", {"ADDRESS_W": 20, "INSIDE": 18, "STREAM": 0x20000, "READS_W": 5}, {"FP3_MAP": ROOT / "isa/registers.toml"}),
    "counters": Part("counters", "counters", {"N": 18, "INDEX_W": 5}),
    "ram_1r1w": memory("ram_1r1w", 1, 0, 1, ADDR_W=4, W=9),
    "lutram_1r1w": memory("lutram_1r1w", 0, 0, 0, ADDR_W=4, W=9),
    "ram_registered": memory("ram_registered", 2, 0, 1, ADDR_W=4, W=9),
    "ram_forward, few words": memory("ram_forward", 1, 1, 0, ADDR_W=4, W=9),
    "ram_forward, many words": memory("ram_forward", 1, 1, 0, ADDR_W=8, W=9),
    "shift_right_sticky, by ones": Part("shift_right_sticky", "shift", {"W": 26, "N": 5, "UNIT": 1}),
    "shift_right_sticky, by eights": Part("shift_right_sticky", "shift", {"W": 26, "N": 2, "UNIT": 8}),
    "shift_right_sticky, beyond its width": Part("shift_right_sticky", "shift", {"W": 8, "N": 3, "UNIT": 4}),
    "fp_rint": Part("fp_rint", "rint", {"NEAREST": 1, "CUT": 0}),
    "fp_rint, cut": Part("fp_rint", "rint", {"NEAREST": 1, "CUT": 1}),
    "fp_rint, truncated": Part("fp_rint", "rint", {"NEAREST": 0, "CUT": 1}),
    "narrow, bfloat16": storage("narrow", 1),
    "narrow, binary16": storage("narrow", 2),
    "widen, bfloat16": storage("widen", 1),
    "widen, binary16": storage("widen", 2),
    "mix": Part("mix", "mix", {}),
    "uart_rx": Part("uart_rx", "uart_rx", {"DIVISOR": 8}),
    "slip_tx": Part("slip_tx", "slip_tx", {}),
}
SCALED = "!((halve || twice) && (a_odd || b_even))"
BUGS = {
    "decode, dual": [
        Bug("halves are not kept apart", "fp3_decode.v", SCALED, "!(twice && (a_odd || b_even))"),
        Bug("doubles are not kept apart", "fp3_decode.v", SCALED, "!(halve && (a_odd || b_even))"),
        Bug("a scaled sum", "fp3_decode.v", SCALED, "!((halve || twice) && a_odd)"),
        Bug("a scaled operand and a product", "fp3_decode.v", SCALED, "!((halve || twice) && b_even)"),
        Bug("an estimate of a product", "fp3_decode.v", "!(valued && a_odd)", "1'b1"),
        Bug("an estimate is a sum", "fp3_decode.v", "(valued && DUAL == 0)", "valued"),
    ],
    "decode, multiply-add rounded once": [
        Bug("a difference is a sum", "fp3_decode.v", "op == OP_MSUB || op == OP_FMSUB || op == OP_SUBH", "op == OP_MSUB || op == OP_SUBH"),
        Bug("fmsub is a sum", "fp3_decode.v", "(op == OP_FMADD || op == OP_FMSUB)", "op == OP_FMADD"),
    ],
    "tile, batches": [
        Bug("the third batch has the rows of the second", "fp3_issue.v", "opened_q ? {ROW_W{1'b0}} : base_q + BATCH", "opened_q ? {ROW_W{1'b0}} : BATCH"),
    ],
    "tile, batches of sums and products": [
        Bug("the third batch has the rows of the second", "fp3_sequencer.v", "next_row_q <= next_row_q + CONTEXTS[ROW_W-1:0]", "next_row_q <= CONTEXTS[ROW_W-1:0]"),
        Bug("every batch has the first rows", "fp3_sequencer.v", "row_q      <= next_row_q;", "row_q      <= {ROW_W{1'b0}};"),
        Bug("rows go on from round to round", "fp3_sequencer.v", "if (open) next_row_q <= {ROW_W{1'b0}};\n        else if", "if"),
        Bug("sums have one row for all", "fp3_dual_sweep.v", "row_q      <= base_now_q + context_wide[ROW_W-1:0]", "row_q      <= base_now_q"),
        Bug("a store's row is that of the next context", "fp3_two_streams.v", ".N(1+TIMING_EARLY)) u_st_row", ".N(TIMING_EARLY)) u_st_row"),
        Bug("a product's load has the row of a sum", "fp3_two_streams.v", "retire_product_loads ? retire_product_row : retire_sum_row", "retire_sum_row"),
        Bug("a product's load reads the register of a sum", "fp3_two_streams.v",
            "retire_product_loads ? retire_product_register : retire_sum_register", "retire_sum_register"),
        Bug("all loads are of sums", "fp3_two_streams.v", "to_mul || (to_memory && !st && d[0])", "to_mul"),
        Bug("a load of a sum writes nothing", "fp3_dual_end.v", "{retire_sum_adds || retire_sum_loads, retire_sum_adds}", "{2{retire_sum_adds}}"),
        Bug("a load of a product is a product", "fp3_dual_end.v", "retire_product_valid && !retire_product_loads}", "retire_product_valid}"),
        Bug("a load writes the host's word", "fp3_lane.v", "other_q    <= loads ? loaded : data_i", "other_q    <= data_i"),
        Bug("loads are known a cycle late", "fp3_dual_end.v", ".N(TIMING_DUAL_END-1)) u_load", ".N(TIMING_DUAL_END)) u_load"),
        Bug("an absent object is stored", "fp3_dual_end.v", "{1'b0, issue_st_row} >= count_q", "1'b0"),
    ],
    "tile, sums and products at once": [
        Bug("loads of sums and of products at once", "fp3_two_streams.v", ".muls_i(to_mul || to_memory || memory_q)", ".muls_i(to_mul)"),
        Bug("each sum's y is of its own time", "fp3_two_streams.v", "N(TIMING_EARLY)) u_issue (", "N(TIMING_EARLY - 1)) u_issue ("),
    ],
    "tile, stopped": [
        Bug("a stop between stores", "fp3_rounds.v", "stopping && !storing_i", "stopping"),
        Bug("the next instruction stores nothing", "fp3_sequencer.v", "(valid_q && in_last_q) || (busy && under_in_last_q)", "(busy && under_in_last_q)"),
        Bug("what is under way stores nothing", "fp3_sequencer.v", "(valid_q && in_last_q) || (busy && under_in_last_q)", "(valid_q && in_last_q)"),
    ],
    "tile, record": [
        Bug("11 is 3", "fp3_host_port.v", "(req_wdata_i >> W) == 32'd0 && ", ""),
        Bug("2 is in range", "fp3_host_port.v", "req_wdata_i[W-1:0] - LEAST[W-1:0] <= MOST[W-1:0] - LEAST[W-1:0]", "req_wdata_i[W-1:0] <= MOST[W-1:0]"),
        Bug("7 is in range", "fp3_host_port.v", "req_wdata_i[W-1:0] - LEAST[W-1:0] <= MOST[W-1:0] - LEAST[W-1:0]", "req_wdata_i[W-1:0] >= LEAST[W-1:0]"),
        Bug("refused, and written", "fp3_host_port.v", "else if (to_q && ok_q) value_q", "else if (to_q) value_q"),
        Bug("written, and refused", "fp3_host_port.v", "&& !(|(ranged_q & ~fits_q))", "&& !(|ranged_q)"),
    ],
    "hub": [
        Bug("a write is answered in reset", "fp3_hub.v", "{answer_wrote && !rst_i,", "{answer_wrote,"),
        Bug("a read is answered in reset", "fp3_hub.v", "answer_read && !rst_i,", "answer_read,"),
        Bug("schedulers are asked in reset", "fp3_hub.v", "req_valid_i && !rst_i &&", "req_valid_i &&"),
        Bug("a bit of a scheduler's number is not looked at", "fp3_hub.v", "who == NUMBER", "(who & 8'hdf) == NUMBER"),
        Bug("nobody is somebody", "fp3_hub.v", "nobody ? NOWHERE : req_addr_i[23:0]", "req_addr_i[23:0]"),
        Bug("nobody shows interrupts", "fp3_hub.v", "pending_q <= !nobody &&", "pending_q <="),
        Bug("schedulers from 32 on are shown twice", "fp3_hub.v", "addr_q[2] ? irqs[63:32] : irqs[31:0]", "irqs[31:0]"),
    ],
    "hub, waits": [
        Bug("a start soon after a list's last number", "fp3_hub.v", "takes = quiet || streams", "takes = 1'b1"),
        Bug("what streams waits, too", "fp3_hub.v", "takes = quiet || streams", "takes = quiet"),
        Bug("a cycle too soon", "fp3_hub.v", "left_q <= QUIET[W-1:0]", "left_q <= QUIET[W-1:0] - 1'b1"),
    ],
    "master": [Bug(name, file, right, wrong) for file, rows in master_bugs.BUGS.items() for name, right, wrong in rows],
    "counters": [
        Bug("an event of the clear's cycle counts", "fp3_counters.v", "event_q <= clear_i ? {N{1'b0}} : event_i", "event_q <= event_i"),
        Bug("an event of the cycle before the clear counts", "fp3_counters.v", "if (clear_i) count_q <= {W{1'b0}};", "if (clear_i) count_q <= {{W-1{1'b0}}, event_q[k]};"),
        Bug("the first four for all", "fp3_counters.v", "which_q <= index_i[INDEX_W-1:2];", "which_q <= {INDEX_W-2{1'b0}};"),
        Bug("the first sixteen for all", "fp3_counters.v", "which_q <= index_i[INDEX_W-1:2];", "which_q <= index_i[3:2];"),
        Bug("33 bits", "fp3_counters.v", "parameter W       = 48", "parameter W       = 33"),
        Bug("the high word is the low one", "fp3_counters.v", "64*index_i[1:0] + 32*high_i", "64*index_i[1:0]"),
    ],
    "ram_1r1w": [
        Bug("ones at power-up", "fp3_ram_1r1w.v", "memory[i] = {W{1'b0}};", "memory[i] = {W{1'b1}};"),
        Bug("one word is not zero at power-up", "fp3_ram_1r1w.v", "memory[i] = {W{1'b0}};", "memory[i] = i == 5;"),
        Bug("a read without read_i", "fp3_ram_1r1w.v", "if (read_i)  read_q", "read_q"),
    ],
    "lutram_1r1w": [Bug("not zero at power-up", "fp3_lutram_1r1w.v", "memory[i] = {W{1'b0}};", "memory[i] = i == 5;")],
    "ram_registered": [Bug("not zero at power-up", "fp3_ram_registered.v", "memory[i] = {W{1'b0}};", "memory[i] = i == 5;")],
    "ram_forward, few words": [
        Bug("what is not written is forwarded", "fp3_ram_forward.v", "write_i && write_addr_i == read_addr_i", "write_addr_i == read_addr_i"),
        Bug("half of an address is compared", "fp3_ram_forward.v", "write_i && write_addr_i == read_addr_i",
            "write_i && write_addr_i[ADDR_W-2:0] == read_addr_i[ADDR_W-2:0]"),
    ],
    "ram_forward, many words": [
        Bug("the word of this cycle", "fp3_ram_forward.v", "forward_q ? write_value_q : word", "forward_q ? write_value_i : word"),
        Bug("half of an address is compared", "fp3_ram_forward.v", "write_i && write_addr_i == read_addr_i",
            "write_i && write_addr_i[ADDR_W-2:0] == read_addr_i[ADDR_W-2:0]"),
    ],
    "shift_right_sticky, by eights": [
        Bug("the amount without its upper bits", "fp3_shift_right_sticky.v", "wire [A-1:0] n = {{A-N{1'b0}}, n_i} << $clog2(UNIT)",
            "wire [N-1:0] n = n_i << $clog2(UNIT)"),
        Bug("by ones", "fp3_shift_right_sticky.v", "d_i >> n;", "d_i >> n_i;"),
    ],
    "shift_right_sticky, beyond its width": [
        Bug("sticky without its upper bits", "fp3_shift_right_sticky.v", "({W{1'b1}} << n)", "({W{1'b1}} << n[A-2:0])"),
        Bug("the amount without its uppermost bit", "fp3_shift_right_sticky.v", "d_i >> n;", "d_i >> n[A-2:0];"),
    ],
    "fp_rint": [
        Bug("0.75 is a tie", "fp3_fp_rint.v", "(half_q ? behind_q : {1'b0, behind_q[22:1]})", "{1'b0, behind_q[22:1]}"),
        Bug("0.75 is rounded down", "fp3_fp_rint.v", "guard = half_q ||", "guard ="),
        Bug("ties away from zero", "fp3_fp_rint.v", "guard && (rest || odd)", "guard"),
        Bug("the sign of a zero is lost", "fp3_fp_rint.v", "assign z_o = {kept_c[31],", "assign z_o = {kept_c[31] && !small_c,"),
    ],
    "fp_rint, truncated": [Bug("rounds to nearest", "fp3_fp_rint.v", "NEAREST != 0 && guard", "guard")],
    "narrow, bfloat16": [
        Bug("a NaN is an infinity", "fp3_narrow.v", "narrow_q <= is_nan_q ? NAN :", "narrow_q <="),
        Bug("an infinity has overflown", "fp3_narrow.v", "over_q <= !is_out_q &&", "over_q <="),
        Bug("ties upwards", "fp3_narrow.v", "word_q[16] || more_q", "1'b1"),
        Bug("a draw is of 15 bits", "fp3_narrow.v", "draws_i ? random_i", "draws_i ? {1'b0, random_i[15:1]}"),
    ],
    "narrow, binary16": [
        Bug("65536 is a number", "fp3_narrow.v", "word_i[30:23] >= ABOVE", "word_i[30:23] > ABOVE"),
        Bug("the least numbers are 0", "fp3_narrow.v", "|distance[7:5] ? 5'd31 : distance[4:0]", "|distance[7:4] ? 5'd31 : distance[4:0]"),
        Bug("what is far below is not", "fp3_narrow.v", "|distance[7:5] ? 5'd31 : distance[4:0]", "distance[4:0]"),
        Bug("what lies beyond a tie does not count", "fp3_narrow.v", "assign more = is_small && beyond", "assign more = is_small && beyond && 1'b0"),
    ],
    "widen, binary16": [
        Bug("0 is 2^-25", "fp3_widen.v", "is_small && is_none ? 8'd0 :", ""),
        Bug("subnormal numbers are twice as large", "fp3_widen.v", "8'd112 - {4'd0, zeros}", "8'd113 - {4'd0, zeros}"),
        Bug("an infinity is a number", "fp3_widen.v", "is_out ? 8'd255 :", ""),
    ],
    "mix": [Bug("a sum is late", "fp3_mix.v", "third_q + (second_late_q << 11)", "third_q + (second << 11)")],
    "uart_rx": [
        Bug("a bad stop bit is a good one", "fp3_uart_rx.v", "if (sample) bad_q <= !line;", "if (sample && bit_q != STOP) bad_q <= !line;"),
        Bug("the stop bit is a bit of the byte", "fp3_uart_rx.v", "if (sample && bit_q != STOP) byte_q", "if (sample) byte_q"),
        Bug("no stop bit is awaited", "fp3_uart_rx.v", "STOP = 4'd10", "STOP = 4'd9"),
    ],
    "slip_tx": [
        Bug("an escape survives reset", "fp3_slip_tx.v", "if (rst_i)                   escape_q <= 1'b0;\n        else if", "if"),
        Bug("an escape that the line does not take", "fp3_slip_tx.v", "valid_i && ready_i) escape_q", "valid_i) escape_q"),
    ],
}

BUGS["tile, sums and products stopped"] = BUGS["tile, stopped"]


def run(root, folder, part, tree, whole=True):
    chosen = [f"-Pfp3_{part.module}.{key}={value}" for key, value in part.parameters.items()]
    vvp = simulate.compiled(tree, folder, f"fp3_{part.module}", source(tree, f"fp3_{part.module}.v"), *chosen, "-y", tree / "rtl/board")
    return simulate.cocotb(root, folder, vvp, root / f"tests/modules/{part.bench}_bench.py", whole, FP3_ISA=root / "isa/isa.toml", **part.told)


@pytest.mark.parametrize("name", PARTS)
def test_a_part_keeps_its_promises(root, tmp_path, name):
    done = run(root, tmp_path, PARTS[name], root)
    assert done.passed, done.said


@pytest.mark.parametrize("name, bug", few(((f"{name}: {bug.name}", name, bug) for name in BUGS for bug in BUGS[name]), lambda row: PARTS[row[0]].module))
def test_a_broken_part_is_seen(root, tmp_path, name, bug):
    done = run(root, tmp_path, PARTS[name], tree(root, tmp_path, bug), whole=False)
    assert done.failed and not done.passed, done.said
