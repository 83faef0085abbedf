// units: an adder and a multiplier with the cuts of `single`, to be synthesised alone.
`default_nettype none
module units (
    input  wire        clk_i,
    input  wire        sub_i,
    input  wire [31:0] a_i, b_i,
    output wire [31:0] sum_o, product_o,
    output wire [4:0]  sum_flags_o, product_flags_o
);
    fp3_fp_add #(.CUTS(7'h04)) u_add (.clk_i(clk_i), .sub_i(sub_i), .a_i(a_i), .b_i(b_i), .z_o(sum_o), .flags_o(sum_flags_o));
    fp3_fp_mul #(.CUTS(7'h04)) u_mul (.clk_i(clk_i), .a_i(a_i), .b_i(b_i), .z_o(product_o), .flags_o(product_flags_o));
endmodule
`default_nettype wire
