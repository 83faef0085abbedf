// SPDX-License-Identifier: Apache-2.0
// bundles.vh: the bundles of a lane: of the lanes' control, inside a lane, and for the trace. Those
// of its arithmetic are in unit/socket.vh. front/decoded.vh shows how a bundle is used.
`include "unit/socket.vh"

// From the sequencer and the host, from lane to lane, and back ------------------------------------

// ACCESS: an access of the host.
//
//     valid, write
//     space                       lane_host.vh
//     lane                        which lane; not for constants, which all lanes have
//     address                     a word of the space
//     whole                       of a record: all 32 bits, with STORAGE
`define FP3_ACCESS_W (6 + LANE_W + STORE_W)
`define FP3_ACCESS_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire access_valid, access_write, access_whole; \
    wire [2:0] access_space; \
    wire [LANE_W-1:0] access_lane; \
    wire [STORE_W-1:0] access_address; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_ACCESS {access_valid, access_write, access_whole, access_space, access_lane, access_address}

// AROUND: how an instruction uses an object's neighbours, from the sequencer's loops to the lane's
// lists. One bit, 0, without NEIGHBOURS.
//
//     each                        a loop begins: the register has the place and the length of the object's list
//     entry                       the next neighbour of the list is found (each, next)
//     ldn, ldl                    a word of the neighbour's record, or a field of its entry, is loaded or an operand; or
//                                 (ldl) a field is stored
//     inside                      in a loop: not for objects whose list has ended
//     half                        of the store, where a published word is loaded or stored: 1: the upper one
//     turn                        of the loop, from 0
//     offset                      in the list, of an entry or a field; else the number of a word, of the neighbour's
//                                 record or the own
`define FP3_AROUND_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire around_each, around_entry, around_ldn, around_ldl, around_inside, around_half; \
    wire [LENGTH_W-1:0] around_turn; \
    wire [STORE_W-1:0] around_offset; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_AROUND {around_each, around_entry, around_ldn, around_ldl, around_inside, around_half, \
    around_turn, around_offset}

// REACH, AHEAD cycles before ISSUE: the word of the store that an instruction reads, in time for the
// operands. One bit, 0, without NEIGHBOURS: then RETIRE has this read, later.
//
//     valid, load                 an instruction; it reads a word
//     copy                        no instruction: the lane whose number is around's turn answers with a word of its
//                                 store (exchange)
//     context                     whose neighbour it is
//     row                         the store's row of the context's object
//     around                      AROUND
`define FP3_REACH_W (NEIGHBOURS != 0 ? 3 + CONTEXT_W + ROW_W + AROUND_W : 1)
`define FP3_REACH_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire reach_valid, reach_load, reach_copy; \
    wire [CONTEXT_W-1:0] reach_context; \
    wire [ROW_W-1:0] reach_row; \
    wire [AROUND_W-1:0] reach_around; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_REACH {reach_valid, reach_load, reach_copy, reach_context, reach_row, reach_around}

// ISSUE: the instruction that issues, for one context.
//
//     choice, subtract            of the arithmetic: gen/choices.vh; z - x * y
//     twice, halve, one, zero     x is 2, 1/2 or 1 instead of a register; z is -0
//     st, in_last                 a store; in the last part of a visit
//     each, first                 a loop over neighbours begins: x is where the list is; the first of these
//     keep, raise                 the neighbour's row goes to the list that x says (first: which it begins), if z is negative and y
//                                 leaves room; a flag is raised if x is negative
//     upper                       of a published word: it is stored in the upper half
//     whole                       of a store: all 32 bits, with STORAGE
//     given, minus                y is a word of the store (REACH) instead of a register; z has the other sign
//     record_shift                a record of the store has 8 << record_shift words
//     context, register           whose register is stored
//     x, y, z                     the operands: {context, register}; constants are one context more
//     row                         the store's row of the context's object, without SLEEP
//
// zero, minus and z are about the instruction of Z_LATE cycles ago.
`define FP3_ISSUE_W (CHOICE_W + 17 + 4*REG_W + ROW_W)
`define FP3_ISSUE_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire [CHOICE_W-1:0] issue_choice; \
    wire issue_subtract, issue_twice, issue_halve, issue_one, issue_zero, issue_st, issue_in_last; \
    wire issue_each, issue_first, issue_keep, issue_raise, issue_upper, issue_whole, issue_given, issue_minus; \
    wire [1:0] issue_record_shift; \
    wire [CONTEXT_W-1:0] issue_context; \
    wire [REGISTER_W-1:0] issue_register; \
    wire [REG_W-1:0] issue_x, issue_y, issue_z; \
    wire [ROW_W-1:0] issue_row; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_ISSUE {issue_choice, issue_subtract, issue_twice, issue_halve, issue_one, issue_zero, issue_st, \
    issue_in_last, issue_each, issue_first, issue_keep, issue_raise, issue_upper, issue_whole, issue_given, issue_minus, \
    issue_record_shift, issue_context, issue_register, issue_x, issue_y, issue_z, issue_row}

