// dual_arith: a sum and a product in each cycle, both equally late.
//
// Purpose   The adder and the multiplier of a lane that issues to both at once; neither waits for the other.
// Latency   D, the latency of the slower of the two, from the registered operands to both results; one more from those as they
//           are read.
// Flags     {NV, DZ, OF, UF, NX}; where y is scaled those of the product and of the sum.
// Store     One operand of the sum is left out: the other, unchanged, is what is stored.
//
//     cycle    -1      0                        1            1 + D
//              sum_y   x, y as they are read    registered   sum_o, product_o
`default_nettype none
module dual_arith #(
`include "config/config.vh"
) (
    input  wire        clk_i,
    // The sum: +/- x +/- y, where y may be scaled
    input  wire        minus_x_i,
    input  wire        minus_y_i,
    input  wire        twice_i,        // as sum_y_i: a cycle before the rest
    input  wire        half_i,
    input  wire        no_x_i,         // the operand is left out: a store
    input  wire        no_y_i,
    input  wire [31:0] sum_x_i,
    input  wire [31:0] sum_y_i,
    input  wire [31:0] product_x_i,
    input  wire [31:0] product_y_i,
    output wire [31:0] stored_o,       // a cycle after the operands
    output wire [31:0] sum_o,
    output wire [4:0]  sum_flags_o,
    output wire [31:0] product_o,
    output wire [4:0]  product_flags_o
);
    localparam D = LATENCY - TIMING_EARLY;
    localparam MUL_WAITS = D - MUL_LATENCY + MUL_SPARE, ADD_WAITS = D - ADD_LATENCY + ADD_SPARE;

    wire [31:0] scaled;
    wire [4:0]  scale_flags, scale_flags_late;             // overflow or underflow, each of them inexact
    generate
        if (SCALE != 0) begin : g_scale
            fp_scale #(.SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .SUM_LAST(1), .CUTS(1'b1)) u_scale (.clk_i(clk_i), .twice_i(twice_i), .half_i(half_i),
                .d_i(sum_y_i), .z_o(scaled), .flags_o(scale_flags));
            wire of, uf;
            delay #(.W(2), .N(D+1)) u_scale_flags (.clk_i(clk_i), .rst_i(1'b0), .d_i(scale_flags[2:1]), .q_o({of, uf}));
            assign scale_flags_late = {2'b00, of, uf, of || uf};
        end else begin : g_no_scale
            wire unused = twice_i | half_i;
            assign {scale_flags, scale_flags_late} = 10'd0;
            delay #(.W(32), .N(1)) u_plain (.clk_i(clk_i), .rst_i(1'b0), .d_i(sum_y_i), .q_o(scaled));
        end
    endgenerate

    reg         minus_q;
    reg  [31:0] sum_x_q, sum_y_q, product_x_q, product_y_q;
    always @(posedge clk_i) begin
        minus_q     <= minus_y_i;
        sum_x_q     <= no_x_i ? 32'd0 : {sum_x_i[31] ^ minus_x_i, sum_x_i[30:0]};
        sum_y_q     <= no_y_i ? 32'd0 : scaled;
        product_x_q <= product_x_i;
        product_y_q <= product_y_i;
    end

    assign stored_o = sum_x_q | sum_y_q;

    wire [31:0] sum, product;
    wire [4:0]  sum_flags, sum_flags_late, product_flags;
    fp_add #(.SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .CUTS(ADD_CUTS)) u_add (.clk_i(clk_i),
        .sub_i(minus_q), .a_i(sum_x_q), .b_i(sum_y_q), .z_o(sum), .flags_o(sum_flags));
    delay #(.W(37), .N(ADD_WAITS)) u_sum (.clk_i(clk_i), .rst_i(1'b0), .d_i({sum_flags, sum}), .q_o({sum_flags_late, sum_o}));
    fp_mul #(.SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .CUTS(MUL_CUTS)) u_mul (.clk_i(clk_i),
        .a_i(product_x_q), .b_i(product_y_q), .z_o(product), .flags_o(product_flags));
    delay #(.W(37), .N(MUL_WAITS)) u_product (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({product_flags, product}), .q_o({product_flags_o, product_o}));
    assign sum_flags_o = sum_flags_late | scale_flags_late;
    wire unused_flags = |scale_flags;
endmodule
`default_nettype wire
