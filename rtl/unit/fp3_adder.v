// SPDX-License-Identifier: Apache-2.0
// fp3_adder: fp_add with the cuts of a configuration, and the registers behind it.
//
// Purpose   a + b or a - b, rounded.
// Latency   ADD_LATENCY + WAIT; new operands every cycle.
//
//     adder #(.CONFIG(CONFIG)) u_add (.clk_i(clk_i), .subtract_i(1'b1), .a_i(a), .b_i(b),
//     .value_o(sum), .flags_o(flags)); // a 40400000, b 3F800000  ->  sum 40000000, ADD_LATENCY
//     edges later
`default_nettype none
module fp3_adder #(
    parameter WAIT = 0,                // more registers
`include "config/config.vh"
) (
    input  wire        clk_i,
    input  wire        subtract_i,
    input  wire [31:0] a_i,
    input  wire [31:0] b_i,
    output wire [31:0] value_o,
    output wire [4:0]  flags_o         // {NV, DZ, OF, UF, NX}
);
    wire [31:BELOW] sum, late;
    wire [4:0]      flags;
    wire            unused = &{a_i, b_i};              // bits below the fraction
    fp3_fp_add #(.FRAC(FRACTION), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .FINITE(FINITE), .CUTS(ADD_CUTS)) u_add (
        .clk_i(clk_i),
        .sub_i(subtract_i), .a_i(a_i[31:BELOW]), .b_i(b_i[31:BELOW]), .z_o(sum), .flags_o(flags));
    fp3_delay #(.W(37 - BELOW), .N(ADD_SPARE + WAIT)) u_late (.clk_i(clk_i), .rst_i(1'b0), .d_i({flags, sum}),
        .q_o({flags_o, late}));
    assign value_o = {late, {BELOW{1'b0}}};
endmodule
`default_nettype wire
