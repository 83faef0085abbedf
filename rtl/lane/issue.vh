// SPDX-License-Identifier: Apache-2.0
// issue.vh: the bundle ISSUE, which goes from lane to lane: the instruction that issues, for one
// context.
// front/decoded.vh shows how a bundle is used.
//
//     choice, subtract            of the arithmetic: gen/choices.vh; z - x * y
//     twice, halve, one, zero     x is 2, 1/2 or 1 instead of a register; z is -0
//     st, in_last                 a store; in the last part of a visit
//     each, first                 a loop over neighbours begins: x is where the list is; the first of these
//     upper                       of a published word: it is stored in the upper half
//     whole                       of a store: all 32 bits, with STORAGE
//     given, minus                y is a word of the store (REACH) instead of a register; z has the other sign
//     record_shift                a record of the store has 8 << record_shift words
//     context, register           whose register is stored
//     x, y, z                     the operands: {context, register}; constants are one context more
//     row                         the store's row of the context's object, without SLEEP
//
// zero, minus and z are about the instruction of Z_LATE cycles ago.
`define FP3_ISSUE_W (CHOICE_W + 15 + 4*REG_W + ROW_W)
`define FP3_ISSUE_FIELDS \
    wire [CHOICE_W-1:0] issue_choice; \
    wire issue_subtract, issue_twice, issue_halve, issue_one, issue_zero, issue_st, issue_in_last, issue_each, issue_first, issue_upper, issue_whole, issue_given, issue_minus; \
    wire [1:0] issue_record_shift; \
    wire [CONTEXT_W-1:0] issue_context; \
    wire [REGISTER_W-1:0] issue_register; \
    wire [REG_W-1:0] issue_x, issue_y, issue_z; \
    wire [ROW_W-1:0] issue_row;
`define FP3_ISSUE {issue_choice, issue_subtract, issue_twice, issue_halve, issue_one, issue_zero, issue_st, issue_in_last, issue_each, issue_first, issue_upper, issue_whole, issue_given, issue_minus, \
    issue_record_shift, issue_context, issue_register, issue_x, issue_y, issue_z, issue_row}
