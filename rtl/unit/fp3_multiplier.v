// SPDX-License-Identifier: Apache-2.0
// fp3_multiplier: fp_mul with the cuts of a configuration, and the registers behind it.
//
// Purpose   a * b, rounded, or instead_i in its place: in front of an adder -0, to which the adder
//           adds the result of fp_value.
// Latency   MUL_LATENCY + WAIT; new operands every cycle. no_product_i and instead_i come a cycle
//           before the result that they replace.
//
//     multiplier #(.CONFIG(CONFIG)) u_mul (.clk_i(clk_i), .no_product_i(1'b0),
//     .instead_i(MINUS_ZERO), .a_i(a), .b_i(b), .value_o(product), .flags_o(flags)); // a 40400000,
//     b 40000000  ->  product 40C00000, MUL_LATENCY edges later
`default_nettype none
module fp3_multiplier #(
    parameter WAIT = 0,                // more registers
`include "config/config.vh"
) (
    input  wire        clk_i,
    input  wire        no_product_i,   // in the next cycle instead_i
    input  wire [36:0] instead_i,      // flags and value
    input  wire [31:0] a_i,
    input  wire [31:0] b_i,
    output wire [31:0] value_o,
    output wire [4:0]  flags_o         // {NV, DZ, OF, UF, NX}
);
    wire [31:BELOW] product, product_late;
    wire [4:0]      flags, flags_late;
    wire            unused = &{a_i, b_i, instead_i};              // bits below the fraction
    fp3_fp_mul #(.FRAC(FRACTION), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .FINITE(FINITE), .CUTS(MUL_CUTS)) u_mul (
        .clk_i(clk_i),
        .a_i(a_i[31:BELOW]), .b_i(b_i[31:BELOW]), .z_o(product), .flags_o(flags));
    fp3_delay #(.W(37 - BELOW), .N(MUL_SPARE - 1 + WAIT)) u_late (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({flags, product}), .q_o({flags_late, product_late}));

    reg [31:BELOW] value_q;
    reg [4:0]      flags_q;
    always @(posedge clk_i)
        if (no_product_i) {flags_q, value_q} <= instead_i[36:BELOW];
        else              {flags_q, value_q} <= {flags_late, product_late};
    assign {flags_o, value_o} = {flags_q, value_q, {BELOW{1'b0}}};
endmodule
`default_nettype wire
