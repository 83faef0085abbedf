// SPDX-License-Identifier: Apache-2.0
// socket.vh: the bundles OPERANDS and RESULT: the socket of an arithmetic. front/decoded.vh shows
// how a bundle is used.
//
//     OPERANDS    choice                  what fp_value makes of z, y and whether x is 0: gen/choices.vh
//                 subtract                z - x * y
//                 twice, halve            y * 2, y * 1/2, where x does not say so
//                 z, x, y                 the lowest bits are x and y
//     RESULT      flags, value            UNIT_LATENCY cycles later: {NV, DZ, OF, UF, NX}
//
// Operands are sampled every cycle; idle cycles carry garbage. There is no valid bit: the issuer
// knows when the result comes.
`define FP3_OPERANDS_W (CHOICE_W + 3 + 96)
`define FP3_OPERANDS_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire [CHOICE_W-1:0] operands_choice; \
    wire operands_subtract, operands_twice, operands_halve; \
    wire [31:0] operands_z, operands_x, operands_y; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_OPERANDS {operands_choice, operands_subtract, operands_twice, operands_halve, \
    operands_z, operands_x, operands_y}
`define FP3_RESULT_W 37
`define FP3_RESULT_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire [4:0] result_flags; \
    wire [31:0] result_value; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_RESULT {result_flags, result_value}
