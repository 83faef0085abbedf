// fma_early: fp_fma whose z comes with x and y, without the input that it does not need.
`default_nettype none
module fma_early #(
    parameter EXP = 8, FRAC = 23, SUBNORMAL = 1, NEAREST = 1,
    parameter [10:0] CUTS = 0
) (
    input  wire              clk_i,
    input  wire [EXP+FRAC:0] x_i, y_i, z_i,
    input  wire              subtract_i,
    output wire [EXP+FRAC:0] z_o,
    output wire [4:0]        flags_o
);
    fp3_fp_fma #(.EXP(EXP), .FRAC(FRAC), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .CUTS(CUTS), .Z_EARLY(1)) u_fma (.clk_i(clk_i),
        .x_i(x_i), .y_i(y_i), .no_product_i(1'b0), .subtract_i(subtract_i), .z_i(z_i), .z_o(z_o), .flags_o(flags_o));
endmodule
`default_nettype wire
