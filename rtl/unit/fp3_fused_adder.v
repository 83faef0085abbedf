// SPDX-License-Identifier: Apache-2.0
// fp3_fused_adder: fp_fma with the cuts of a configuration, and the registers behind it.
//
// Purpose   z + x * y or z - x * y, rounded once; or z alone, added to -0.
// Latency   x and y: PRODUCT_LATENCY + ADD_LATENCY; z and subtract_i come PRODUCT_LATENCY cycles
//           later. For one object they come together with x and y, and no_product_i has no effect.
//           New operands every cycle. MUL_CUTS cuts the product (its first four bits) and ADD_CUTS
//           the rest; the other cycles are registers behind these.
// Hazard    no_product_i comes a cycle before z.
//
//     fused_adder #(.CONFIG(CONFIG)) u_fma (.clk_i(clk_i), .no_product_i(1'b0), .subtract_i(1'b1),
//     .z_i(z), .x_i(x), .y_i(y), .result_o(result)); // x 3F800000, y 40000000, and z 40400000
//     PRODUCT_LATENCY edges later  ->  3F800000, ADD_LATENCY edges after that
`default_nettype none
`include "unit/socket.vh"
module fp3_fused_adder #(
`include "config/config.vh"
) (
    input  wire                 clk_i,
    input  wire                 no_product_i,
    input  wire                 subtract_i,
    input  wire [31:0]          z_i,
    input  wire [31:0]          x_i,
    input  wire [31:0]          y_i,
    output wire [`FP3_RESULT_W-1:0] result_o
);
    wire unused = &{z_i, x_i, y_i};                        // bits below the fraction
    localparam WAIT = PRODUCT_LATENCY - ({31'd0, MUL_CUTS[0]} + {31'd0, MUL_CUTS[1]} + {31'd0, MUL_CUTS[2]} + {31'd0, MUL_CUTS[3]});

    wire [31:BELOW] value, value_late;
    wire [4:0]      flags, flags_late;
    fp3_fp_fma #(.FRAC(FRACTION), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .CUTS({ADD_CUTS[6:0], MUL_CUTS[3:0]}),
        .WAIT(WAIT),
        .Z_EARLY(INTERLEAVE == 0)) u_fma (.clk_i(clk_i),
        .x_i(x_i[31:BELOW]), .y_i(y_i[31:BELOW]), .no_product_i(no_product_i), .subtract_i(subtract_i),
        .z_i(z_i[31:BELOW]),
        .z_o(value), .flags_o(flags));
    fp3_delay #(.W(37 - BELOW), .N(ADD_SPARE)) u_late (.clk_i(clk_i), .rst_i(1'b0), .d_i({flags, value}),
        .q_o({flags_late, value_late}));
    assign result_o = {flags_late, value_late, {BELOW{1'b0}}};
endmodule
`default_nettype wire
`include "config/undefine.vh"
