// fp_scale against the multiplier, and as a wire where it is to do nothing: wrong_o is 0 for every number.
`default_nettype none
module scale_cases #(
    parameter SUBNORMAL = 1,
    parameter NEAREST   = 1,
    parameter FINITE    = 0
) (
    input  wire        twice_i,                           // or halve_i, or neither
    input  wire        halve_i,
    input  wire [31:0] d_i,
    output wire        wrong_o
);
    wire [31:0] scaled, scaled_too, product;
    wire [4:0]  scaled_flags, scaled_too_flags, product_flags;
    fp3_fp_scale #(.SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .FINITE(FINITE)) u_scale (.clk_i(1'b0), .twice_i(twice_i), .halve_i(halve_i),
        .d_i(d_i), .z_o(scaled), .flags_o(scaled_flags));
    fp3_fp_scale #(.SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .FINITE(FINITE), .SUM_LAST(1)) u_scale_too (.clk_i(1'b0), .twice_i(twice_i), .halve_i(halve_i),
        .d_i(d_i), .z_o(scaled_too), .flags_o(scaled_too_flags));
    fp3_fp_mul #(.SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .FINITE(FINITE)) u_mul (.clk_i(1'b0), .a_i(d_i),
        .b_i(halve_i ? 32'h3f000000 : 32'h40000000), .z_o(product), .flags_o(product_flags));
    wire nan = FINITE == 0 && &d_i[30:23] && |d_i[22:0];
    // The adder behind makes a NaN quiet, and reads a subnormal as zero where SUBNORMAL = 0.
    wire same = nan || !(twice_i || halve_i);
    assign wrong_o = !(twice_i && halve_i) && (same ? scaled != d_i || scaled_flags != 5'd0
                                                   : scaled != product || scaled_flags != product_flags)
                  || !(twice_i && halve_i) && (scaled_too != scaled || scaled_too_flags != scaled_flags);
endmodule
`default_nettype wire
