// shared_arith: one adder and one multiplier for several schedulers.
//
// Purpose   The paper's Figure 3. In each cycle one scheduler may use the adder, one, perhaps
//           another, the multiplier, and one that chains uses both. All results are equally late:
//           a sum's operands wait as long as a product takes, a product as long as a sum.
//
//           add    x, z of one ─────── wait ──────┬► adder ───────► value_o
//           mul    x, y of one ─► multiplier ─────┘ chained
//                                      └──────────── wait ────────► value_o
//
// Latency   1 + MUL_LATENCY + ADD_LATENCY from operands to value_o; initiation interval 1.
//           value_o has no valid bit: each scheduler knows in which cycles a result is its own.
// Hazard    adds_i and muls_i come in the cycle of the operands, with at most one scheduler in each.
//           twice_i and half_i never come together.
`default_nettype none
module shared_arith #(
`include "config/config.vh"
) (
    input  wire            clk_i,
    // Who uses what: both is z +/- x * y, the adder alone z +/- x, the multiplier alone x * y
    input  wire [SCHEDULERS-1:0]    adds_i,
    input  wire [SCHEDULERS-1:0]    muls_i,
    input  wire [SCHEDULERS-1:0]    subtract_i,
    input  wire [SCHEDULERS-1:0]    twice_i,    // z +/- 2 * x, z +/- x / 2: rounded as a product would be
    input  wire [SCHEDULERS-1:0]    half_i,
    input  wire [CHOICE_W*SCHEDULERS-1:0] choice_i, // gen/choices.vh: what is made of z, x, and of whether y is 0;
                                                    // then z takes -0
    input  wire [32*SCHEDULERS-1:0] x_i,
    input  wire [32*SCHEDULERS-1:0] y_i,
    input  wire [32*SCHEDULERS-1:0] z_i,
    output wire [32*SCHEDULERS-1:0] value_o,
    output wire [5*SCHEDULERS-1:0]  flags_o
);
`include "gen/isa.vh"
`include "gen/choices.vh"
    // The operands of those who were granted a unit
    reg  [31:0] mul_x, mul_y, add_x, add_z;
    reg         subtract, twice, half, true;
    reg  [CHOICE_W-1:0] choice;
    integer     k;
    always @* begin
        {mul_x, mul_y, add_x, add_z, subtract, twice, half, true} = 132'd0;
        choice = CHOICE_NONE;
        for (k = 0; k < SCHEDULERS; k = k + 1) begin
            mul_x    = mul_x | (x_i[32*k +: 32] & {32{muls_i[k]}});
            mul_y    = mul_y | (y_i[32*k +: 32] & {32{muls_i[k]}});
            add_x    = add_x | (x_i[32*k +: 32] & {32{adds_i[k]}});
            add_z    = add_z | (z_i[32*k +: 32] & {32{adds_i[k]}});
            subtract = subtract | (subtract_i[k] & adds_i[k]);
            twice    = twice | (twice_i[k] & adds_i[k]);
            half     = half | (half_i[k] & adds_i[k]);
            true     = true | (|y_i[32*k +: 31] & adds_i[k]);
            choice   = choice | (choice_i[CHOICE_W*k +: CHOICE_W] & {CHOICE_W{adds_i[k]}});
        end
    end
    reg  [31:0] mul_x_q, mul_y_q, add_x_q, add_z_q;
    reg         subtract_q, chain_q, twice_q, half_q, true_q;
    reg  [CHOICE_W-1:0] choice_q;
    always @(posedge clk_i) begin
        {mul_x_q, mul_y_q, add_x_q, add_z_q} <= {mul_x, mul_y, add_x, add_z};
        {subtract_q, chain_q, twice_q, half_q} <= {subtract, |(adds_i & muls_i), twice, half};
        {true_q, choice_q} <= {true, choice};
    end

    // Beside the multiplier
    wire [31:0] scaled, x_late, z_late;
    wire [31:0] x_beside = choice_q != CHOICE_NONE ? BITS_MINUS_ZERO : scaled;
    wire        unused_alone;
    wire [4:0]  scale_flags, scale_flags_late;
    wire        subtract_late, chain_late;
    generate
        if (SCALE != 0) begin : g_scale
            fp_scale #(.SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST)) u_scale (.clk_i(clk_i), .twice_i(twice_q), .half_i(half_q),
                .d_i(add_x_q), .z_o(scaled), .flags_o(scale_flags));
        end else begin : g_no_scale
            wire unused = twice_q | half_q;
            assign {scaled, scale_flags} = {add_x_q, 5'd0};
        end
    endgenerate
    delay #(.W(34), .N(MUL_LATENCY)) u_beside (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({x_beside, subtract_q, chain_q}), .q_o({x_late, subtract_late, chain_late}));
    fp_value #(.CONFIG(CONFIG)) u_z (.clk_i(clk_i),
        .choice_i(choice_q), .a_i(add_z_q), .b_i(add_x_q), .true_i(true_q), .z_o(z_late), .alone_o(unused_alone));
    delay #(.W(5), .N(MUL_LATENCY + ADD_LATENCY)) u_scale_flags (.clk_i(clk_i), .rst_i(1'b0),
        .d_i(scale_flags), .q_o(scale_flags_late));

    wire [31:0] product, product_q, sum, sum_q, product_late;
    wire [4:0]  product_flags, product_flags_q, sum_flags, sum_flags_q, product_flags_late;
    fp_mul #(.SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .CUTS(MUL_CUTS)) u_mul (.clk_i(clk_i),
        .a_i(mul_x_q), .b_i(mul_y_q), .z_o(product), .flags_o(product_flags));
    delay #(.W(37), .N(MUL_SPARE)) u_product (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({product_flags, product}), .q_o({product_flags_q, product_q}));

    fp_add #(.SUBNORMAL(SUBNORMAL), .NEAREST(NEAREST), .CUTS(ADD_CUTS)) u_add (.clk_i(clk_i),
        .sub_i(subtract_late), .a_i(z_late), .b_i(chain_late ? product_q : x_late),
        .z_o(sum), .flags_o(sum_flags));
    delay #(.W(37), .N(ADD_SPARE)) u_sum (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({sum_flags, sum}), .q_o({sum_flags_q, sum_q}));
    delay #(.W(37), .N(ADD_LATENCY)) u_late (.clk_i(clk_i), .rst_i(1'b0),
        .d_i({product_flags_q, product_q}), .q_o({product_flags_late, product_late}));

    // Results go to everybody
    genvar n;
    generate
        for (n = 0; n < SCHEDULERS; n = n + 1) begin : g_result
            wire adds, muls;
            delay #(.W(2), .N(LATENCY)) u_uses (.clk_i(clk_i), .rst_i(1'b0),
                .d_i({adds_i[n], muls_i[n]}), .q_o({adds, muls}));
            assign value_o[32*n +: 32] = adds ? sum_q : product_late;
            assign flags_o[5*n +: 5]   = (adds ? sum_flags_q : 5'd0) | (muls ? product_flags_late : 5'd0)
                                       | (adds && !muls ? scale_flags_late : 5'd0);
        end
    endgenerate

`ifdef FP3_CHECK
    reg [15:0] clean_q = 16'd0;                           // what the delays had at power-up has left
    always @(posedge clk_i) begin
        clean_q <= {clean_q[14:0], 1'b1};
        if (clean_q[15] && (|(adds_i & (adds_i - 1'b1)) || |(muls_i & (muls_i - 1'b1)))) begin
            $display("%m: adders %b and multipliers %b for one of each", adds_i, muls_i);
            $stop;
        end
        if (clean_q[15] && twice_q && half_q) begin
            $display("%m: twice and half at once");
            $stop;
        end
    end
`endif
endmodule
`default_nettype wire
