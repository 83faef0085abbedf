// SPDX-License-Identifier: Apache-2.0
// fp3_lns_root: z = sqrt(a) or 1 / sqrt(a) of a logarithmic word, to the nearest word, ties to
// even.
//
// Purpose   Half of a logarithm.
// Latency   0. A function: no clock.
// Result    Numbers below 0 give the NaN 7FC00000 and NV; sqrt(-0) is -0, 1 / sqrt of either zero is
//           infinity and DZ.
//
//     inverse_i 1, a_i 40800000  ->  z_o 3F000000, flags_o 0      (1 / sqrt(4))
`default_nettype none
module fp3_lns_root (
    input  wire        inverse_i,
    input  wire [31:0] a_i,
    output wire [31:0] z_o,
    output wire [4:0]  flags_o         // {NV, DZ, OF, UF, NX}
);
`include "gen/isa.vh"
    wire top = &a_i[30:23], rest = |a_i[22:0];
    wire nan = top && rest, zero = ~|a_i[30:0];
    wire invalid = a_i[31] && !nan && !zero;
    wire is_number = !a_i[31] && !top && !zero;

    // Half of a + 127 or of 381 - a: half of a or of its complement, half of the constant, and a
    // carry, which rounds a tie.
    wire        tie   = a_i[0] && a_i[1];
    wire [30:0] moved = {1'b0, a_i[30:1]} ^ {31{inverse_i}};
    wire [30:0] half;
    wire        unused_carry;
    assign {half, unused_carry} = {moved, 1'b1} + {inverse_i ? 9'd381 : 9'd127, 22'd0, inverse_i ^ tie};
    wire        infinite = inverse_i ? zero : top && !rest;
    assign z_o = nan || invalid ? BITS_NAN
               : {zero && a_i[31] && !inverse_i, infinite ? {8'd255, 23'd0} : half & {31{is_number}}};
    assign flags_o = {invalid, inverse_i && zero, 2'b00, is_number && a_i[0]};
endmodule
`default_nettype wire
