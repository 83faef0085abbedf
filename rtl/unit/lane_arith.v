// lane_arith: d = z + x * y or z - x * y, multiplied, rounded, added, rounded.
//
// Purpose   The one operation of the throughput machine's lane: a multiplier whose results all go
//           to an adder. A product alone is -0 + x * y, a sum alone z + x * 1. What fp_value makes
//           of z, x and y is added to -0.
// Latency   MUL_LATENCY + ADD_LATENCY; new operands every cycle. There is no reset, enable or valid bit:
//           whoever issues knows when the result comes.
// Flags     Those of the product or those of the sum, {NV, DZ, OF, UF, NX}.
//
//     lane_arith #(.CONFIG(CONFIG)) u_arith (.clk_i(clk_i), .subtract_i(1'b1), .choice_i(CHOICE_NONE),
//         .x_i(x), .y_i(y), .z_i(z), .value_o(d), .flags_o(flags));
//     // with 8 and 8, sixteen edges later d = z - x * y: 40400000 - 3F800000 * 40000000 = 3F800000
`default_nettype none
module lane_arith #(
`include "config/config.vh"
) (
    input  wire        clk_i,
    input  wire        subtract_i,         // 1: z - x * y
    input  wire [CHOICE_W-1:0] choice_i,   // gen/choices.vh: what is made of z, x, and of whether y is 0
    input  wire [31:0] x_i,
    input  wire [31:0] y_i,
    input  wire [31:0] z_i,
    output wire [31:0] value_o,
    output wire [4:0]  flags_o
);
`include "gen/isa.vh"
    wire        alone;                     // no product in the next cycle
    wire [31:0] product, product_late;
    wire [4:0]  product_flags, product_flags_late;
    reg  [31:0] product_q;
    reg  [4:0]  product_flags_q;
    fp_mul #(.SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .CUTS(MUL_CUTS)) u_mul (
        .clk_i(clk_i), .a_i(x_i), .b_i(y_i), .z_o(product), .flags_o(product_flags));
    delay #(.W(37), .N(MUL_SPARE - 1)) u_product (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({product_flags, product}), .q_o({product_flags_late, product_late}));
    always @(posedge clk_i)
        if (alone) {product_flags_q, product_q} <= {5'd0, BITS_MINUS_ZERO};
        else       {product_flags_q, product_q} <= {product_flags_late, product_late};

    // What the adder needs besides waits for the product.
    wire        subtract;
    wire [31:0] z;
    delay #(.W(1), .N(MUL_LATENCY)) u_subtract (.clk_i(clk_i), .rst_i(1'b0), .d_i(subtract_i), .q_o(subtract));
    fp_value #(.CONFIG(CONFIG)) u_z (.clk_i(clk_i),
        .choice_i(choice_i), .a_i(z_i), .b_i(x_i), .true_i(|y_i[30:0]), .z_o(z), .alone_o(alone));

    wire [31:0] sum;
    wire [4:0]  sum_flags, sum_flags_q, earlier_flags;
    fp_add #(.SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .CUTS(ADD_CUTS)) u_add (
        .clk_i(clk_i), .sub_i(subtract), .a_i(z), .b_i(product_q), .z_o(sum), .flags_o(sum_flags));
    delay #(.W(37), .N(ADD_SPARE)) u_sum (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({sum_flags, sum}), .q_o({sum_flags_q, value_o}));

    delay #(.W(5), .N(ADD_LATENCY)) u_flags (.clk_i(clk_i), .rst_i(1'b0),
        .d_i(product_flags_q), .q_o(earlier_flags));
    assign flags_o = sum_flags_q | earlier_flags;
endmodule
`default_nettype wire