// RETIRE, TO_END cycles after ISSUE: the end of an instruction.
//
//     round                       a round begins; says nothing of the other fields
//     valid                       an instruction ends; without it only context and register are set
//     begins, ends, in_last       the first, the last of a visit; in its last part
//     lds, sleep, load, arithmetic   what it does; a store does none of these
//     whole                       it loads all 32 bits of its word, with STORAGE
//     batch                       two batches in a row differ in it
//     context, register           whose register is written
//     row                         the store's row of the context's object, without SLEEP
`define FP3_RETIRE_W (11 + REG_W + ROW_W)
`define FP3_RETIRE_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire retire_round, retire_valid, retire_begins, retire_ends, retire_in_last; \
    wire retire_lds, retire_sleep, retire_load, retire_arithmetic, retire_whole, retire_batch; \
    wire [CONTEXT_W-1:0] retire_context; \
    wire [REGISTER_W-1:0] retire_register; \
    wire [ROW_W-1:0] retire_row; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_RETIRE {retire_round, retire_valid, retire_begins, retire_ends, retire_in_last, \
    retire_lds, retire_sleep, retire_load, retire_arithmetic, retire_whole, retire_batch, \
    retire_context, retire_register, retire_row}

// DRAW, TIMING_MIX + 1 cycles after ISSUE: how a stored word is rounded. One bit, 0, where the store
// has words of 32 bits.
//
//     draws                       at random; else to nearest
//     number                      the draw of the object in lane 0 is mixed from this number, the next lane's from one
//                                 more. With SLEEP each lane adds its object's number:
//     first, stride               first + l + r * stride in row r of lane l
`define FP3_DRAW_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire draw_draws; \
    wire [31:0] draw_number, draw_first; \
    wire [12:0] draw_stride; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_DRAW {draw_draws, draw_number, draw_first, draw_stride}

// REPORT, from lane to lane and back to the sequencer: each lane adds its own.
//
//     count                       the most objects that a lane will visit
//     longest                     list of neighbours of the contexts of a loop that begins
//     flags                       exceptions raised in this cycle
//     raised, no_room             an object has raised; a list has no room
//     answer                      to the host
//     valid                       asleep is news: of this context, in this batch
//     asleep                      no lane has this context awake
`define FP3_REPORT_W (43 + ROW_W + CONTEXT_W + LENGTH_W)
`define FP3_REPORT_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire [ROW_W:0] report_count; \
    wire [LENGTH_W-1:0] report_longest; \
    wire [4:0] report_flags; \
    wire report_raised, report_no_room; \
    wire [31:0] report_answer; \
    wire report_valid, report_asleep, report_batch; \
    wire [CONTEXT_W-1:0] report_context; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_REPORT_OF(count, longest, flags, raised, no_room, answer, valid, asleep, batch, number) \
    {count, longest, flags, raised, no_room, answer, valid, asleep, batch, number}
`define FP3_REPORT `FP3_REPORT_OF(report_count, report_longest, report_flags, report_raised, report_no_room, \
    report_answer, report_valid, report_asleep, report_batch, report_context)
// In front of the first lane: no object, no flag, none awake.
`define FP3_REPORT_NONE `FP3_REPORT_OF({ROW_W+1{1'b0}}, {LENGTH_W{1'b0}}, 5'd0, 1'b0, 1'b0, 32'd0, \
    1'b0, 1'b1, 1'b0, {CONTEXT_W{1'b0}})

// DUAL_ISSUE, where a sum and a product may issue at once: the operands of both, each for a context
// of its own.
//
//     minus_x, minus_y            of the sum: +/- x +/- y
//     twice, halve                what y is multiplied with
//     st, st_y                    not a sum: x is stored, or y
//     choice                      what fp_value makes of product_x in the product's place
//     record_shift, register      as in ISSUE
//     st_row                      the row that is stored; of the store of two cycles ago
//     sum_x, sum_y                {context, half the register's number}: x from the bank of sums, y from
//     product_x, product_y        that of products. Constants are in both, under the highest contexts.
//                                 sum_y is that of the sum that comes two cycles later
`define FP3_DUAL_ISSUE_W (8 + CHOICE_W + REGISTER_W + ROW_W + 4*BANK_W)
`define FP3_DUAL_ISSUE_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire issue_minus_x, issue_minus_y, issue_twice, issue_halve, issue_st, issue_st_y; \
    wire [CHOICE_W-1:0] issue_choice; \
    wire [1:0] issue_record_shift; \
    wire [REGISTER_W-1:0] issue_register; \
    wire [ROW_W-1:0] issue_st_row; \
    wire [BANK_W-1:0] issue_sum_x, issue_sum_y, issue_product_x, issue_product_y; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_DUAL_ISSUE {issue_minus_x, issue_minus_y, issue_twice, issue_halve, issue_st, issue_st_y, issue_choice, \
    issue_record_shift, issue_register, issue_st_row, issue_sum_x, issue_sum_y, issue_product_x, issue_product_y}

// DUAL_RETIRE, TO_END cycles after DUAL_ISSUE: the ends of two instructions.
//
//     sum_valid, product_valid    an instruction ends; without it nothing else of its stream is set
//     sum_adds, sum_loads         it writes a sum, or a word of the store; a store does neither
//     product_loads               it writes a word of the store, and no product
//     .._row, .._context          whose; register: which one is written
//     load_row, load_register     what is read of the store, if one of them loads
`define FP3_DUAL_RETIRE_W (5 + 3*ROW_W + 2*REG_W + REGISTER_W)
`define FP3_DUAL_RETIRE_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire retire_sum_valid, retire_sum_adds, retire_sum_loads, retire_product_valid, retire_product_loads; \
    wire [ROW_W-1:0] retire_sum_row, retire_product_row, retire_load_row; \
    wire [CONTEXT_W-1:0] retire_sum_context, retire_product_context; \
    wire [REGISTER_W-1:0] retire_sum_register, retire_product_register, retire_load_register; \
    /* verilator lint_on UNUSEDSIGNAL */
`define FP3_DUAL_RETIRE {retire_sum_valid, retire_sum_adds, retire_sum_loads, \
    retire_product_valid, retire_product_loads, retire_sum_row, retire_product_row, retire_load_row, \
    retire_sum_context, retire_product_context, \
    retire_sum_register, retire_product_register, retire_load_register}

