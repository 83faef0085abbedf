// fma_late: fp_fma with z and subtract delayed by as much as the product takes, so that all operands enter at once.
`default_nettype none
module fma_late #(
    parameter EXP = 8, FRAC = 23, SUBNORMAL = 1, NEAREST = 1,
    parameter [10:0] CUTS = 0
) (
    input  wire              clk_i,
    input  wire [EXP+FRAC:0] x_i, y_i, z_i,
    input  wire              subtract_i,
    output wire [EXP+FRAC:0] z_o,
    output wire [4:0]        flags_o
);
    localparam N = {31'd0, CUTS[0]} + {31'd0, CUTS[1]} + {31'd0, CUTS[2]} + {31'd0, CUTS[3]};
    wire [EXP+FRAC:0] z;
    wire              subtract;
    fp3_delay #(.W(EXP+FRAC+2), .N(N)) u_late (.clk_i(clk_i), .rst_i(1'b0), .d_i({subtract_i, z_i}), .q_o({subtract, z}));
    fp3_fp_fma #(.EXP(EXP), .FRAC(FRAC), .SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .CUTS(CUTS)) u_fma (.clk_i(clk_i),
        .x_i(x_i), .y_i(y_i), .no_product_i(1'b0), .subtract_i(subtract), .z_i(z), .z_o(z_o), .flags_o(flags_o));
endmodule
`default_nettype wire
