// lns_bench: the units of logarithmic arithmetic side by side.
//
// Purpose   For tests: 0 lns_add, 1 lns_mul, 2 lns_root, 3 lns_from_float, 4 lns_to_float, 5 lns_inverse.
// Latency   Each unit's own.
// Hazard    Each unit with registers has a clock of its own, so that a simulator pays for the unit under test alone.
//
//     clk_i[0] rises nine times  ->  z_o[31:0] is the sum of the a_i, b_i at the first edge, or the difference with other_i
`default_nettype none
module lns_bench (
    input  wire [5:0]   clk_i,
    input  wire         other_i,       // subtract, divide, the root's inverse, the inverse's root
    input  wire [31:0]  a_i,
    input  wire [31:0]  b_i,
    output wire [191:0] z_o,
    output wire [29:0]  flags_o
);
    wire unused = clk_i[2];
    fp3_lns_add u_add (.clk_i(clk_i[0]), .sub_i(other_i), .a_i(a_i), .b_i(b_i), .z_o(z_o[31:0]), .flags_o(flags_o[4:0]));
    fp3_lns_mul #(.CUT(1)) u_mul (.clk_i(clk_i[1]), .divide_i(other_i), .a_i(a_i), .b_i(b_i), .z_o(z_o[63:32]), .flags_o(flags_o[9:5]));
    fp3_lns_root u_root (.inverse_i(other_i), .a_i(a_i), .z_o(z_o[95:64]), .flags_o(flags_o[14:10]));
    fp3_lns_from_float u_from (.clk_i(clk_i[3]), .a_i(a_i), .z_o(z_o[127:96]), .flags_o(flags_o[19:15]));
    fp3_lns_inverse u_inverse (.clk_i(clk_i[5]), .on_i(1'b1), .root_i(other_i), .a_i(a_i), .z_o(z_o[191:160]), .flags_o(flags_o[29:25]));
    fp3_lns_to_float u_to (.clk_i(clk_i[4]), .a_i(a_i), .z_o(z_o[159:128]), .flags_o(flags_o[24:20]));
endmodule
`default_nettype wire
