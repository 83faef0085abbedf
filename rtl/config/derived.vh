// SPDX-License-Identifier: Apache-2.0
// derived.vh: what follows from the keys of a configuration. Part of a parameter list, behind the
// keys: of config.vh, and of fp3, which has them as parameters of its own. Not to be set.
//
// Lanes with the same control in the same cycle, and the number of such groups.
parameter integer GROUP      = 4,
parameter integer GROUPS     = (LANES + GROUP - 1) / GROUP,
// Widths: of the number of a register, of a context (the constants are one more, or two), of a word
// of program, of a word of store, of a row of store (a record has at least 8 words), of a lane; of
// a register's number with its context's, and in a bank of sums or products.
parameter integer REGISTER_W = $clog2(REGISTERS),
parameter integer CONTEXT_W  = $clog2(CONTEXTS + 1 + DUAL),
parameter integer PROGRAM_W  = $clog2(PROGRAM_WORDS),
parameter integer STORE_W    = $clog2(STORE_WORDS),
parameter integer ROW_W      = STORE_W - 3,
parameter integer LANE_W     = LANES > 1 ? $clog2(LANES) : 1,
parameter integer REG_W      = CONTEXT_W + REGISTER_W,
parameter integer BANK_W     = REG_W - 1,
// Of the length of a list of neighbours.
parameter integer LENGTH_W   = 12,
// Of the bundle AROUND (lane/bundles.vh).
parameter integer AROUND_W   = NEIGHBOURS != 0 ? 6 + LENGTH_W + STORE_W : 1,
// Bits of a word below the fraction, which arithmetic reads as 0; the others; which bits of a
// number, from this one up, say whether it is 0.
parameter integer BELOW        = 23 - FRACTION,
parameter [31:0] KEPT         = 32'hffffffff << BELOW,
parameter integer NONZERO_FROM = FINITE != 0 ? 23 : BELOW,
// Of a word of the store; of the bundle DRAW, or with OVERLAP of PART.
parameter integer STORED_W   = STORAGE != 0 ? 16 : 32,
parameter integer DRAW_W     = STORAGE != 0 ? 78 : OVERLAP != 0 ? 2 : 1,
// One word of a record is kept whole: that of `sleep`.
parameter integer WHOLE      = STORAGE != 0 && SLEEP != 0 ? 1 : 0,
// Instructions of a scheduler that may issue, and results of a lane that may come, in one cycle.
parameter integer STREAMS    = DUAL + 1,
// What fp_value does: VALUES, CHOICE_W
`include "gen/config_values.vh"
// What the machine takes of cycles: TIMING_...
`include "gen/timing.vh"
// Plain registers behind a core: what its latency has more than its cuts.
parameter integer ADD_SPARE = ADD_LATENCY -
    ({31'd0, ADD_CUTS[0]} + {31'd0, ADD_CUTS[1]} + {31'd0, ADD_CUTS[2]} + {31'd0, ADD_CUTS[3]}
     + {31'd0, ADD_CUTS[4]} + {31'd0, ADD_CUTS[5]} + {31'd0, ADD_CUTS[6]}),
parameter integer MUL_SPARE = MUL_LATENCY -
    ({31'd0, MUL_CUTS[0]} + {31'd0, MUL_CUTS[1]} + {31'd0, MUL_CUTS[2]} + {31'd0, MUL_CUTS[3]}
     + {31'd0, MUL_CUTS[4]} + {31'd0, MUL_CUTS[5]} + {31'd0, MUL_CUTS[6]}),
// With FUSED, from x and y to their exact product. With INTERLEAVE, z comes then.
parameter integer PRODUCT_LATENCY = MUL_LATENCY - (INTERLEAVE == 0 ? TIMING_SOLO_FUSED : 0),
// With INTERLEAVE, from operands to result; and as if all operands were read as soon as a
// sum's scaled one.
parameter integer UNIT_LATENCY = DUAL != 0 ? (MUL_LATENCY > ADD_LATENCY ? MUL_LATENCY : ADD_LATENCY)
                               : MUL_LATENCY + ADD_LATENCY + (SCHEDULERS > 1 ? TIMING_SHARE : 0),
parameter integer LATENCY = UNIT_LATENCY + (DUAL != 0 ? TIMING_EARLY : 0),
// In cycles: TO_RESULT from ISSUE to the result, ENDED from RETIRE to the result, TO_END from ISSUE
// to RETIRE.
parameter integer TO_RESULT = TIMING_OPERANDS + LATENCY,
parameter integer WIDENED   = STORAGE != 0 ? TIMING_WIDEN : 0,
parameter integer ENDED     = DUAL != 0 ? TIMING_DUAL_END : TIMING_END + WIDENED,
parameter integer TO_END    = TO_RESULT - ENDED,
// With STORAGE, from the ISSUE of a store to its narrow word; no instruction ends before.
parameter integer ROUNDED   = 2 * TIMING_MIX + 1 + TIMING_NARROW,
// Cycles from REACH to ISSUE: the word of a neighbour is then there beside the operands.
parameter integer AHEAD     = NEIGHBOURS != 0 ? TIMING_REACH : 0,
// There, too: how much later z is read than x and y. It is wanted behind the multiplier: numbers of
// registers wait, once for all lanes, instead of values in each. Not where something is made of z
// and x, where schedulers share an adder that z may want at once, or where z is what is read for x.
parameter integer Z_LATE  = INTERLEAVE != 0 && (CHAIN != 0 || FUSED != 0) && VALUES == 0 && SCHEDULERS == 1 ? MUL_LATENCY : 0,
// And: from an issue to the next one of the same context, at least; and from the last issue
// of a round to its last report, through the lanes and back.
parameter integer GAP     = LATENCY + TIMING_GAP,
parameter integer SETTLE  = LATENCY + AHEAD + LANES + TIMING_SETTLE,
// From an access of the host port to the word.
parameter integer MEMORY_LATENCY = INTERLEAVE != 0 ? GROUPS + TIMING_ACCESS + (STORAGE != 0 ? TIMING_NARROW + WIDENED : 0) : TIMING_SOLO_ACCESS