// Of the two, in this configuration
`define FP3_LANE_ISSUE_W (DUAL != 0 ? `FP3_DUAL_ISSUE_W : `FP3_ISSUE_W)
`define FP3_LANE_RETIRE_W (DUAL != 0 ? `FP3_DUAL_RETIRE_W : `FP3_RETIRE_W)

// Inside a lane ----------------------------------------------------------------------------------

// MOVE: the words that a lane loads from its store and stores there. lane_store says in which cycle
// each is.
//
//     record_shift                a record has 8 << record_shift words
//     st, in_last, register       a store: in the last part of a visit; of which register
//     st_row, st_absent, st_asleep   of which object, two cycles later: there is none, it sleeps
//     load                        a word is loaded
//     load_row, load_register     which one; or, without load, the row that is looked at
//     st_upper, load_upper        in the upper half of the store
//     st_whole, load_whole        with STORAGE: all 32 bits
//     load_place, place           not a word of a record, but this one
//     st_list, st_place, st_ended   likewise of a store, two cycles later; there is no such entry
`define FP3_MOVE_W (14 + 2*STORE_W + 2*REGISTER_W + 2*ROW_W)
`define FP3_MOVE_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire [1:0] move_record_shift; \
    wire move_st, move_in_last, move_st_absent, move_st_asleep, move_load; \
    wire move_st_upper, move_load_upper, move_load_place, move_st_whole, move_load_whole; \
    wire [REGISTER_W-1:0] move_register, move_load_register; \
    wire [ROW_W-1:0] move_st_row, move_load_row; \
    wire move_st_list, move_st_ended; \
    wire [STORE_W-1:0] move_place, move_st_place; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_MOVE {move_record_shift, move_st, move_in_last, move_st_absent, move_st_asleep, move_load, \
    move_register, move_load_register, move_st_upper, move_load_upper, move_load_place, \
    move_st_whole, move_load_whole, move_st_row, move_load_row, move_place, \
    move_st_list, move_st_ended, move_st_place}

// END: the end of an instruction in a lane, in the cycle W of its result.
//
//     valid, absent, executed     one ends; there is no object for it; it is executed: only if valid and not absent
//     writes                      a register is written
//     arithmetic                  its value is the arithmetic's, else a loaded word or the number of the step
//     register                    {context, register}
//     row                         the object's, a cycle later: for the trace
`define FP3_END_W (5 + REG_W + ROW_W)
`define FP3_END_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire end_valid, end_absent, end_executed, end_writes, end_arithmetic; \
    wire [REG_W-1:0] end_register; \
    wire [ROW_W-1:0] end_row; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_END {end_valid, end_absent, end_executed, end_writes, end_arithmetic, end_register, end_row}

// For the trace ----------------------------------------------------------------------------------

// WRITTEN: an instruction's end in a lane; left open, it costs nothing. Its widths are those of fp3's
// ports.
//
//     end                         0: none; 1: the context has no object; 2: it sleeps; 3: executed
//     valid                       a register is written
//     context, object, register   of which context, of the object in which row of the store, which one
//     value, flags
`define FP3_WRITTEN_W 94
`define FP3_WRITTEN_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire [1:0] written_end; \
    wire written_valid; \
    wire [15:0] written_context; \
    wire [31:0] written_object; \
    wire [5:0] written_register; \
    wire [31:0] written_value; \
    wire [4:0] written_flags; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_WRITTEN {written_end, written_valid, written_context, written_object, written_register, written_value, \
    written_flags}
